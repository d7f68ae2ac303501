#include "calls/fit_call.h"

#include <optional>
#include <utility>
#include <vector>

#include "base/stop.h"
#include "calls/checked_readback.h"
#include "calls/finished_result.h"
#include "calls/pixel_buffer.h"
#include "calls/request_fields.h"
#include "calls/request_lights.h"
#include "calls/request_options.h"
#include "calls/request_plans.h"
#include "jobs/plan_advice.h"
#include "optimizer/figures/foretell.h"
#include "optimizer/fit.h"
#include "wire/result_json.h"

namespace lightfit {
namespace {

LightFit MatrixFitOf(const RequestLight& light,
                     const Surfaces& surfaces,
                     MapSize map,
                     const FitOptions& options,
                     const CallLimits& limits,
                     bool foretells) {
  LightFit fit;
  fit.light = light.light;
  fit.matrix = FitLight(surfaces, light.light, map, options);
  if (!fit.matrix.ok()) {
    fit.matrix = WithNumMaps(fit.matrix.status(),
                             surfaces,
                             light.light,
                             map,
                             options,
                             "plan_options.max_maps",
                             limits.max_maps);
    return fit;
  }
  if (!foretells) return fit;
  const absl::StatusOr<double> wrong_share = ForetellWrongShare(surfaces.readback,
                                                                light.light,
                                                                fit.matrix->map_from_world,
                                                                map,
                                                                options.samples,
                                                                fit.matrix->border);
  if (wrong_share.ok()) fit.wrong_share = *wrong_share;
  return fit;
}

// Of each light what `fit_of` says; those that cannot be used keep their status.
template <typename FitOf>
std::vector<LightFit> FitRequestLights(const std::vector<RequestLight>& lights,
                                       const Readback& readback,
                                       const FitOptions& options,
                                       const FitOf& fit_of) {
  std::vector<Light> usable;
  for (const RequestLight& light : lights) {
    if (light.status.ok()) usable.push_back(light.light);
  }
  const absl::StatusOr<Surfaces> surfaces =
      FindSurfaces(readback, LightMask(usable), options.samples);
  std::vector<LightFit> fits;
  for (const RequestLight& light : lights) {
    const absl::Status& status = light.status.ok() ? surfaces.status() : light.status;
    if (status.ok()) {
      fits.push_back(fit_of(light, *surfaces));
    } else {
      fits.emplace_back().light = light.light;
      fits.back().matrix = status;
    }
  }
  return fits;
}

}  // namespace

absl::StatusOr<v1::FitResult> AnswerFit(const v1::FitRequest& request, const CallContext& context) {
  const absl::StatusOr<ReadbackView> readback =
      ReadbackView::Of(request.readback(), request.lights_size(), context.limits);
  if (!readback.ok()) return readback.status();
  return AnswerFit(request, readback->view(), context);
}

absl::StatusOr<v1::FitResult> AnswerFit(const v1::FitRequest& request,
                                        const Readback& given,
                                        const CallContext& context) {
  const StopScope stop_scope(context.stop);
  const absl::StatusOr<std::vector<RequestLight>> lights = LightsOfRequest(request.lights());
  if (!lights.ok()) return lights.status();
  const absl::StatusOr<FitOptions> options = OptionsOfRequest(request.options());
  if (!options.ok()) return options.status();
  const absl::StatusOr<std::optional<PlanOptions>> plan =
      PlanOptionsOfRequest(request, *options, context.limits);
  if (!plan.ok()) return plan.status();
  absl::StatusOr<MapSize> map = MapSize();
  if (!plan->has_value()) map = MapSizeOfRequest(request.map(), *options);
  if (!map.ok()) return map.status();
  const absl::StatusOr<ClipConvention> clip = ClipOfRequest(request);
  if (!clip.ok()) return clip.status();
  if (absl::Status status = ValidateReadback(given); !status.ok()) return status;
  const CheckedReadback checked = CheckReadback(given, *lights);
  const Readback& readback = checked.readback;

  FitReport report;
  report.source = request.readback().source();
  report.camera = readback.camera;
  report.depth_kind = readback.depth_kind;
  report.options = *options;
  report.plan_options = *plan;
  report.map = *map;
  report.clip = *clip;
  report.lights = FitRequestLights(
      *lights, readback, *options, [&](const RequestLight& light, const Surfaces& surfaces) {
        const bool foretells = request.foretell_wrong();
        return plan->has_value()
                   ? PlanFitOf(light, surfaces, **plan, foretells)
                   : MatrixFitOf(light, surfaces, *map, *options, context.limits, foretells);
      });
  if (StopRequested()) return StoppedError();
  absl::StatusOr<v1::FitResult> result = FinishedResult(report, *lights);
  if (result.ok()) checked.PutInto(result->mutable_readback());
  return result;
}

}  // namespace lightfit
