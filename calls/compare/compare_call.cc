#include "calls/compare/compare_call.h"

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/stop.h"
#include "base/text_file.h"
#include "calls/checked_readback.h"
#include "calls/pixel_buffer.h"
#include "calls/request_fields.h"
#include "calls/request_lights.h"
#include "calls/request_options.h"
#include "jobs/compare/json.h"
#include "jobs/compare/rows.h"
#include "jobs/compare/stage.h"
#include "wire/proto_json.h"
#include "wire/utf8.h"

namespace lightfit {
namespace {

// From texels of a map of size `from` to those of one of size `to`.
Eigen::Matrix4d ScaledTexels(MapSize from, MapSize to) {
  Eigen::Vector4d scale = Eigen::Vector4d::Ones();
  scale.x() = static_cast<double>(to.width) / from.width;
  scale.y() = static_cast<double>(to.height) / from.height;
  return scale.asDiagonal();
}

absl::StatusOr<GivenSetUp> GivenOf(const v1::GivenMatrices& given, const CompareOptions& options) {
  if (given.name().empty()) {
    return absl::InvalidArgumentError("name: is empty, want one for the method");
  }
  GivenSetUp set_up;
  set_up.name = given.name();
  for (int i = 0; i < given.matrices_size(); ++i) {
    const v1::CandidateMatrix& candidate = given.matrices(i);
    const std::string field = absl::StrCat("matrices[", i, "]");
    const absl::StatusOr<MapSize> map = MapSizeOfRequest(candidate.map(), options.fit);
    if (!map.ok()) return InFile(field, map.status());
    const absl::StatusOr<Eigen::Matrix4d> matrix = MapFromWorldOf(candidate, *map);
    if (!matrix.ok()) return InFile(field, matrix.status());
    set_up.by_light[candidate.light()] = {PlanOfOneMap(
        candidate.light(), ScaledTexels(*map, options.map) * *matrix, options.map, Border::kLit)};
  }
  return set_up;
}

absl::Status SetGiven(const v1::CompareRequest& request,
                      const CallLimits& limits,
                      CompareOptions* options) {
  int num_matrices = 0;
  for (const v1::GivenMatrices& given : request.given()) num_matrices += given.matrices_size();
  if (num_matrices > limits.max_matrices) {
    return absl::ResourceExhaustedError(
        absl::StrFormat("given: %d matrices, and this server takes at most %d; send several "
                        "requests",
                        num_matrices,
                        limits.max_matrices));
  }
  for (int i = 0; i < request.given_size(); ++i) {
    absl::StatusOr<GivenSetUp> given = GivenOf(request.given(i), *options);
    if (!given.ok()) return InFile(absl::StrCat("given[", i, "]"), given.status());
    options->given.push_back(*std::move(given));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<v1::Comparison> AnswerCompare(const v1::CompareRequest& request,
                                             const CallContext& context) {
  const StopScope stop_scope(context.stop);
  const absl::StatusOr<std::vector<RequestLight>> lights = LightsOfRequest(request.lights());
  if (!lights.ok()) return lights.status();
  CompareOptions options;
  const absl::StatusOr<FitOptions> fit = OptionsOfRequest(request.options());
  if (!fit.ok()) return fit.status();
  options.fit = *fit;
  const absl::StatusOr<MapSize> map = MapSizeOfRequest(request.map(), options.fit);
  if (!map.ok()) return map.status();
  options.map = *map;
  if (absl::Status status = SetGiven(request, context.limits, &options); !status.ok()) {
    return status;
  }
  const absl::StatusOr<ReadbackView> readback =
      ReadbackView::Of(request.readback(), request.lights_size(), context.limits);
  if (!readback.ok()) return readback.status();
  if (absl::Status status = ValidateReadback(readback->view()); !status.ok()) return status;
  const CheckedReadback checked = CheckReadback(readback->view(), *lights);
  const absl::StatusOr<CompareStage> stage = MakeStage(checked.readback);
  if (!stage.ok()) return stage.status();

  std::vector<LightComparison> comparisons;
  for (const RequestLight& light : *lights) {
    comparisons.push_back(light.status.ok() ? CompareMaps(*stage, light.light, options)
                                            : FailedRows(light.light, light.status, options));
    if (StopRequested()) return StoppedError();
  }
  v1::Comparison result =
      ComparisonToProto(request.readback().source(), *stage, options, comparisons);
  for (const std::string& warning : checked.warnings) result.add_warnings(Utf8Text(warning));
  for (size_t i = 0; i < lights->size(); ++i) {
    if (!(*lights)[i].status.ok()) result.mutable_lights(static_cast<int>(i))->clear_light();
  }
  if (absl::Status status = CheckFinite(result, "result"); !status.ok()) return status;
  return result;
}

}  // namespace lightfit
