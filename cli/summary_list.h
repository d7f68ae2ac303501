// cli/summary_list.h
//
// What `lightfit summarize` adds up: read-backs, each with what belongs to its frame, and files.
// In:   the command line's inputs: files, folders and patterns.
// Out:  SummaryInput of each file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "base/frame_number.h"
#include "cli/flags/fit_flags.h"
#include "io/readback_exr.h"

namespace lightfit::cli {

// A read-back, what it is of and how it is read.
struct FrameToSum {
  std::string path;
  std::optional<FrameNumber> number;
  std::vector<Light> lights;
  std::vector<std::string> absent_lights;
  absl::StatusOr<ReadbackExrOptions> exr = ReadbackExrOptions();
};

struct SummaryInput {
  std::string path;
  std::optional<FrameToSum> frame;  // absent: a summary file

  bool is_summary() const { return !frame.has_value(); }
};

// Prints warnings of frames that are missing. InvalidArgument also where the output is among the
// inputs, and as ListFrames().
absl::StatusOr<std::vector<SummaryInput>> ListSummaryInputs(const std::vector<std::string>& inputs,
                                                            const std::string& output_path,
                                                            const FitFlags& flags);

}  // namespace lightfit::cli
