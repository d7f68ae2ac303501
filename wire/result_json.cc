#include "wire/result_json.h"

#include <utility>

#include "base/text_file.h"
#include "wire/camera_proto.h"
#include "wire/light_proto.h"
#include "wire/options_proto.h"
#include "wire/plan_proto.h"
#include "wire/proto_json.h"
#include "wire/utf8.h"

namespace lightfit {

namespace {

v1::StopReason StopReasonToProto(StopReason reason) {
  switch (reason) {
    case StopReason::kNoSearch:
      return v1::STOP_REASON_NO_SEARCH;
    case StopReason::kConverged:
      return v1::STOP_REASON_CONVERGED;
    case StopReason::kRoundLimit:
      return v1::STOP_REASON_ROUND_LIMIT;
    case StopReason::kAxisAtLimit:
      return v1::STOP_REASON_AXIS_AT_LIMIT;
    case StopReason::kTooFewSamples:
      return v1::STOP_REASON_TOO_FEW_SAMPLES;
  }
  return v1::STOP_REASON_UNSPECIFIED;
}

// The yardsticks, and how many times theirs `energy` is.
void SetYardsticks(double energy, const LightFit& fit, v1::Energies* proto) {
  if (fit.focused) {
    proto->set_focused(fit.focused->energy);
    if (fit.focused->energy > 0.0) proto->set_final_over_focused(energy / fit.focused->energy);
  }
  if (fit.as_published) {
    proto->set_as_published(fit.as_published->energy);
    if (fit.as_published->energy > 0.0) {
      proto->set_final_over_as_published(energy / fit.as_published->energy);
    }
  }
  if (fit.one_map) {
    proto->set_one_map(fit.one_map->energy);
    if (fit.one_map->energy > 0.0) proto->set_final_over_one_map(energy / fit.one_map->energy);
  }
}

v1::Energies EnergiesToProto(const LightMatrix& matrix, const LightFit& fit) {
  v1::Energies proto;
  proto.set_final(matrix.figures.energy);
  proto.set_start(matrix.search.energy_start);
  if (matrix.search.energy_start > 0.0)
    proto.set_final_over_start(matrix.figures.energy / matrix.search.energy_start);
  SetYardsticks(matrix.figures.energy, fit, &proto);
  return proto;
}

v1::ForetoldWrong ForetoldToProto(double final, const LightFit& fit) {
  v1::ForetoldWrong proto;
  proto.set_final(final);
  if (fit.focused) proto.set_focused(fit.focused->wrong_share.value_or(0.0));
  if (fit.as_published) proto.set_as_published(fit.as_published->wrong_share.value_or(0.0));
  if (fit.one_map) proto.set_one_map(fit.one_map->wrong_share.value_or(0.0));
  return proto;
}

void SetStatus(const absl::Status& status, v1::LightResult* proto) {
  proto->mutable_status()->set_code(static_cast<int>(status.code()));
  proto->mutable_status()->set_message(Utf8Text(status.message()));
}

void SetMatrix(const LightMatrix& matrix,
               const LightFit& fit,
               const FitReport& report,
               v1::LightResult* proto) {
  proto->mutable_map()->set_width(matrix.map.width);
  proto->mutable_map()->set_height(matrix.map.height);
  *proto->mutable_map_from_world() = MatrixToProto(matrix.map_from_world);
  const Eigen::Matrix4d clip_from_world =
      ClipFromMap(matrix.map, report.clip) * matrix.map_from_world;
  *proto->mutable_clip_from_world() = MatrixToProto(clip_from_world);
  *proto->mutable_clip() = ClipConventionToProto(report.clip);
  proto->set_border(BorderToProto(matrix.border));
  proto->set_facing(FacingSourceToProto(matrix.facing));
  *proto->mutable_energies() = EnergiesToProto(matrix, fit);
  if (fit.wrong_share) *proto->mutable_foretold_wrong() = ForetoldToProto(*fit.wrong_share, fit);
  proto->set_solver_report(matrix.search.solver_report);
  *proto->mutable_footprint() =
      FootprintToProto(matrix.figures.footprint, report.options.compute_statistics);
  *proto->mutable_samples() = SampleCountsToProto(matrix.figures.samples);
  proto->set_stop_reason(StopReasonToProto(matrix.search.stop_reason));
  proto->set_evaluations(matrix.search.evaluations);
  for (const TraceStep& step : matrix.search.trace) {
    v1::TraceStep& step_proto = *proto->add_trace();
    step_proto.set_station(std::string(step.station));
    step_proto.set_evaluations(step.evaluations);
    step_proto.set_energy(step.energy);
  }
}

// What is said of several maps together.
void SetSeveralMaps(const LightFit& fit, const FitReport& report, v1::LightResult* proto) {
  const Figures& figures = fit.plan->figures;
  *proto->mutable_clip() = ClipConventionToProto(report.clip);
  proto->set_border(BorderToProto(fit.plan->plan.border));
  proto->set_facing(FacingSourceToProto(fit.plan->plan.facing));
  proto->mutable_energies()->set_final(figures.energy);
  SetYardsticks(figures.energy, fit, proto->mutable_energies());
  if (figures.wrong_share.has_value()) {
    *proto->mutable_foretold_wrong() = ForetoldToProto(*figures.wrong_share, fit);
  }
  if (figures.samples.receivers == 0) return;  // of no read-back: a whole shot's frames have them
  *proto->mutable_footprint() =
      FootprintToProto(figures.footprint, report.options.compute_statistics);
  *proto->mutable_samples() = SampleCountsToProto(figures.samples);
}

v1::LightResult LightResultToProto(const LightFit& fit, const FitReport& report) {
  v1::LightResult proto;
  proto.set_name(fit.light.name);
  *proto.mutable_light() = LightToProto(fit.light);
  if (fit.time_ms) proto.set_time_ms(*fit.time_ms);
  const bool has_several = fit.plan.has_value() && fit.plan->plan.maps.size() > 1;
  absl::Status status = has_several ? absl::OkStatus() : fit.matrix.status();
  if (status.ok() && fit.plan.has_value()) {
    absl::StatusOr<v1::Plan> plan = PlanToProto(fit.plan->plan,
                                                fit.light,
                                                report.clip,
                                                fit.plan->guard_texels,
                                                report.options.compute_statistics);
    status = plan.status();
    if (status.ok()) *proto.mutable_plan() = *std::move(plan);
  }
  SetStatus(status, &proto);
  if (!status.ok()) {
    if (report.plan_options.has_value()) return proto;
    proto.mutable_map()->set_width(report.map.width);
    proto.mutable_map()->set_height(report.map.height);
  } else if (has_several) {
    SetSeveralMaps(fit, report, &proto);
  } else {
    SetMatrix(*fit.matrix, fit, report, &proto);
  }
  return proto;
}

}  // namespace

v1::FacingSource FacingSourceToProto(FacingSource source) {
  switch (source) {
    case FacingSource::kGuessed:
      return v1::FACING_SOURCE_GUESSED;
    case FacingSource::kGiven:
      return v1::FACING_SOURCE_GIVEN;
  }
  return v1::FACING_SOURCE_UNSPECIFIED;
}

v1::FootprintStatistics FootprintToProto(const FootprintStatistics& footprint,
                                         bool with_quantiles) {
  v1::FootprintStatistics proto;
  proto.set_rms(footprint.rms);
  if (with_quantiles) {
    proto.set_median(footprint.median);
    proto.set_p99(footprint.p99);
    proto.set_worst(footprint.worst);
  }
  return proto;
}

v1::SampleCounts SampleCountsToProto(const SampleCounts& counts) {
  v1::SampleCounts proto;
  proto.set_receivers(counts.receivers);
  proto.set_invalid_depth(counts.invalid_depth);
  proto.set_candidates(counts.candidates);
  proto.set_background(counts.background);
  proto.set_discontinuity(counts.discontinuity);
  proto.set_facing_away(counts.facing_away);
  proto.set_edge_on(counts.edge_on);
  proto.set_used(counts.used);
  proto.set_beyond_map(counts.beyond_map);
  return proto;
}

void SetPlan(LightPlan plan, const Figures& figures, double guard_texels, LightFit* fit) {
  fit->matrix = plan.maps[0];
  fit->wrong_share = figures.wrong_share;
  fit->plan = PlanFit{std::move(plan), figures, guard_texels};
}

v1::FitResult FitResultToProto(const FitReport& report) {
  v1::FitResult proto;
  for (const LightFit& fit : report.lights) {
    *proto.add_lights() = LightResultToProto(fit, report);
  }
  proto.mutable_readback()->set_source(Utf8Text(report.source));
  *proto.mutable_readback()->mutable_camera() = CameraToProto(report.camera, report.depth_kind);
  *proto.mutable_options() = FitOptionsToProto(report.options);
  if (report.plan_options.has_value()) {
    *proto.mutable_plan_options() = PlanOptionsToProto(*report.plan_options);
  }
  return proto;
}

absl::StatusOr<std::string> FitResultToJson(const v1::FitResult& result) {
  if (absl::Status status = CheckFinite(result, "result"); !status.ok()) return status;
  return ProtoToJson(result);
}

absl::Status WriteFitResultJson(const std::string& path, const v1::FitResult& result) {
  const absl::StatusOr<std::string> json = FitResultToJson(result);
  if (!json.ok()) return InFile(path, json.status());
  return WriteTextFileAtomically(path, *json);
}

absl::StatusOr<v1::FitResult> ReadFitResultJson(const std::string& path) {
  const absl::StatusOr<std::string> json = ReadTextFile(path);
  if (!json.ok()) return json.status();
  v1::FitResult result;
  if (absl::Status status = JsonToProto(*json, result); !status.ok()) return InFile(path, status);
  return result;
}

}  // namespace lightfit
