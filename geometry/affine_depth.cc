#include "geometry/affine_depth.h"

#include <Eigen/LU>
#include <algorithm>
#include <limits>

namespace lightfit {

AffineDepth::AffineDepth(const Camera& camera, DepthKind kind, float background)
    : kind_(kind),
      orthographic_(camera.orthographic),
      surface_min_(0.0),
      surface_max_(std::min(background, kBackgroundDepth)),
      background_min_(surface_max_),
      background_max_(std::numeric_limits<double>::infinity()),
      scale_(1.0),
      offset_(0.0),
      camera_from_screen_(camera.screen_from_camera.inverse()) {
  if (!IsNdc(kind)) {
    // An orthographic camera may see surfaces behind its own plane.
    if (orthographic_) surface_min_ = -kBackgroundDepth;
    return;
  }
  // d = 1/z at the near and far planes (0 for infinity), or z itself: NDC depth is linear between.
  const double d_near = orthographic_ ? camera.near : 1.0 / camera.near;
  const double d_far = orthographic_ ? camera.far : 1.0 / camera.far;
  const double ndc_near = kind == DepthKind::kNdcZeroToOne       ? 0.0
                          : kind == DepthKind::kNdcMinusOneToOne ? -1.0
                                                                 : 1.0;
  const double ndc_far = kind == DepthKind::kNdcReversedZeroToOne ? 0.0 : 1.0;
  scale_ = (d_far - d_near) / (ndc_far - ndc_near);
  offset_ = ndc_near - d_near / scale_;
  // The near plane itself counts as a surface, the far plane is the background.
  constexpr double kRounding = 1e-6;
  background_min_ = background_max_ = ndc_far;
  surface_min_ = std::min(ndc_near - kRounding, ndc_far);
  surface_max_ = std::max(ndc_near + kRounding, ndc_far);
  if (ndc_near < ndc_far) surface_max_ = ndc_far;
  if (ndc_near > ndc_far) surface_min_ = ndc_far;
}

double AffineDepth::RayLength(int x, int y) const {
  return (camera_from_screen_ * Eigen::Vector3d(x + 0.5, y + 0.5, 1.0)).norm();
}

}  // namespace lightfit
