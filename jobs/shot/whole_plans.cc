#include "jobs/shot/whole_plans.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/parallel.h"
#include "jobs/shot/judge.h"
#include "partition/ray_sum.h"
#include "partition/served_rays.h"

namespace lightfit {
namespace {

// Of all frames of a light together, some 30 MB.
constexpr int kMostSamples = 1 << 18;
constexpr int kMostBins = 1 << 16;
constexpr int kLeastSamplesOfFrame = 64, kLeastBinsOfFrame = 32;

// One frame's part in each light's sum, or why it has none.
using FrameSums = std::vector<absl::StatusOr<RaySum>>;

FrameSums SumsOfFrame(const ShotJob& job, size_t frame, ShotContext* context) {
  const absl::StatusOr<ReadbackFile> file = ReadFrame(job.frames[frame], job.lights);
  context->frame_status[frame] = file.status();
  const FrameViews views(job, file);
  const int num_frames = static_cast<int>(job.frames.size());
  ServedRaysOptions options;
  options.max_bins = std::clamp(kMostBins / num_frames, kLeastBinsOfFrame, options.max_bins);
  const int most_samples = std::max(kLeastSamplesOfFrame, kMostSamples / num_frames);
  FrameSums sums;
  for (size_t i = 0; i < job.lights.size(); ++i) {
    if (!views[i].ok()) {
      sums.emplace_back(views[i].status());
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

// In the order of the frames, so that nothing depends on who was first.
absl::StatusOr<ShotAnswer> FitSumOf(size_t light,
                                    std::vector<FrameSums>* frames,
                                    ShotContext* context) {
  const ShotJob& job = context->job;
  std::optional<RaySum> sum;
  int num_without = 0;
  absl::Status failure = absl::FailedPreconditionError(
      absl::StrFormat("light \"%s\": no frame of the shot could be read", job.lights[light].name));
  for (FrameSums& frame : *frames) {
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
                                          frames->size(),
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

ShotAnswers FitShotPlans(ShotContext* context) {
  const ShotJob& job = context->job;
  const auto num_frames = static_cast<int>(job.frames.size());
  std::vector<FrameSums> frames(job.frames.size());
  ParallelFor(num_frames, 1, job.num_threads, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      frames[i] = SumsOfFrame(job, i, context);
      context->Step(absl::StrCat("per-shot, what frame ", job.frames[i].name, " shows"));
    }
  });
  ShotAnswers answers;
  for (size_t light = 0; light < job.lights.size(); ++light) {
    answers.push_back(FitSumOf(light, &frames, context));
  }
  return answers;
}

}  // namespace lightfit
