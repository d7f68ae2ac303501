// jobs/tune/moved_map.h
//
// A light's map moved by the eight numbers that a search turns, as a matrix with a depth row.
// In:   a fit; what the camera sees and its true lighting.
// Out:  map_from_world of the moved map.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/border.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "render/surface_image.h"
#include "render/true_lighting.h"

namespace lightfit {

// K = I + [m0 m1 m2; m3 m4 m5; m6 m7 0] in coordinates in which the map is the square +-1; all
// zeros leave the map as it is.
inline constexpr int kNumMoves = 8;
Eigen::Matrix3d MapFromMap(absl::Span<const double> moves, MapSize map);

class MovableMap {
 public:
  // `middle_ray` is where w keeps its size (LightMatrix::map_from_world). InvalidArgument when the
  // matrix is not one of this light.
  static absl::StatusOr<MovableMap> Make(const Light& light,
                                         const Eigen::Matrix4d& map_from_world,
                                         MapSize map,
                                         Border border,
                                         const Eigen::Vector3d& middle_ray);

  // Where the map's border gives the wrong answer there must be a map: those receivers bound w and
  // depth, with whatever else that faces the light lands in the map.
  void SetReceivers(const SurfaceImage& image, absl::Span<const Lighting> truth);

  // FailedPrecondition when w <= 0 on a receiver that must be covered, or the map is folded or has
  // no area.
  absl::StatusOr<Eigen::Matrix4d> Moved(absl::Span<const double> moves) const;

 private:
  Light light_;
  MapSize map_;
  Border border_ = Border::kLit;
  Eigen::Matrix<double, 3, 4> ray_from_world_;
  Eigen::Matrix3d map_from_ray_;
  Eigen::Vector3d middle_ray_;

  struct Receiver {
    Eigen::Vector3d ray;
    double depth = 0.0;  // along the direction of travel; of suns
    bool must_be_covered = false;
  };
  std::vector<Receiver> receivers_;
};

}  // namespace lightfit
