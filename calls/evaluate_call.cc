#include "calls/evaluate_call.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/stop.h"
#include "base/text_file.h"
#include "calls/checked_readback.h"
#include "calls/message_text.h"
#include "calls/pixel_buffer.h"
#include "calls/request_fields.h"
#include "calls/request_lights.h"
#include "calls/request_options.h"
#include "optimizer/evaluate.h"
#include "optimizer/figures/stability.h"
#include "optimizer/fit.h"
#include "wire/camera_proto.h"
#include "wire/crawl_proto.h"
#include "wire/matrix_proto.h"
#include "wire/options_proto.h"
#include "wire/proto_json.h"
#include "wire/result_json.h"
#include "wire/utf8.h"

namespace lightfit {
namespace {

std::string NamesText(const std::vector<RequestLight>& lights) {
  return absl::StrJoin(lights, ", ", [](std::string* out, const RequestLight& light) {
    absl::StrAppend(out, Quoted(light.light.name));
  });
}

absl::StatusOr<Light> LightNamed(const std::string& name, const std::vector<RequestLight>& lights) {
  const auto found = std::find_if(lights.begin(), lights.end(), [&name](const RequestLight& light) {
    return light.light.name == name;
  });
  if (found == lights.end()) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "light = %s: there is no such light, want one of %s", Quoted(name), NamesText(lights)));
  }
  if (!found->status.ok()) return found->status;
  return found->light;
}

absl::StatusOr<Crawl> CrawlFromBefore(const v1::CandidateMatrix& candidate,
                                      const Eigen::Matrix4d& map_from_world,
                                      MapSize map,
                                      const Light& light,
                                      const Surfaces& surfaces,
                                      const Readback* before,
                                      const FitOptions& options) {
  if (before == nullptr) {
    return absl::InvalidArgumentError(
        "map_from_world_before: want the read-back of that frame as well, in before");
  }
  const absl::StatusOr<Eigen::Matrix4d> map_from_world_before =
      MatrixFromProto(candidate.map_from_world_before(), "map_from_world_before");
  if (!map_from_world_before.ok()) return map_from_world_before.status();
  return MeasureCrawl({*before, *map_from_world_before, map},
                      {surfaces.readback, map_from_world, map, &surfaces},
                      light,
                      options.samples);
}

absl::StatusOr<v1::Evaluation> Evaluate(const v1::CandidateMatrix& candidate,
                                        const std::vector<RequestLight>& lights,
                                        const absl::StatusOr<Surfaces>& surfaces,
                                        const Readback* before,
                                        const FitOptions& options) {
  const absl::StatusOr<Light> light = LightNamed(candidate.light(), lights);
  if (!light.ok()) return light.status();
  const absl::StatusOr<MapSize> map = MapSizeOfRequest(candidate.map(), options);
  if (!map.ok()) return map.status();
  const absl::StatusOr<Eigen::Matrix4d> map_from_world = MapFromWorldOf(candidate, *map);
  if (!map_from_world.ok()) return map_from_world.status();
  if (!surfaces.ok()) return surfaces.status();
  const absl::StatusOr<LightView> view = ViewLight(*surfaces, *light, options);
  if (!view.ok()) return view.status();
  const absl::StatusOr<Figures> figures = EvaluateMatrix(*view, *map_from_world, *map, options);
  if (!figures.ok()) return figures.status();
  v1::Evaluation evaluation;
  evaluation.set_energy(figures->energy);
  *evaluation.mutable_footprint() =
      FootprintToProto(figures->footprint, options.compute_statistics);
  *evaluation.mutable_samples() = SampleCountsToProto(figures->samples);
  evaluation.set_num_behind(figures->footprint.num_behind);
  evaluation.set_wrong_share(*figures->wrong_share);
  if (candidate.has_map_from_world_before()) {
    const absl::StatusOr<Crawl> crawl =
        CrawlFromBefore(candidate, *map_from_world, *map, *light, *surfaces, before, options);
    if (!crawl.ok()) return crawl.status();
    *evaluation.mutable_crawl() = CrawlToProto(*crawl);
  }
  if (absl::Status status = CheckFinite(evaluation, "evaluation"); !status.ok()) {
    return absl::InvalidArgumentError(absl::StrCat(
        "its figures are beyond numbers (", status.message(), "): is the matrix of this scene?"));
  }
  return evaluation;
}

}  // namespace

absl::StatusOr<v1::EvaluateResult> AnswerEvaluate(const v1::EvaluateRequest& request,
                                                  const CallContext& context) {
  const StopScope stop_scope(context.stop);
  if (request.matrices().empty()) {
    return absl::InvalidArgumentError("matrices: none, want at least one");
  }
  if (request.matrices_size() > context.limits.max_matrices) {
    return absl::ResourceExhaustedError(
        absl::StrFormat("matrices: %d of them, and this server takes at most %d; send several "
                        "requests",
                        request.matrices_size(),
                        context.limits.max_matrices));
  }
  const absl::StatusOr<std::vector<RequestLight>> lights = LightsOfRequest(request.lights());
  if (!lights.ok()) return lights.status();
  const absl::StatusOr<FitOptions> options = OptionsOfRequest(request.options());
  if (!options.ok()) return options.status();
  const absl::StatusOr<ReadbackView> readback =
      ReadbackView::Of(request.readback(), request.lights_size(), context.limits);
  if (!readback.ok()) return readback.status();
  std::optional<ReadbackView> before;
  CheckedReadback before_checked;
  if (request.has_before()) {
    absl::StatusOr<ReadbackView> view =
        ReadbackView::Of(request.before(), request.lights_size(), context.limits);
    absl::Status status = view.status();
    if (status.ok()) status = ValidateReadback(view->view());
    if (!status.ok()) return InFile("before", status);
    before.emplace(*std::move(view));
    before_checked = CheckReadback(before->view(), *lights, /*is_tracked=*/true);
  }

  std::vector<Light> usable;
  for (const RequestLight& light : *lights) {
    if (light.status.ok()) usable.push_back(light.light);
  }
  const CheckedReadback checked = CheckReadback(readback->view(), *lights);
  const absl::StatusOr<Surfaces> surfaces =
      FindSurfaces(checked.readback, LightMask(usable), options->samples);

  v1::EvaluateResult result;
  for (int i = 0; i < request.matrices_size(); ++i) {
    const v1::CandidateMatrix& candidate = request.matrices(i);
    absl::StatusOr<v1::Evaluation> evaluation = Evaluate(
        candidate, *lights, surfaces, before ? &before_checked.readback : nullptr, *options);
    if (StopRequested()) return StoppedError();
    v1::Evaluation& entry = *result.add_evaluations();
    if (evaluation.ok()) entry = *evaluation;
    entry.set_light(candidate.light());
    const absl::Status status = InFile(absl::StrCat("matrices[", i, "]"), evaluation.status());
    entry.mutable_status()->set_code(static_cast<int>(status.code()));
    entry.mutable_status()->set_message(Utf8Text(status.message()));
  }
  result.mutable_readback()->set_source(request.readback().source());
  const Readback& view = readback->view();
  *result.mutable_readback()->mutable_camera() = CameraToProto(view.camera, view.depth_kind);
  checked.PutInto(result.mutable_readback());
  *result.mutable_options() = FitOptionsToProto(*options);
  if (absl::Status status = CheckFinite(result, "result"); !status.ok()) return status;
  return result;
}

}  // namespace lightfit
