#include "wire/plan_proto.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/strip.h"
#include "geometry/homography.h"
#include "wire/map_sides_proto.h"
#include "wire/matrix_proto.h"
#include "wire/result_json.h"

namespace lightfit {

namespace {

void SetSize(MapSize size, v1::MapSize* proto) {
  proto->set_width(size.width);
  proto->set_height(size.height);
}

absl::Status Named(absl::string_view field, const absl::Status& status) {
  return absl::Status(status.code(), absl::StrCat(field, ": ", status.message()));
}

}  // namespace

absl::StatusOr<v1::Plan> PlanToProto(const LightPlan& plan,
                                     const Light& light,
                                     const ClipConvention& clip,
                                     double guard_texels,
                                     bool with_quantiles) {
  v1::Plan proto;
  proto.set_border(BorderToProto(plan.border));
  proto.set_guard_texels(guard_texels);
  proto.set_texels(NumTexels(PlanOf(plan)));
  for (size_t k = 0; k < plan.maps.size(); ++k) {
    const LightMatrix& map = plan.maps[k];
    const absl::StatusOr<Eigen::Matrix3d> map_from_ray = MapFromRay(map.map_from_world, light);
    if (!map_from_ray.ok()) return map_from_ray.status();
    v1::PlanMap& added = *proto.add_maps();
    added.set_index(static_cast<int>(k));
    SetSize(map.map, added.mutable_map());
    *added.mutable_map_from_world() = MatrixToProto(map.map_from_world);
    *added.mutable_clip_from_world() =
        MatrixToProto(ClipFromMap(map.map, clip) * map.map_from_world);
    added.set_coarseness(1.0 / std::cbrt(std::abs(map_from_ray->determinant())));  // math.md (18)
    added.set_energy(map.figures.energy);
    if (map.figures.footprint.rms > 0.0) {
      *added.mutable_footprint() = FootprintToProto(map.figures.footprint, with_quantiles);
    }
    added.set_samples(map.figures.samples.used);
  }
  return proto;
}

absl::StatusOr<Plan> PlanFromProto(const v1::Plan& proto, absl::string_view field) {
  if (proto.maps_size() < 1 || proto.maps_size() > kMaxPlanMaps) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s.maps: %d of them, want 1 ... %d", field, proto.maps_size(), kMaxPlanMaps));
  }
  const absl::StatusOr<Border> border =
      BorderFromProto(proto.border(), absl::StrCat(field, ".border"));
  if (!border.ok()) return border.status();
  Plan plan;
  plan.border = *border;
  for (int k = 0; k < proto.maps_size(); ++k) {
    const v1::PlanMap& map = proto.maps(k);
    const std::string of_map = absl::StrCat(field, ".maps[", k, "]");
    if (map.index() != k) {
      return absl::InvalidArgumentError(
          absl::StrFormat("%s.index = %d, want %d, its place", of_map, map.index(), k));
    }
    PlanMap& added = plan.maps.emplace_back();
    added.size = {map.map().width(), map.map().height()};
    if (absl::Status status = ValidateMapSize(added.size); !status.ok()) {
      return Named(of_map, status);
    }
    const absl::StatusOr<Eigen::Matrix4d> map_from_world =
        MatrixFromProto(map.map_from_world(), absl::StrCat(of_map, ".map_from_world"));
    if (!map_from_world.ok()) return map_from_world.status();
    added.map_from_world = *map_from_world;
  }
  return plan;
}

absl::StatusOr<double> GuardTexelsFromProto(const v1::Plan& proto, absl::string_view field) {
  const double guard_texels = proto.guard_texels();
  if (!(guard_texels >= 0.0)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s.guard_texels = %g, want 0 or more", field, guard_texels));
  }
  for (const v1::PlanMap& map : proto.maps()) {
    const int least_side = std::min(map.map().width(), map.map().height());
    if (2.0 * guard_texels < least_side) continue;
    return absl::InvalidArgumentError(
        absl::StrFormat("%s.guard_texels = %g leaves nothing of maps[%d] of %dx%d texels, want "
                        "less than %g",
                        field,
                        guard_texels,
                        map.index(),
                        map.map().width(),
                        map.map().height(),
                        0.5 * least_side));
  }
  return guard_texels;
}

absl::Status CheckHasOneMap(const v1::LightResult& light) {
  if (light.plan().maps_size() <= 1) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("light \"%s\": has a plan of %d maps, and takes one matrix here; want one as "
                      "lightfit fit finds it without --maps",
                      light.name(),
                      light.plan().maps_size()));
}

v1::PlanOptions PlanOptionsToProto(const PlanOptions& options) {
  v1::PlanOptions proto;
  proto.set_max_maps(options.max_maps);
  if (options.each.has_value()) {
    SetSize(*options.each, proto.mutable_each());
  } else {
    proto.set_texels(options.texels);
  }
  if (options.sizes.has_value())
    *proto.mutable_sizes() = MapSidesToProto<v1::MapSides>(*options.sizes);
  proto.set_guard_texels(options.guard_texels);
  proto.set_choose_by_forecast(options.choose_by_forecast);
  return proto;
}

absl::StatusOr<PlanOptions> PlanOptionsFromProto(const v1::PlanOptions& proto,
                                                 const FitOptions& fit) {
  PlanOptions options;
  options.fit = fit;
  if (proto.has_max_maps()) options.max_maps = proto.max_maps();
  if (proto.has_guard_texels()) options.guard_texels = proto.guard_texels();
  if (proto.has_choose_by_forecast()) options.choose_by_forecast = proto.choose_by_forecast();
  if (proto.has_each()) {
    if (proto.has_texels()) {
      return absl::InvalidArgumentError(
          absl::StrFormat("plan_options.texels = %d: is what all maps have together, and each the "
                          "size of every map; want one of the two",
                          proto.texels()));
    }
    options.each = MapSize{proto.each().width(), proto.each().height()};
  } else if (proto.has_texels()) {
    options.texels = proto.texels();
  }
  if (proto.has_sizes()) options.sizes = MapSidesFromProto(proto.sizes());
  const absl::Status status = ValidatePlanOptions(options);
  if (status.ok()) return options;
  absl::string_view message = status.message();
  absl::ConsumePrefix(&message, "options.");
  return absl::InvalidArgumentError(absl::StrCat("plan_options.", message));
}

}  // namespace lightfit
