#include "partition/shipped/stable_cascades.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "absl/strings/str_format.h"
#include "geometry/light_map.h"
#include "partition/shipped/cascade_parts.h"
#include "partition/shipped/equal_squares.h"

namespace lightfit {

namespace {

absl::Status ValidateInput(const Light& light,
                           const Camera& camera,
                           const StableCascadesOptions& options) {
  if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  if (absl::Status status = ValidateCamera(camera); !status.ok()) return status;
  if (light.kind == Light::Kind::kPoint) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "light \"%s\": stable cascades are for directional lights. A point light has a cube map "
        "(CubeFaces) or a pair of paraboloids (MakeParaboloidPair)",
        light.name));
  }
  if (!(camera.near > 0.0) || !(camera.far > camera.near) || !std::isfinite(camera.far)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "camera: near = %g, far = %g, want 0 < near < far, both finite: the cascades share the "
        "depths between them",
        camera.near,
        camera.far));
  }
  if (options.num_maps < 1 || options.num_maps > kMaxPlanMaps) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "stable cascades: num_maps = %d, want 1 ... %d", options.num_maps, kMaxPlanMaps));
  }
  if (!(options.lambda >= 0.0 && options.lambda <= 1.0)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "stable cascades: lambda = %g, want 0 (uniform) ... 1 (logarithmic)", options.lambda));
  }
  if (!(options.margin_texels >= 0.0 && options.margin_texels < 0.5 * kMaxMapSide)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("stable cascades: margin_texels = %g, want 0 ... %d",
                        options.margin_texels,
                        kMaxMapSide / 2));
  }
  return absl::OkStatus();
}

// Camera space. The near face first; the corners of each face around it.
std::array<Eigen::Vector3d, 8> SliceCorners(const Camera& camera, double near, double far) {
  const Eigen::Matrix3d camera_from_screen = camera.screen_from_camera.inverse();
  const double width = camera.width, height = camera.height;
  const std::array<Eigen::Vector3d, 4> screen = {Eigen::Vector3d(0.0, 0.0, 1.0),
                                                 Eigen::Vector3d(width, 0.0, 1.0),
                                                 Eigen::Vector3d(width, height, 1.0),
                                                 Eigen::Vector3d(0.0, height, 1.0)};
  std::array<Eigen::Vector3d, 8> corners;
  for (size_t i = 0; i < 8; ++i) {
    const double z = i < 4 ? near : far;
    const Eigen::Vector3d at_one = camera_from_screen * screen[i % 4];
    corners[i] = camera.orthographic ? Eigen::Vector3d(at_one.x(), at_one.y(), z)
                                     : Eigen::Vector3d(z * at_one);
  }
  return corners;
}

}  // namespace

SliceSphere SphereAroundSlice(const Camera& camera, double near, double far) {
  const std::array<Eigen::Vector3d, 8> corners = SliceCorners(camera, near, far);
  const Eigen::Vector3d begin = 0.5 * (corners[0] + corners[2]);
  const Eigen::Vector3d along = 0.5 * (corners[4] + corners[6]) - begin;
  // Of a centre begin + t along, the squared distance to corner i is constant_i - 2 t slope_i +
  // t^2 |along|^2: the largest is least at a minimum of one of them, or where two are equal.
  std::array<double, 8> constant, slope;
  for (size_t i = 0; i < 8; ++i) {
    constant[i] = (corners[i] - begin).squaredNorm();
    slope[i] = along.dot(corners[i] - begin);
  }
  const double squared_length = along.squaredNorm();
  SliceSphere best = {begin, std::numeric_limits<double>::infinity()};
  const auto try_at = [&](double t) {
    if (!std::isfinite(t)) return;
    double squared = 0.0;
    for (size_t i = 0; i < 8; ++i) {
      squared = std::max(squared, constant[i] - 2.0 * t * slope[i] + t * t * squared_length);
    }
    const double radius = std::sqrt(squared);
    if (radius < best.radius) best = {begin + t * along, radius};
  };
  try_at(0.0);
  for (size_t i = 0; i < 8; ++i) {
    try_at(slope[i] / squared_length);
    for (size_t j = 0; j < i; ++j) {
      try_at(0.5 * (constant[i] - constant[j]) / (slope[i] - slope[j]));
    }
  }
  return best;
}

absl::StatusOr<Plan> StableCascades(const Light& light,
                                    const Camera& camera,
                                    int64_t max_texels,
                                    const StableCascadesOptions& options) {
  if (absl::Status status = ValidateInput(light, camera, options); !status.ok()) return status;
  const int num_maps = options.num_maps;
  const absl::StatusOr<MapSize> size = EqualSquares(
      light, max_texels, num_maps, 2 + static_cast<int>(std::ceil(2.0 * options.margin_texels)));
  if (!size.ok()) return size.status();
  const double side = size->width;

  const std::vector<double> splits =
      CascadeSplits(camera.near, camera.far, num_maps, options.lambda);
  const Eigen::Matrix4d world_from_camera = camera.camera_from_world.inverse();
  const Eigen::Matrix<double, 3, 4> ray_from_world = RayFromWorld(light);
  constexpr double kEverywhere = std::numeric_limits<double>::infinity();
  Plan plan;
  plan.light_name.assign(light.name.begin(), light.name.end());
  for (int k = 0; k < num_maps; ++k) {
    const SliceSphere sphere = SphereAroundSlice(camera, splits[k], splits[k + 1]);
    const Eigen::Vector3d centre = (world_from_camera * sphere.centre.homogeneous()).head<3>();
    const Eigen::Vector2d seen = (ray_from_world * centre.homogeneous()).head<2>();
    // The map's corner is rounded to whole texels, which moves it by half a texel at most: so the
    // sphere has one texel less than the map. A little more than that for rounding.
    constexpr double kRounding = 1.0 + 1e-9;
    const double texel =
        2.0 * sphere.radius * kRounding / (side - 1.0 - 2.0 * options.margin_texels);
    Eigen::Matrix3d map_from_ray = Eigen::Matrix3d::Identity();
    for (int axis = 0; axis < 2; ++axis) {
      map_from_ray(axis, axis) = 1.0 / texel;
      map_from_ray(axis, 2) = -std::round(seen(axis) / texel - 0.5 * side);
    }
    const double depth = light.direction.stableNormalized().dot(centre);
    const absl::StatusOr<Eigen::Matrix4d> map_from_world =
        FinishMap(map_from_ray,
                  ray_from_world,
                  light,
                  DepthRange{depth - sphere.radius, depth + sphere.radius},
                  1.0);
    if (!map_from_world.ok()) return map_from_world.status();
    PlanMap map;
    map.map_from_world = *map_from_world;
    map.size = *size;
    // What rounding puts a little before the near plane or behind the far one still has a map.
    map.half_spaces = BetweenDepths(
        camera, k == 0 ? -kEverywhere : splits[k], k + 1 == num_maps ? kEverywhere : splits[k + 1]);
    plan.maps.push_back(map);
  }
  return plan;
}

}  // namespace lightfit
