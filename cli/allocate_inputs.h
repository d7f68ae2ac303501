// cli/allocate_inputs.h
//
// What `lightfit allocate` works on: the lights with their weights, and what their samples sum to.
// In:   AllocateFlags.
// Out:  AllocateInputs.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/optional.h"
#include "cli/allocate_flags.h"
#include "cli/progress.h"
#include "io/readback_exr.h"
#include "io/summary_set.h"
#include "optimizer/allocation.h"

namespace lightfit {

struct AllocateInputs {
  std::vector<Light> lights;
  std::vector<double> weights;  // element l belongs to lights[l]
  FitOptions options;           // as asked for; of summaries what they were summed by

  // One of the two; element l of theirs belongs to lights[l].
  absl::optional<ReadbackFile> readback;
  absl::optional<SummarySet> summaries;

  double image_scale = 1.0;  // pixels of the final image per pixel of the read-back
};

// InvalidArgument also for a weight of a light that is not there, and for a tolerance that the
// summaries cannot serve.
absl::StatusOr<AllocateInputs> ReadAllocateInputs(const AllocateFlags& flags);

// The lights with their summaries, or why a light has none.
std::vector<AllocationLight> SummarizeLights(const AllocateInputs& inputs, Progress* progress);

}  // namespace lightfit
