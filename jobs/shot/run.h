// jobs/shot/run.h
//
// A whole shot: every mode that is asked for, from the frames to the files.
// In:   ShotContext, which knows what is done already.
// Out:  JSON of every frame and mode, summaries, the CSV; rows for table and plot in the context.
#pragma once

#include "absl/status/status.h"
#include "jobs/shot/context.h"

namespace lightfit {

// The folders that results go into, or why they cannot be written.
absl::Status MakeShotFolders(const ShotJob& job);

// A frame or a light that cannot be used stops nothing: it is in the rows, and in
// ShotContext::frame_status. What is returned is about files that cannot be written.
absl::Status RunShot(ShotContext* context);

}  // namespace lightfit
