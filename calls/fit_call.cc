#include "calls/fit_call.h"

#include <utility>
#include <vector>

#include "base/stop.h"
#include "calls/finished_result.h"
#include "calls/pixel_buffer.h"
#include "calls/request_fields.h"
#include "calls/request_lights.h"
#include "calls/request_options.h"
#include "optimizer/figures/foretell.h"
#include "optimizer/fit.h"
#include "wire/result_json.h"

namespace lightfit {
namespace {

// Fits the lights that can be used, all at once; the others keep their status.
std::vector<LightFit> FitRequestLights(const std::vector<RequestLight>& lights,
                                       const Readback& readback,
                                       MapSize map,
                                       const FitOptions& options,
                                       bool foretells) {
  std::vector<Light> usable;
  for (const RequestLight& light : lights) {
    if (light.status.ok()) usable.push_back(light.light);
  }
  LightMatrices matrices = FitLights(readback, usable, map, options);
  std::vector<LightFit> fits;
  size_t next = 0;
  for (const RequestLight& light : lights) {
    LightFit& fit = fits.emplace_back();
    fit.light = light.light;
    fit.matrix = light.status.ok() ? std::move(matrices[next++]) : light.status;
    if (!foretells || !fit.matrix.ok()) continue;
    const absl::StatusOr<double> wrong_share = ForetellWrongShare(readback,
                                                                  light.light,
                                                                  fit.matrix->map_from_world,
                                                                  map,
                                                                  options.samples,
                                                                  fit.matrix->border);
    if (wrong_share.ok()) fit.wrong_share = *wrong_share;
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
                                        const Readback& readback,
                                        const CallContext& context) {
  const StopScope stop_scope(context.stop);
  const absl::StatusOr<std::vector<RequestLight>> lights = LightsOfRequest(request.lights());
  if (!lights.ok()) return lights.status();
  const absl::StatusOr<FitOptions> options = OptionsOfRequest(request.options());
  if (!options.ok()) return options.status();
  const absl::StatusOr<MapSize> map = MapSizeOfRequest(request.map(), *options);
  if (!map.ok()) return map.status();
  const absl::StatusOr<ClipConvention> clip = ClipOfRequest(request);
  if (!clip.ok()) return clip.status();
  if (absl::Status status = ValidateReadback(readback); !status.ok()) return status;

  FitReport report;
  report.source = request.readback().source();
  report.camera = readback.camera;
  report.depth_kind = readback.depth_kind;
  report.options = *options;
  report.map = *map;
  report.clip = *clip;
  report.lights = FitRequestLights(*lights, readback, *map, *options, request.foretell_wrong());
  if (StopRequested()) return StoppedError();
  return FinishedResult(report, *lights);
}

}  // namespace lightfit
