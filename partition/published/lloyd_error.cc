#include "partition/published/lloyd_error.h"

#include <cmath>
#include <limits>

namespace lightfit {

namespace {

double Alpha(const LloydView& view) { return view.far / view.near; }
double TwoTan(const LloydView& view) { return 2.0 * std::tan(view.half_angle_rad); }
double WarpedFar(const LloydView& view, double warp) { return warp + view.far - view.near; }

// (n' + z - n) / f', which is 1 without a warp.
double ShareOfFar(const LloydView& view, double warp, double z) {
  return std::isinf(warp) ? 1.0 : (warp + z - view.near) / WarpedFar(view, warp);
}

// n' / f'.
double NearShare(const LloydView& view, double warp) { return ShareOfFar(view, warp, view.near); }

// Of each of the parts that are alike.
double PartRatio(const LloydView& view, double parts) { return std::pow(Alpha(view), 1.0 / parts); }

}  // namespace

double ImageBeamWidth(const LloydView& view, double z) { return z * TwoTan(view); }

double LispsmWarp(const LloydView& view) { return view.near + std::sqrt(view.near * view.far); }

double XError(const LloydView& view, double warp, double z) {
  return view.far / z * ShareOfFar(view, warp, z);
}

double ZError(const LloydView& view, double warp, double z) {
  const double share = ShareOfFar(view, warp, z);
  // (n' + z - n)^2 / (n' f') = share^2 f' / n'.
  return (view.far - view.near) / TwoTan(view) / z * share * share / NearShare(view, warp);
}

double MaxXError(const LloydView& view, double warp) { return XError(view, warp, view.near); }

double MaxZError(const LloydView& view, double warp) {
  return ZError(view, warp, warp <= LispsmWarp(view) ? view.far : view.near);
}

double WarpOfEta(const LloydView& view, double eta) {
  const double alpha = Alpha(view), root = std::sqrt(alpha);
  if (eta > 0.0) return view.near * (root + 1.0) / (eta * root + 1.0);
  if (eta <= -1.0) return std::numeric_limits<double>::infinity();
  return view.near * (root + 1.0 - eta * (alpha - 1.0)) / (eta + 1.0);
}

double WarpStorage(const LloydView& view, double warp) {
  const double alpha = Alpha(view), least = (alpha - 1.0) / TwoTan(view);
  if (warp <= LispsmWarp(view)) return least;
  const double share = NearShare(view, warp);
  return least * alpha * share * share;
}

double LogarithmicZError(const LloydView& view) { return std::log(Alpha(view)) / TwoTan(view); }

double OverheadStorage(const LloydView& view, double parts) {
  return PartRatio(view, parts) * OverheadWarpStorage(view, parts);
}

double OverheadWarpStorage(const LloydView& view, double parts) {
  return parts * std::expm1(std::log(Alpha(view)) / parts) / TwoTan(view);
}

double BehindStorage(const LloydView& view, double parts) {
  const double ratio = PartRatio(view, parts);
  return parts * ratio * ratio;
}

double BestPartsBehind(const LloydView& view) { return 2.0 * std::log(Alpha(view)); }

double BehindFaceWarpStorage(const LloydView& view, double parts) {
  LloydView side = view;
  side.half_angle_rad = M_PI / 4.0;
  return 4.0 * OverheadWarpStorage(side, parts) + 1.0;
}

}  // namespace lightfit
