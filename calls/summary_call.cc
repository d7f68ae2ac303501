#include "calls/summary_call.h"

#include <string>

#include "base/stop.h"
#include "calls/request_fields.h"
#include "calls/summary_request.h"
#include "jobs/fit_summary.h"
#include "wire/proto_json.h"
#include "wire/result_json.h"

namespace lightfit {

absl::StatusOr<v1::FitResult> AnswerFitSummary(const v1::FitSummaryRequest& request,
                                               const CallContext& context) {
  const StopScope stop_scope(context.stop);
  const absl::StatusOr<ClipConvention> clip = ClipOfRequest(request);
  if (!clip.ok()) return clip.status();
  const absl::StatusOr<SummarySet> sum =
      SummariesOfRequest(request.summaries(), request.summary_files(), context.limits);
  if (!sum.ok()) return sum.status();
  const absl::StatusOr<FitOptions> options =
      OptionsOfSummaryRequest(request.options(), sum->options);
  if (!options.ok()) return options.status();
  const absl::StatusOr<MapSize> map = MapSizeOfRequest(request.map(), *options);
  if (!map.ok()) return map.status();

  FitReport report;
  report.options = *options;
  report.map = *map;
  report.clip = *clip;
  for (const LightSummary& light : sum->lights) {
    LightFit& fit = report.lights.emplace_back();
    fit.light = light.total.light;
    fit.matrix = FitSummary(light, *map, *options);
    if (StopRequested()) return StoppedError();
  }
  v1::FitResult result = FitResultToProto(report);
  ClearReadbackFigures(result.mutable_readback(), result.mutable_lights());
  SayMissingFrames(sum->lights, result.mutable_lights());
  if (absl::Status status = CheckFinite(result, "result"); !status.ok()) return status;
  return result;
}

}  // namespace lightfit
