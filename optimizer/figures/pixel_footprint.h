// optimizer/figures/pixel_footprint.h
//
// What one matrix does at one pixel: where it lands in the map, and how far a texel reaches there.
// In:   Readback, Light, map_from_world.
// Out:  PixelFootprint, pixel by pixel: for pictures and forecasts. The search uses Samples
// instead.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "absl/status/statusor.h"
#include "geometry/affine_depth.h"
#include "geometry/light.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

struct PixelFootprint {
  DepthGradient gradient;
  bool is_behind = false;  // w <= 0: outside the map, and what follows is 0
  Eigen::Vector2d texel = Eigen::Vector2d::Zero();         // (u, v), texels
  Eigen::Matrix2d J_screen_map = Eigen::Matrix2d::Zero();  // pixels per texel, math.md (2)
};

class PixelFootprints {
 public:
  // InvalidArgument for a read-back, light or matrix that cannot be used. `map_from_world` in
  // texels, as LightMatrix::map_from_world; row 3 does not matter.
  static absl::StatusOr<PixelFootprints> Create(const Readback& readback,
                                                const Light& light,
                                                const Eigen::Matrix4d& map_from_world,
                                                const SampleOptions& options);

  // Nothing where there is no surface, where no plane is known (DepthGradientAt), or where the
  // surface is edge-on or turned away from the light. Finite.
  std::optional<PixelFootprint> At(int x, int y) const;

  const AffineDepth& affine_depth() const { return affine_depth_; }
  const Eigen::Matrix4d& world_from_screen() const { return world_from_screen_; }
  // (u w, v w, w) of (x, y, d, 1), texels.
  const Eigen::Matrix<double, 3, 4>& map_from_screen() const { return map_from_screen_; }

 private:
  PixelFootprints(const Readback& readback,
                  const Light& light,
                  const Eigen::Matrix4d& map_from_world,
                  const SampleOptions& options);

  Readback readback_;
  SampleOptions options_;
  AffineDepth affine_depth_;
  Eigen::Vector4d light_position_;
  Eigen::Matrix4d world_from_screen_;
  Eigen::Matrix4d screen_from_world_;
  Eigen::Matrix<double, 3, 4> map_from_screen_;
};

}  // namespace lightfit
