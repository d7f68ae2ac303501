// geometry/affine_depth.h
//
// What the numbers of a depth image mean, one at a time.
// In:   a camera and the kind of its depth; a value of the image.
// Out:  the affine depth d of geometry/camera.h, or that the value is no surface.   math.md (11)
#pragma once

#include <Eigen/Core>

#include "geometry/camera.h"

namespace lightfit {

// Renderers write "nothing hit" as 1e10 (Cycles), infinity, or the largest float. World units.
inline constexpr float kBackgroundDepth = 1e9F;

// Turns depth values of any kind into affine depth d, one camera and kind at a time.
class AffineDepth {
 public:
  // Where a renderer's background begins before kBackgroundDepth, `background` says so (kCameraZ,
  // kDistance).
  AffineDepth(const Camera& camera, DepthKind kind, float background = kBackgroundDepth);

  // Affine depth of the value `depth` at the pixel with column x and row y (integers, the centre is
  // meant). Only meaningful where IsSurface(depth).
  double At(int x, int y, double depth) const;

  // Whether `depth` is a surface: finite, in front of the camera and nearer than the background.
  // The background is at or beyond kBackgroundDepth, or where it was said to begin (kCameraZ,
  // kDistance), or on the far plane (NDC).
  bool IsSurface(double depth) const { return depth > surface_min_ && depth < surface_max_; }

  // Whether `depth` is neither a surface nor a background value: NaN, -inf, zero or negative
  // distance, NDC outside its range.
  bool IsInvalid(double depth) const {
    return !IsSurface(depth) && !(depth >= background_min_ && depth <= background_max_);
  }

  // Surfaces are the open interval (surface_min, surface_max); NaN compares false.
  double surface_min() const { return surface_min_; }
  double surface_max() const { return surface_max_; }

  // Values that mean "nothing hit", both ends included.
  double background_min() const { return background_min_; }
  double background_max() const { return background_max_; }

  // True when At() depends on depth alone and is monotonic in it (every kind but kDistance).
  bool is_pixel_independent() const { return kind_ != DepthKind::kDistance; }

 private:
  // Length of the ray through a pixel's centre to the plane at unit depth.
  double RayLength(int x, int y) const;

  DepthKind kind_;
  bool orthographic_;
  double surface_min_, surface_max_;
  double background_min_, background_max_;
  double scale_, offset_;  // NDC: d = (depth - offset) * scale
  Eigen::Matrix3d camera_from_screen_;
};

inline double AffineDepth::At(int x, int y, double depth) const {
  switch (kind_) {
    case DepthKind::kCameraZ:
      return orthographic_ ? depth : 1.0 / depth;
    case DepthKind::kDistance:
      return orthographic_ ? depth : RayLength(x, y) / depth;
    case DepthKind::kNdcZeroToOne:
    case DepthKind::kNdcMinusOneToOne:
    case DepthKind::kNdcReversedZeroToOne:
      return (depth - offset_) * scale_;
  }
  return 0.0;
}

}  // namespace lightfit
