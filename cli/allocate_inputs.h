// cli/allocate_inputs.h
//
// What `lightfit allocate` works on: the lights with their weights, their samples and the goal.
// In:   AllocateFlags.
// Out:  AllocateInputs.
#pragma once

#include <optional>

#include "absl/status/statusor.h"
#include "cli/flags/allocate_flags.h"
#include "io/notes/readback_notes.h"
#include "io/readback_exr.h"
#include "jobs/allocate_lights.h"

namespace lightfit::cli {

struct AllocateInputs {
  std::optional<ReadbackFile> readback;  // task.readback refers to it
  ReadbackNotes notes;                   // of it
  AllocationTask task;
  double image_scale = 1.0;  // pixels of the final image per pixel of the read-back
};

// InvalidArgument also for a weight of a light that is not there, and for a tolerance that the
// summaries cannot serve.
absl::StatusOr<AllocateInputs> ReadAllocateInputs(const AllocateFlags& flags);

}  // namespace lightfit::cli
