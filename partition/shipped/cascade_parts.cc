#include "partition/shipped/cascade_parts.h"

#include <cmath>

namespace lightfit {

std::vector<double> CascadeSplits(double near, double far, int num_parts, double lambda) {
  std::vector<double> splits = {near};
  for (int k = 1; k < num_parts; ++k) {
    const double share = static_cast<double>(k) / num_parts;
    double split = (1.0 - lambda) * (near + (far - near) * share);
    if (lambda > 0.0) split += lambda * near * std::pow(far / near, share);
    splits.push_back(split);
  }
  splits.push_back(far);
  return splits;
}

ScratchVector<Eigen::RowVector4d> BetweenDepths(const Camera& camera, double from, double to) {
  const Eigen::RowVector4d depth = camera.camera_from_world.row(2);
  ScratchVector<Eigen::RowVector4d> half_spaces;
  if (std::isfinite(from)) half_spaces.push_back(depth - from * Eigen::RowVector4d::UnitW());
  if (std::isfinite(to)) half_spaces.push_back(to * Eigen::RowVector4d::UnitW() - depth);
  return half_spaces;
}

}  // namespace lightfit
