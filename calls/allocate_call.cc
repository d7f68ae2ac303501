#include "calls/allocate_call.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/stop.h"
#include "calls/checked_readback.h"
#include "calls/message_text.h"
#include "calls/pixel_buffer.h"
#include "calls/request_fields.h"
#include "calls/request_lights.h"
#include "calls/request_options.h"
#include "calls/request_plans.h"
#include "calls/summary_request.h"
#include "jobs/allocate_lights.h"
#include "jobs/fit_summary.h"
#include "optimizer/sizing/map_sizes.h"
#include "wire/map_sides_proto.h"
#include "wire/options_proto.h"
#include "wire/proto_json.h"

namespace lightfit {
namespace {

// More than 32 maps of the largest size can have is a mistake, and would overflow.
constexpr int64_t kMaxBudget = int64_t{kMaxLights} * 65536 * 65536;  // texels

bool IsOfSummaries(const v1::AllocateRequest& request) {
  return !request.summaries().empty() || !request.summary_files().empty();
}

absl::Status CheckSource(const v1::AllocateRequest& request) {
  if (!IsOfSummaries(request)) {
    if (request.has_readback()) return absl::OkStatus();
    return absl::InvalidArgumentError(
        "readback: is missing, want a read-back and its lights, or summaries");
  }
  for (const auto& [field, is_set] : {std::pair{"readback", request.has_readback()},
                                      std::pair{"lights", !request.lights().empty()}}) {
    if (is_set) {
      return absl::InvalidArgumentError(
          absl::StrCat(field, ": summaries bring theirs, leave it out or leave them out"));
    }
  }
  if (request.has_plan_options()) {
    return absl::InvalidArgumentError(
        "plan_options: a plan is fitted to the pixels of a read-back, and summaries have none; "
        "want a read-back in place of them, or leave out plan_options");
  }
  return absl::OkStatus();
}

absl::Status ReadGoal(const v1::AllocateRequest& request, AllocationTask* task) {
  switch (request.goal_case()) {
    case v1::AllocateRequest::kBudgetTexels:
      if (request.budget_texels() < 1 || request.budget_texels() > kMaxBudget) {
        return absl::InvalidArgumentError(absl::StrFormat(
            "budget_texels = %d, want 1 ... %d", request.budget_texels(), kMaxBudget));
      }
      task->budget_texels = request.budget_texels();
      return absl::OkStatus();
    case v1::AllocateRequest::kTolerance: {
      if (!request.weights().empty()) {
        return absl::InvalidArgumentError(
            "weights: do not count with a tolerance, want none, or budget_texels");
      }
      const absl::StatusOr<Tolerance> tolerance = ToleranceFromProto(request.tolerance());
      if (!tolerance.ok()) return tolerance.status();
      task->tolerance = *tolerance;
      return absl::OkStatus();
    }
    case v1::AllocateRequest::GOAL_NOT_SET:
      break;
  }
  return absl::InvalidArgumentError("goal: is missing, want budget_texels or tolerance");
}

absl::Status ReadReadback(const v1::AllocateRequest& request,
                          const ReadbackView& readback,
                          const std::vector<RequestLight>& lights,
                          const CallLimits& limits,
                          AllocationTask* task,
                          CheckedReadback* checked) {
  const absl::StatusOr<FitOptions> options = OptionsOfRequest(request.options());
  if (!options.ok()) return options.status();
  task->options = *options;
  *checked = CheckReadback(readback.view(), lights);
  task->readback = checked->readback;
  int num_usable = 0;
  for (const RequestLight& light : lights) {
    task->lights.push_back(light.light);
    task->light_status.push_back(light.status);
    num_usable += light.status.ok() ? 1 : 0;
  }
  const absl::StatusOr<std::optional<PlanOptions>> plans =
      PlanOptionsOfBudget(request, *options, num_usable, limits);
  if (!plans.ok()) return plans.status();
  task->plans = *plans;
  return ValidateReadback(task->readback.value());
}

// Sums know the root mean square alone, and only of squares.
absl::Status CheckTolerance(const AllocationTask& task) {
  if (!task.tolerance.has_value()) return absl::OkStatus();
  if (task.tolerance->kind != Tolerance::Kind::kRms) {
    return absl::InvalidArgumentError(
        "tolerance.kind: KIND_P99 and KIND_WORST go through the samples one by one, and a summary "
        "has their sums only; want KIND_RMS, or a read-back in place of summaries");
  }
  if (task.options.metric != Metric::kL2) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "tolerance: the summaries hold sums for %s, and a tolerance wants METRIC_L2; summarise the "
        "frames again with it, or give a read-back in place of summaries",
        v1::Metric_Name(FitOptionsToProto(task.options).metric())));
  }
  return absl::OkStatus();
}

