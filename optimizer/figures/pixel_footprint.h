// optimizer/figures/pixel_footprint.h
//
// What a matrix, or several of one light, do at one pixel: where it lands in the map that it asks,
// and how far a texel reaches there.
// In:   Readback, Light, map_from_world of each map.
// Out:  PixelFootprint, pixel by pixel: for pictures and forecasts.
//
// The search uses Samples instead.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "base/scratch.h"
#include "geometry/affine_depth.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "geometry/ray_maps.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

// A matrix in texels, as LightMatrix::map_from_world, and the size of its map; row 3 does not
// matter.
struct SizedMatrix {
  Eigen::Matrix4d map_from_world;
  MapSize size;
};

struct PixelFootprint {
  DepthGradient gradient;
  // w <= 0, or of several maps none holds the pixel: outside, and what follows is 0
  bool is_behind = false;
  int map = 0;                                             // that it asks
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

  // The same of several maps of the light: each pixel asks the densest that holds it. The maps'
  // sizes go by; of one map it is asked at every pixel. InvalidArgument also when there is none, or
  // a matrix of several is not one of this light (MapFromRay()).
  static absl::StatusOr<PixelFootprints> Create(const Readback& readback,
                                                const Light& light,
                                                absl::Span<const SizedMatrix> maps,
                                                const SampleOptions& options);

  // Nothing where there is no surface, where no plane is known (DepthGradientAt), or where the
  // surface is edge-on or turned away from the light. Finite.
  std::optional<PixelFootprint> At(int x, int y) const;

  const AffineDepth& affine_depth() const { return affine_depth_; }
  const Eigen::Matrix4d& world_from_screen() const { return world_from_screen_; }

  int num_maps() const { return static_cast<int>(maps_.size()); }
  MapSize size(int map) const { return maps_[map].size; }
  // (u w, v w, w) of (x, y, d, 1), texels.
  const Eigen::Matrix<double, 3, 4>& map_from_screen(int map) const {
    return maps_[map].map_from_screen;
  }

  // The map that a screen point (x, y, d, 1) asks: of several the densest that holds it, -1 where
  // none does.
  int MapAt(const Eigen::Vector4d& screen) const;

  // Of several maps: whether another than this one holds the ray that has this texel in it.
  bool IsHeldByOther(int map, const Eigen::Vector2d& texel) const;

 private:
  struct Map {
    Eigen::Matrix<double, 3, 4> map_from_screen;
    MapSize size;
  };

  PixelFootprints(const Readback& readback, const Light& light, const SampleOptions& options);

  Readback readback_;
  SampleOptions options_;
  AffineDepth affine_depth_;
  Eigen::Vector4d light_position_;
  Eigen::Matrix4d world_from_screen_;
  Eigen::Matrix4d screen_from_world_;
  ScratchVector<Map> maps_;
  Eigen::Matrix<double, 3, 4> ray_from_screen_;
  ScratchVector<RayMap> ray_maps_;  // where there are several
};

}  // namespace lightfit
