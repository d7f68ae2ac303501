#include "jobs/tune/json.h"

#include <utility>

#include "wire/result_json.h"

namespace lightfit {

v1::FitResult TunedToProto(const std::string& source,
                           const CompareStage& stage,
                           const TuneOptions& options,
                           ClipConvention clip,
                           absl::Span<const TunedLight> lights) {
  FitReport report;
  report.source = source;
  report.camera = stage.readback.camera;
  report.depth_kind = stage.readback.depth_kind;
  report.options = options.fit;
  report.map = options.map;
  report.clip = clip;
  for (const TunedLight& light : lights) {
    LightFit fit;
    fit.light = light.light;
    if (light.status.ok()) {
      fit.matrix = light.tuned.matrix;
      fit.wrong_share = light.tuned.foretold;
    } else {
      fit.matrix = light.status;
    }
    report.lights.push_back(std::move(fit));
  }
  v1::FitResult proto = FitResultToProto(report);
  for (size_t i = 0; i < lights.size(); ++i) {
    const TunedLight& light = lights[i];
    if (!light.status.ok()) continue;
    v1::Tuning& tuning = *proto.mutable_lights(static_cast<int>(i))->mutable_tuning();
    tuning.set_fit_wrong(light.fit.wrong);
    tuning.set_wrong(light.tuned.wrong);
    tuning.set_fit_check(light.fit.check);
    tuning.set_check(light.tuned.check);
    tuning.set_evaluations(light.evaluations);
  }
  return proto;
}

}  // namespace lightfit
