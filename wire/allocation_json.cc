#include "wire/allocation_json.h"

#include "absl/strings/str_format.h"
#include "base/text_file.h"
#include "geometry/map_size.h"
#include "wire/map_sides_proto.h"
#include "wire/proto_json.h"

namespace lightfit {

namespace {

v1::Tolerance ToleranceToProto(const Tolerance& tolerance) {
  v1::Tolerance proto;
  switch (tolerance.kind) {
    case Tolerance::Kind::kRms:
      proto.set_kind(v1::Tolerance::KIND_RMS);
      break;
    case Tolerance::Kind::kP99:
      proto.set_kind(v1::Tolerance::KIND_P99);
      break;
    case Tolerance::Kind::kWorst:
      proto.set_kind(v1::Tolerance::KIND_WORST);
      break;
  }
  proto.set_limit_px(tolerance.limit_px);
  proto.set_image_scale(tolerance.image_scale);
  return proto;
}

int64_t TexelsOf(const LightFit& fit) {
  if (fit.plan.has_value()) return NumTexels(PlanOf(fit.plan->plan));
  return fit.matrix.ok() ? TexelsOf(fit.matrix->map) : 0;
}

}  // namespace

absl::StatusOr<Tolerance> ToleranceFromProto(const v1::Tolerance& proto) {
  Tolerance tolerance;
  switch (proto.kind()) {
    case v1::Tolerance::KIND_RMS:
      tolerance.kind = Tolerance::Kind::kRms;
      break;
    case v1::Tolerance::KIND_P99:
      tolerance.kind = Tolerance::Kind::kP99;
      break;
    case v1::Tolerance::KIND_WORST:
      tolerance.kind = Tolerance::Kind::kWorst;
      break;
    default:
      return absl::InvalidArgumentError(absl::StrFormat(
          "tolerance.kind = %d, want KIND_RMS, KIND_P99 or KIND_WORST", proto.kind()));
  }
  tolerance.limit_px = proto.limit_px();
  if (proto.image_scale() != 0.0) tolerance.image_scale = proto.image_scale();
  if (absl::Status status = ValidateTolerance(tolerance); !status.ok()) return status;
  if (tolerance.image_scale > kMaxImageScale) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "tolerance.image_scale = %g, want at most %g", tolerance.image_scale, kMaxImageScale));
  }
  return tolerance;
}

int64_t AllocationReport::Texels() const {
  int64_t texels = 0;
  for (const LightFit& light : fit.lights) texels += TexelsOf(light);
  return texels;
}

double AllocationReport::Share(size_t i) const {
  const int64_t all = budget_texels.value_or(Texels());
  if (all == 0) return 0.0;
  return static_cast<double>(TexelsOf(fit.lights[i])) / static_cast<double>(all);
}

v1::Allocation AllocationToProto(const AllocationReport& report) {
  v1::Allocation proto;
  v1::FitResult fit = FitResultToProto(report.fit);
  proto.mutable_lights()->Swap(fit.mutable_lights());
  proto.mutable_readback()->Swap(fit.mutable_readback());
  proto.mutable_options()->Swap(fit.mutable_options());
  if (fit.has_plan_options()) proto.mutable_plan_options()->Swap(fit.mutable_plan_options());
  if (report.budget_texels) proto.set_budget_texels(*report.budget_texels);
  if (report.tolerance) *proto.mutable_tolerance() = ToleranceToProto(*report.tolerance);
  if (!report.fit.plan_options.has_value()) {
    *proto.mutable_rules() = MapSidesToProto<v1::MapSizeRules>(report.rules);
  }
  proto.set_texels(report.Texels());
  for (size_t i = 0; i < report.entries.size(); ++i) {
    const AllocationEntry& entry = report.entries[i];
    v1::AllocatedMap& map = *proto.add_maps();
    map.set_name(report.fit.lights[i].light.name);
    map.set_weight(entry.weight);
    map.set_texels(TexelsOf(report.fit.lights[i]));
    map.set_share(report.Share(i));
    if (entry.equal_split_energy) map.set_equal_split_energy(*entry.equal_split_energy);
    if (!entry.reached) continue;
    map.mutable_reached()->set_is_met(entry.reached->is_met);
    map.mutable_reached()->set_reached_px(entry.reached->reached_px);
    map.mutable_reached()->set_num_samples(entry.reached->num_samples);
  }
  return proto;
}

absl::Status WriteAllocationJson(const std::string& path, const v1::Allocation& allocation) {
  if (absl::Status status = CheckFinite(allocation, "allocation"); !status.ok()) return status;
  const absl::StatusOr<std::string> json = ProtoToJson(allocation);
  if (!json.ok()) return InFile(path, json.status());
  return WriteTextFileAtomically(path, *json);
}

absl::StatusOr<v1::Allocation> ReadAllocationJson(const std::string& path) {
  const absl::StatusOr<std::string> json = ReadTextFile(path);
  if (!json.ok()) return json.status();
  v1::Allocation allocation;
  if (absl::Status status = JsonToProto(*json, allocation); !status.ok()) {
    return InFile(path, status);
  }
  return allocation;
}

}  // namespace lightfit
