#include "jobs/tune/moved_map.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_format.h"
#include "geometry/homography.h"
#include "geometry/light_map.h"

namespace lightfit {

Eigen::Matrix3d MapFromMap(absl::Span<const double> moves, MapSize map) {
  Eigen::Matrix3d square_from_square;
  square_from_square << 1.0 + moves[0], moves[1], moves[2],  //
      moves[3], 1.0 + moves[4], moves[5],                    //
      moves[6], moves[7], 1.0;
  Eigen::Matrix3d map_from_square;
  map_from_square << 0.5 * map.width, 0.0, 0.5 * map.width,  //
      0.0, 0.5 * map.height, 0.5 * map.height,               //
      0.0, 0.0, 1.0;
  return map_from_square * square_from_square * map_from_square.inverse();
}

absl::StatusOr<MovableMap> MovableMap::Make(const Light& light,
                                            const Eigen::Matrix4d& map_from_world,
                                            MapSize map,
                                            Border border,
                                            const Eigen::Vector3d& middle_ray) {
  const absl::StatusOr<Eigen::Matrix3d> map_from_ray = MapFromRay(map_from_world, light);
  if (!map_from_ray.ok()) return map_from_ray.status();
  MovableMap result;
  result.light_ = light;
  result.map_ = map;
  result.border_ = border;
  result.ray_from_world_ = RayFromWorld(light);
  result.map_from_ray_ = *map_from_ray;
  result.middle_ray_ = middle_ray;
  return result;
}

void MovableMap::SetReceivers(const SurfaceImage& image, absl::Span<const Lighting> truth) {
  receivers_.clear();
  const Eigen::Vector3d direction = light_.direction.stableNormalized();
  for (size_t i = 0; i < truth.size(); ++i) {
    if (truth[i] != Lighting::kLit && truth[i] != Lighting::kShadowed) continue;
    const Eigen::Vector3d& position = image.pixels[i].position;
    Receiver receiver;
    receiver.ray = ray_from_world_ * position.homogeneous();
    if (light_.kind == Light::Kind::kDirectional) receiver.depth = direction.dot(position);
    receiver.must_be_covered = (truth[i] == Lighting::kShadowed) == (border_ == Border::kLit);
    receivers_.push_back(receiver);
  }
}

absl::StatusOr<Eigen::Matrix4d> MovableMap::Moved(absl::Span<const double> moves) const {
  constexpr double kLeastDeterminant = 1e-3;  // of the move: 1 / 1000 of the area
  constexpr double kDepthSlack = 0.01;        // surfaces between the pixels' centres
  const Eigen::Matrix3d map_from_map = MapFromMap(moves, map_);
  if (!(map_from_map.determinant() > kLeastDeterminant)) {
    return absl::FailedPreconditionError(
        absl::StrFormat("light \"%s\": the map has no area", light_.name));
  }
  Eigen::Matrix3d map_from_ray = map_from_map * map_from_ray_;
  const double w_before = map_from_ray_.row(2).dot(middle_ray_);
  const double w_after = map_from_ray.row(2).dot(middle_ray_);
  if (w_before > 0.0 && w_after > 0.0) map_from_ray *= w_before / w_after;

  DepthRange depth = {std::numeric_limits<double>::infinity(),
                      -std::numeric_limits<double>::infinity()};
  double w_min = std::numeric_limits<double>::infinity();
  for (const Receiver& receiver : receivers_) {
    const Eigen::Vector3d uvw = map_from_ray * receiver.ray;
    const double w = uvw.z();
    if (!(w > 0.0)) {
      if (!receiver.must_be_covered) continue;
      return absl::FailedPreconditionError(absl::StrFormat(
          "light \"%s\": the map has w <= 0 on a receiver that it must cover", light_.name));
    }
    const bool is_inside =
        uvw.x() >= 0.0 && uvw.x() < w * map_.width && uvw.y() >= 0.0 && uvw.y() < w * map_.height;
    if (!is_inside && !receiver.must_be_covered) continue;
    const double along = light_.kind == Light::Kind::kPoint ? w : receiver.depth;
    depth = {std::min(depth.near, along), std::max(depth.far, along)};
    w_min = std::min(w_min, w);
  }
  if (!std::isfinite(w_min)) {
    return absl::FailedPreconditionError(
        absl::StrFormat("light \"%s\": no receiver lies in the map", light_.name));
  }
  const double slack = kDepthSlack * (depth.far - depth.near);
  depth = {light_.kind == Light::Kind::kPoint ? std::max(depth.near - slack, 0.5 * depth.near)
                                              : depth.near - slack,
           depth.far + slack};
  return FinishMap(map_from_ray, ray_from_world_, light_, depth, w_min);
}

}  // namespace lightfit
