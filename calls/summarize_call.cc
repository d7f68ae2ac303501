#include "calls/summarize_call.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/frame_number.h"
#include "base/stop.h"
#include "base/text_file.h"
#include "base/version.h"
#include "calls/checked_readback.h"
#include "calls/pixel_buffer.h"
#include "calls/request_fields.h"
#include "calls/request_lights.h"
#include "calls/request_options.h"
#include "calls/summary_request.h"
#include "io/summary_file.h"
#include "optimizer/fit.h"
#include "wire/frame_identity.h"
#include "wire/summary_proto.h"
#include "wire/utf8.h"

namespace lightfit {
namespace {

// By light; nothing where samples weigh by the light's own best map.
using WeighingMaps = std::vector<std::optional<Eigen::Matrix4d>>;

absl::StatusOr<WeighingMaps> WeighingMapsOf(const v1::SummarizeRequest& request,
                                            const std::vector<RequestLight>& lights,
                                            const FitOptions& options) {
  WeighingMaps maps(lights.size());
  if (request.weigh_by().empty()) return maps;
  if (!IsL1(options.metric)) {
    return absl::InvalidArgumentError(
        "weigh_by: is for METRIC_L1 and METRIC_L1_ACROSS_EDGE, squares are not weighed by a map; "
        "leave it out");
  }
  for (int i = 0; i < request.weigh_by_size(); ++i) {
    const v1::CandidateMatrix& candidate = request.weigh_by(i);
    const std::string field = absl::StrCat("weigh_by[", i, "]");
    const absl::StatusOr<MapSize> map = MapSizeOfRequest(candidate.map(), options);
    if (!map.ok()) return InFile(field, map.status());
    const absl::StatusOr<Eigen::Matrix4d> matrix = MapFromWorldOf(candidate, *map);
    if (!matrix.ok()) return InFile(field, matrix.status());
    for (size_t light = 0; light < lights.size(); ++light) {
      if (lights[light].light.name == candidate.light()) maps[light] = *matrix;
    }
  }
  return maps;
}

absl::StatusOr<Summary> SummarizeLight(const RequestLight& light,
                                       const absl::StatusOr<Surfaces>& surfaces,
                                       bool weighs,
                                       const std::optional<Eigen::Matrix4d>& weighed_in,
                                       const FitOptions& options) {
  if (!light.status.ok()) return light.status;
  if (weighs && !weighed_in.has_value()) {
    return absl::NotFoundError("weigh_by has no matrix of this light; leave it out");
  }
  if (!surfaces.ok()) return surfaces.status();
  const absl::StatusOr<LightView> view = ViewLight(*surfaces, light.light, options);
  if (!view.ok()) return view.status();
  return weighed_in.has_value() ? SummarizeInMap(*view, *weighed_in, options)
                                : Summarize(*view, options);
}

absl::StatusOr<std::optional<FrameNumber>> NumberOf(const v1::SummarizeRequest& request) {
  if (!request.has_frame_number()) return std::optional<FrameNumber>();
  const std::optional<FrameNumber> number = FrameNumberOf(request.frame_number());
  if (number.has_value()) return number;
  return absl::InvalidArgumentError(
      absl::StrCat("frame_number = ", request.frame_number(), ", want one of up to 12 digits"));
}

absl::StatusOr<SummarySet> SummaryOfReadback(const v1::SummarizeRequest& request,
                                             const CallContext& context,
                                             std::vector<std::string>* warnings) {
  const absl::StatusOr<std::vector<RequestLight>> lights = LightsOfRequest(request.lights());
  if (!lights.ok()) return lights.status();
  const absl::StatusOr<FitOptions> options = OptionsOfRequest(request.options());
  if (!options.ok()) return options.status();
  const absl::StatusOr<WeighingMaps> maps = WeighingMapsOf(request, *lights, *options);
  if (!maps.ok()) return maps.status();
  const absl::StatusOr<ReadbackView> readback =
      ReadbackView::Of(request.readback(), request.lights_size(), context.limits);
  if (!readback.ok()) return readback.status();
  if (absl::Status status = ValidateReadback(readback->view()); !status.ok()) return status;
  const absl::StatusOr<std::optional<FrameNumber>> number = NumberOf(request);
  if (!number.ok()) return number.status();
  const CheckedReadback checked = CheckReadback(readback->view(), *lights);
  *warnings = checked.warnings;

  std::vector<Light> usable;
  for (const RequestLight& light : *lights) {
    if (light.status.ok()) usable.push_back(light.light);
  }
  const absl::StatusOr<Surfaces> surfaces =
      FindSurfaces(checked.readback, LightMask(usable), options->samples);
  const std::string& source = request.readback().source();
  const bool weighs = !request.weigh_by().empty();
  std::vector<LightSummary> summaries;
  for (size_t i = 0; i < lights->size(); ++i) {
    const RequestLight& light = (*lights)[i];
    summaries.push_back(
        SummaryOfFrame(light.light,
                       SummarizeLight(light, surfaces, weighs, (*maps)[i], *options),
                       source.empty() ? "read-back" : source,
                       *options));
    summaries.back().weighed_in = (*maps)[i];
    if (StopRequested()) return StoppedError();
  }
  return MakeSummarySet(*options, std::move(summaries), IdentityOf(readback->view(), *number));
}

}  // namespace

absl::StatusOr<v1::SummarizeResult> AnswerSummarize(const v1::SummarizeRequest& request,
                                                    const CallContext& context) {
  const StopScope stop_scope(context.stop);
  const bool has_summaries = !request.summaries().empty() || !request.summary_files().empty();
  absl::StatusOr<SummarySet> sum = absl::InvalidArgumentError(
      "readback: none, and no summaries either; want a readback, or summaries to be added up");
  if (has_summaries) {
    sum = SummariesOfRequest(request.summaries(), request.summary_files(), context.limits);
    if (!sum.ok()) return sum.status();
  }
  std::vector<std::string> warnings;
  if (request.has_readback()) {
    absl::StatusOr<SummarySet> own = SummaryOfReadback(request, context, &warnings);
    if (!own.ok()) return own.status();
    if (!has_summaries) {
      sum = *std::move(own);
    } else if (absl::Status status = AddToSet(*own, &*sum); !status.ok()) {
      return InFile("readback", status);
    }
  }
  if (!sum.ok()) return sum.status();
  const std::string writer = absl::StrCat("lightfit ", kVersion);
  const absl::StatusOr<std::string> bytes = SerializeSummarySet(*sum, writer);
  if (!bytes.ok()) return bytes.status();
  v1::SummarizeResult result;
  result.set_summary_file(*bytes);
  *result.mutable_summary() = SummarySetToProto(*sum);
  result.mutable_summary()->set_writer(writer);
  for (const std::string& warning : warnings) result.add_warnings(Utf8Text(warning));
  return result;
}

}  // namespace lightfit
