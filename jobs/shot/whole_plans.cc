#include "jobs/shot/whole_plans.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "partition/ray_sum.h"
#include "partition/served_rays.h"

namespace lightfit {
namespace {

// Of all frames of a light together, some 30 MB.
constexpr int kMostSamples = 1 << 18;
constexpr int kMostBins = 1 << 16;
constexpr int kLeastSamplesOfFrame = 64, kLeastBinsOfFrame = 32;

// In the order of the frames, so that nothing depends on who was first.
absl::StatusOr<ShotAnswer> FitSumOf(size_t light, ShotContext* context) {
  const ShotJob& job = context->job;
  std::optional<RaySum> sum;
  int num_without = 0;
  absl::Status failure = absl::FailedPreconditionError(
      absl::StrFormat("light \"%s\": no frame of the shot could be read", job.lights[light].name));
  for (FrameRaySums& frame : context->ray_sums) {
    absl::StatusOr<RaySum>& own = frame[light];
    if (!own.ok()) {
      if (num_without++ == 0) failure = own.status();
      continue;
    }
    if (sum.has_value()) {
      if (absl::Status status = AddToSum(*own, &*sum); !status.ok()) return status;
    } else {
      sum = *std::move(own);
    }
  }
  if (!sum.has_value()) return failure;
  if (num_without > 0) {
    context->notes.push_back(absl::StrCat("per-shot: light \"",
                                          job.lights[light].name,
                                          "\" is fitted to ",
                                          sum->num_frames,
                                          " of ",
                                          job.frames.size(),
                                          " frames; the others have nothing of it, such as ",
                                          std::string(failure.message())));
  }
  absl::StatusOr<LightPlan> plan = FitRaySum(*sum, job.plans->plan);
  if (!plan.ok()) return plan.status();
  TrackedPlan tracked;
  tracked.plan = *std::move(plan);
  return tracked;
}

}  // namespace

FrameRaySums SumRaysOfFrame(const ShotJob& job, const FrameViews& views) {
  const int num_frames = static_cast<int>(job.frames.size());
  ServedRaysOptions options;
  options.max_bins = std::clamp(kMostBins / num_frames, kLeastBinsOfFrame, options.max_bins);
  const int most_samples = std::max(kLeastSamplesOfFrame, kMostSamples / num_frames);
  FrameRaySums sums;
  for (size_t i = 0; i < job.lights.size(); ++i) {
    const absl::Status still = job.StandsStill(i);
    if (!still.ok() || !views[i].ok()) {
      sums.emplace_back(still.ok() ? views[i].status() : still);
      continue;
    }
    const absl::StatusOr<ServedRays> rays = FindServedRays(*views[i], job.fit(), options);
    if (rays.ok()) {
      sums.emplace_back(SumOfRays(*rays, *views[i], most_samples));
    } else {
      sums.emplace_back(rays.status());
    }
  }
  return sums;
}

ShotAnswers FitShotPlans(ShotContext* context) {
  ShotAnswers answers;
  for (size_t light = 0; light < context->job.lights.size(); ++light) {
    answers.push_back(FitSumOf(light, context));
  }
  context->ray_sums.clear();
  return answers;
}

}  // namespace lightfit
