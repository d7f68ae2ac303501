// partition/published/lloyd_error.h
//
// How many texels shadow maps need for a view frustum, by formula, for two lights.
// In:      LloydView {near, far, half_angle_rad}; the warp n' or its parameter eta; how many maps.
// Out:     errors (texel widths over pixel widths) and storage factors (texels over pixels without
//          perspective aliasing), for a map and an image of 1 x 1.
// Symbols: n, f near and far; alpha = f/n; z camera depth; theta half of the field of view;
//          n' (`warp`) distance of the warp's centre from the near plane; f' = n' + f - n.
//
// Lloyd, Tuft, Yoon & Manocha 2006 (EGSR), numbers in brackets are theirs; docs/published_plans.md
// has the formulas, and says where the print is in error. The light is a sun that stands straight
// above a level view ("overhead") or straight behind the viewer ("behind").
#pragma once

namespace lightfit {

// 0 < near < far, 0 < half_angle_rad < pi / 2.
struct LloydView {
  double near = 1.0;
  double far = 2.0;
  double half_angle_rad = 0.5;
};

// (2) Width of a pixel's beam at depth z.
double ImageBeamWidth(const LloydView& view, double z);

// The warp of light-space perspective maps, n + sqrt(n f). Perspective maps have n' = n, and maps
// without a warp an infinite n'. Where `warp` stands below it is n or more, and may be infinite.
double LispsmWarp(const LloydView& view);

// (7), (8) Errors across and along the view at depth z.
double XError(const LloydView& view, double warp, double z);
double ZError(const LloydView& view, double warp, double z);

// (9), (10) Their largest values over the view.
double MaxXError(const LloydView& view, double warp);
double MaxZError(const LloydView& view, double warp);

// (11) The warp from eta in -1 ... 1: infinite, LispsmWarp(), n at -1, 0, 1; its largest error
// along the view is linear in eta on both sides of 0.
double WarpOfEta(const LloydView& view, double eta);

// (12) The storage factor, MaxXError() MaxZError(). Least, and the same, for warps up to
// LispsmWarp().
double WarpStorage(const LloydView& view, double warp);

// Appendix C: error along the view, at any depth, of a map in which depth is logarithmic. Its
// storage factor is the error, as across the view there is none.
double LogarithmicZError(const LloydView& view);

// Storage factors of `parts` maps, split by depth at equal ratios: (17), and with a warp (18).
// (18) falls to LogarithmicZError(). Splits by faces do not change an overhead light (19).
double OverheadStorage(const LloydView& view, double parts);
double OverheadWarpStorage(const LloydView& view, double parts);

// (20) Behind, split by depth: no warp is possible. Least at BestPartsBehind() = 2 ln alpha.
double BehindStorage(const LloydView& view, double parts);
double BestPartsBehind(const LloydView& view);

// (21) Behind, the four side faces split into `parts` each and warped, and one map for the near
// plane, which is counted here and not in `parts`. Seen along the view a side face is a trapezoid
// of 45 degrees, whatever theta.
double BehindFaceWarpStorage(const LloydView& view, double parts);

}  // namespace lightfit
