#include "partition/shipped/sample_distribution.h"

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "absl/strings/str_format.h"
#include "geometry/ray_cone.h"
#include "methods/light_body.h"
#include "methods/view_body.h"
#include "partition/shipped/cascade_parts.h"
#include "partition/shipped/equal_squares.h"
#include "partition/shipped/receiver_pixels.h"

namespace lightfit {

namespace {

constexpr double kEverywhere = std::numeric_limits<double>::infinity();

// A part of the view with what was seen in it.
struct Part {
  double begin = 0.0;  // camera depth
  std::vector<Eigen::Vector3d> points;
};

// Camera depths of all receivers.
ViewDepths DepthsSeen(const Surfaces& surfaces) {
  ViewDepths depths = {kEverywhere, -kEverywhere};
  for (const DepthTile& tile : surfaces.tiles.grids.back().tiles) {
    if (tile.num_surfaces == 0) continue;
    for (const double d : {tile.d_min, tile.d_max}) {
      const double z = surfaces.readback.camera.orthographic ? d : 1.0 / d;
      depths = {std::min(depths.least, z), std::max(depths.greatest, z)};
    }
  }
  return depths;
}

std::vector<Part> PartsOfView(const Surfaces& surfaces, int num_parts) {
  const Camera& camera = surfaces.readback.camera;
  const ViewDepths seen = DepthsSeen(surfaces);
  const double lambda = camera.orthographic ? 0.0 : 1.0;
  const std::vector<double> splits = CascadeSplits(seen.least, seen.greatest, num_parts, lambda);
  std::vector<Part> parts(num_parts);
  for (int k = 0; k < num_parts; ++k) parts[k].begin = splits[k];
  const auto part_of = [&](double z) {
    return std::lower_bound(splits.begin() + 1, splits.end() - 1, z) - (splits.begin() + 1);
  };
  ForEachReceiverPixel(surfaces, [&](const ReceiverPixel& pixel) {
    const ViewDepths depths = ViewDepthsOf(camera, pixel.points);
    const auto first = part_of(depths.least), last = part_of(depths.greatest);
    for (auto k = first; k <= last; ++k) {
      parts[k].points.insert(parts[k].points.end(), pixel.points.begin(), pixel.points.end());
    }
  });
  return parts;
}

absl::Status SurroundedError(const Light& light, const Part& part) {
  return absl::FailedPreconditionError(absl::StrFormat(
      "light \"%s\": at (%g, %g, %g) it hangs among the receivers from camera depth %g on: no map "
      "has all of them in front of it. Use a cube map (CubeFaces) or a pair of paraboloids "
      "(MakeParaboloidPair)",
      light.name,
      light.position.x(),
      light.position.y(),
      light.position.z(),
      part.begin));
}

absl::StatusOr<LightBody> BodyOf(const Light& light, const Part& part) {
  LightBody body;
  body.light = light;
  body.points = part.points;
  Eigen::Vector3d forward = Eigen::Vector3d::UnitZ();
  if (light.kind == Light::Kind::kPoint) {
    std::vector<Eigen::Vector3d> rays;
    rays.reserve(part.points.size());
    for (const Eigen::Vector3d& point : part.points) rays.emplace_back(point - light.position);
    const std::optional<Eigen::Vector3d> axis = FeasibleAxis(rays);
    if (!axis.has_value()) return SurroundedError(light, part);
    forward = *axis;
  }
  body.ray_from_world = RayFromWorld(light, forward);
  body.rays.reserve(part.points.size());
  for (const Eigen::Vector3d& point : part.points) {
    body.rays.emplace_back(body.ray_from_world * point.homogeneous());
  }
  return body;
}

}  // namespace

absl::StatusOr<Plan> SampleDistributionMaps(const Surfaces& surfaces,
                                            const Light& light,
                                            int64_t max_texels,
                                            const SampleDistributionOptions& options) {
  if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  if (options.num_maps < 1 || options.num_maps > kMaxPlanMaps) {
    return absl::InvalidArgumentError(
        absl::StrFormat("sample distribution shadow maps: num_maps = %d, want 1 ... %d",
                        options.num_maps,
                        kMaxPlanMaps));
  }
  const RectangleTurn turn =
      options.min_area_rotation ? RectangleTurn::kMinArea : RectangleTurn::kAlongRows;
  const std::vector<Part> parts = PartsOfView(surfaces, options.num_maps);
  if (absl::Status status = CheckStop(light); !status.ok()) return status;

  // Maps of one texel at first, as it takes all of them to know how large they may be.
  Plan plan;
  plan.light_name.assign(light.name.begin(), light.name.end());
  std::vector<double> begins;
  absl::Status why_none;
  for (const Part& part : parts) {
    if (part.points.empty()) continue;
    absl::StatusOr<LightBody> body = BodyOf(light, part);
    if (!body.ok()) return body.status();
    if (absl::Status status = CheckStop(light); !status.ok()) return status;
    body->map = {1, 1};
    const absl::StatusOr<MethodMap> fitted = FitBody(*body, Eigen::Matrix3d::Identity(), turn);
    if (absl::IsFailedPrecondition(fitted.status())) {
      why_none = fitted.status();
      continue;
    }
    if (!fitted.ok()) return fitted.status();
    plan.maps.emplace_back().map_from_world = fitted->map_from_world;
    begins.push_back(part.begin);
  }
  if (plan.maps.empty()) return why_none;

  const absl::StatusOr<MapSize> size =
      EqualSquares(light, max_texels, static_cast<int>(plan.maps.size()));
  if (!size.ok()) return size.status();
  for (size_t k = 0; k < plan.maps.size(); ++k) {
    PlanMap& map = plan.maps[k];
    map.size = *size;
    map.map_from_world.topRows<2>() *= size->width;
    map.half_spaces = BetweenDepths(surfaces.readback.camera,
                                    k == 0 ? -kEverywhere : begins[k],
                                    k + 1 == plan.maps.size() ? kEverywhere : begins[k + 1]);
  }
  return plan;
}

}  // namespace lightfit
