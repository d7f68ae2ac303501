#include "partition/published/z_partition.h"

#include <Eigen/Core>
#include <cmath>
#include <utility>

#include "absl/strings/str_format.h"
#include "methods/light_body.h"
#include "methods/view_body.h"
#include "partition/published/equal_maps.h"

namespace lightfit {

namespace {

absl::Status ValidateOptions(const ZPartitionOptions& options) {
  if (options.num_maps < 1 || options.num_maps > kMaxPlanMaps) {
    return absl::InvalidArgumentError(
        absl::StrFormat("num_maps = %d, want 1 ... %d", options.num_maps, kMaxPlanMaps));
  }
  if (!(options.log_share >= 0.0) || !(options.log_share <= 1.0)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "log_share = %g, want 0 (equal distances) ... 1 (equal ratios)", options.log_share));
  }
  return ValidateMargin("ZPartition", options.margin_texels);
}

// Inside is at that camera depth or beyond.
Eigen::Vector4d Beyond(const Camera& camera, double depth) {
  return camera.camera_from_world.row(2).transpose() - depth * Eigen::Vector4d::UnitW();
}

}  // namespace

std::vector<double> DepthSplits(double near, double far, int num_parts, double log_share) {
  std::vector<double> depths;
  for (int i = 0; i <= num_parts; ++i) {
    const double share = static_cast<double>(i) / num_parts;
    depths.push_back(log_share * near * std::pow(far / near, share) +
                     (1.0 - log_share) * (near + share * (far - near)));
  }
  depths.front() = near;
  depths.back() = far;
  return depths;
}

absl::StatusOr<Plan> ZPartition(const MethodInput& input, const ZPartitionOptions& options) {
  if (absl::Status status = ValidateMethodInput(input); !status.ok()) return status;
  if (absl::Status status = ValidateOptions(options); !status.ok()) return status;
  const std::vector<double> depths =
      DepthSplits(input.camera.near, input.camera.far, options.num_maps, options.log_share);
  MethodInput slice = input;
  slice.map = {1, 1};
  std::vector<PlanPart> parts;
  std::vector<std::pair<double, double>> ranges;
  for (int i = 0; i < options.num_maps; ++i) {
    slice.camera.near = depths[i];
    slice.camera.far = depths[i + 1];
    if (!(slice.camera.far > slice.camera.near)) continue;
    if (ViewBody(slice.camera, slice.receivers, slice.cuts).empty()) continue;
    absl::StatusOr<LightBody> body = BodyInView(slice);
    if (!body.ok()) return body.status();
    if (!body->in_view) continue;
    const absl::StatusOr<MethodMap> map = SetUpMap(options.method, slice);
    if (!map.ok()) return map.status();
    parts.push_back({map->map_from_world, {}, std::move(body->points)});
    ranges.emplace_back(slice.camera.near, slice.camera.far);
  }
  if (parts.empty()) {
    slice.camera = input.camera;
    const absl::StatusOr<MethodMap> map = SetUpMap(options.method, slice);
    if (!map.ok()) return map.status();
    parts.push_back({map->map_from_world, {}, {}});
  }
  // What is between two slices that have maps is in one of them, so that only slices at the ends
  // are left out.
  for (size_t i = 0; i + 1 < ranges.size(); ++i) {
    const Eigen::Vector4d beyond = Beyond(input.camera, ranges[i].second);
    parts[i].half_spaces.push_back(-beyond);
    parts[i + 1].half_spaces.push_back(beyond);
  }
  return PlanOfParts(input, parts, options.shapes, options.margin_texels);
}

}  // namespace lightfit