absl::Status ReadSummaries(const v1::AllocateRequest& request,
                           const CallLimits& limits,
                           AllocationTask* task) {
  absl::StatusOr<SummarySet> sum =
      SummariesOfRequest(request.summaries(), request.summary_files(), limits);
  if (!sum.ok()) return sum.status();
  const absl::StatusOr<FitOptions> options =
      OptionsOfSummaryRequest(request.options(), sum->options);
  if (!options.ok()) return options.status();
  task->options = *options;
  for (const LightSummary& light : sum->lights) task->lights.push_back(light.total.light);
  task->summaries = *std::move(sum);
  return CheckTolerance(*task);
}

absl::Status ReadWeights(const v1::AllocateRequest& request, AllocationTask* task) {
  task->weights.assign(task->lights.size(), 1.0);
  std::set<std::string> names;
  for (int i = 0; i < request.weights_size(); ++i) {
    const v1::LightWeight& weight = request.weights(i);
    const std::string field = absl::StrFormat("weights[%d]", i);
    const auto found =
        std::find_if(task->lights.begin(), task->lights.end(), [&weight](const Light& light) {
          return light.name == weight.light();
        });
    if (found == task->lights.end()) {
      return absl::InvalidArgumentError(
          absl::StrFormat("%s.light = %s: there is no such light", field, Quoted(weight.light())));
    }
    if (!names.insert(weight.light()).second) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "%s.light = %s: has a weight already, want one", field, Quoted(weight.light())));
    }
    if (!(weight.weight() > 0.0) || !std::isfinite(weight.weight())) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "%s.weight = %g, want a number above 0; to give %s no texels, leave the light out",
          field,
          weight.weight(),
          Quoted(weight.light())));
    }
    task->weights[static_cast<size_t>(found - task->lights.begin())] = weight.weight();
  }
  return absl::OkStatus();
}

// Fits and hands back what the task asks for. Lights that could not be used keep their name alone.
absl::StatusOr<v1::Allocation> Answer(const v1::AllocateRequest& request, AllocationTask* task) {
  const absl::StatusOr<ClipConvention> clip = ClipOfRequest(request);
  if (!clip.ok()) return clip.status();
  if (task->plans.has_value()) {
    task->rules = task->plans->sizes.value_or(MapSizeRules());
  } else {
    task->rules = MapSidesFromProto(request.rules());
    absl::Status status = ValidateMapSizeRules(task->rules, task->options.margin_texels);
    if (!status.ok()) return status;
  }
  if (absl::Status status = ReadWeights(request, task); !status.ok()) return status;

  absl::StatusOr<AllocationReport> report = AllocateLights(*task, [](const std::string&) {});
  if (StopRequested()) return StoppedError();
  if (!report.ok()) return report.status();
  report->fit.source = request.readback().source();
  report->fit.clip = *clip;
  v1::Allocation allocation = AllocationMessage(*report, IsOfSummaries(request));
  for (size_t i = 0; i < task->light_status.size(); ++i) {
    if (!task->light_status[i].ok()) allocation.mutable_lights(static_cast<int>(i))->clear_light();
  }
  if (task->summaries.has_value()) {
    SayMissingFrames(task->summaries->lights, allocation.mutable_lights());
  }
  if (absl::Status status = CheckFinite(allocation, "allocation"); !status.ok()) return status;
  return allocation;
}

}  // namespace

absl::StatusOr<v1::Allocation> AnswerAllocate(const v1::AllocateRequest& request,
                                              const CallContext& context) {
  const StopScope stop_scope(context.stop);
  AllocationTask task;
  absl::Status status = CheckSource(request);
  if (status.ok()) status = ReadGoal(request, &task);
  if (!status.ok()) return status;
  if (IsOfSummaries(request)) {
    status = ReadSummaries(request, context.limits, &task);
    if (!status.ok()) return status;
    return Answer(request, &task);
  }
  const absl::StatusOr<std::vector<RequestLight>> lights = LightsOfRequest(request.lights());
  if (!lights.ok()) return lights.status();
  const absl::StatusOr<ReadbackView> readback =
      ReadbackView::Of(request.readback(), request.lights_size(), context.limits);
  if (!readback.ok()) return readback.status();
  CheckedReadback checked;
  status = ReadReadback(request, *readback, *lights, context.limits, &task, &checked);
  if (!status.ok()) return status;
  absl::StatusOr<v1::Allocation> allocation = Answer(request, &task);
  if (allocation.ok()) checked.PutInto(allocation->mutable_readback());
  return allocation;
}

}  // namespace lightfit
