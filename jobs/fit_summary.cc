#include "jobs/fit_summary.h"

#include "absl/strings/str_format.h"
#include "optimizer/fit.h"
#include "wire/utf8.h"

namespace lightfit {

absl::StatusOr<FitOptions> OptionsForSummaries(const FitOptions& asked, const FitOptions& held) {
  FitOptions options = asked;
  options.samples = held.samples;
  options.samples.min_samples = asked.samples.min_samples;
  options.metric = held.metric;
  options.along_edge_share = held.along_edge_share;
  options.cover = held.cover;
  options.border = held.border;
  options.compute_statistics = false;  // percentiles need the samples
  if (absl::Status status = ValidateFitOptions(options); !status.ok()) return status;
  return options;
}

absl::StatusOr<Summary> SummaryOf(const LightSummary& light) {
  if (light.total.num_frames == 0) {
    return absl::FailedPreconditionError(MissingFramesText(light));
  }
  return SummaryOfTotal(light.total);
}

absl::StatusOr<LightMatrix> FitSummary(const LightSummary& light,
                                       MapSize map,
                                       const FitOptions& options) {
  const absl::StatusOr<Summary> summary = SummaryOf(light);
  if (!summary.ok()) return summary.status();
  return Fit(*summary, light.total.light, map, options);
}

std::string MissingFramesText(const LightSummary& light) {
  if (light.num_frames_without == 0) return "";
  return absl::StrFormat("light \"%s\": nothing of it in %d of %d frames, such as %s",
                         light.name(),
                         light.num_frames_without,
                         light.num_frames(),
                         Utf8Text(light.failure.message()));
}

void ClearReadbackFigures(v1::ReadbackInfo* readback,
                          google::protobuf::RepeatedPtrField<v1::LightResult>* lights) {
  readback->clear_camera();  // each frame had its own
  for (v1::LightResult& light : *lights) {
    if (light.footprint().rms() == 0.0) light.clear_footprint();  // it needs the samples
    light.clear_facing();
  }
}

void SayMissingFrames(const std::vector<LightSummary>& lights,
                      google::protobuf::RepeatedPtrField<v1::LightResult>* results) {
  for (size_t i = 0; i < lights.size(); ++i) {
    v1::Status& status = *results->Mutable(static_cast<int>(i))->mutable_status();
    if (status.code() == 0) status.set_message(MissingFramesText(lights[i]));
  }
}

}  // namespace lightfit
