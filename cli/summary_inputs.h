// cli/summary_inputs.h
//
// Summary files as the inputs of a verb.
// In:   files of `lightfit summarize`, and the lights that --only names.
// Out:  their sum, and the options to fit it by; what people should know of it.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "cli/fit_flags.h"
#include "io/summary_file.h"
#include "lightfit/v1/result.pb.h"

namespace lightfit {

// All of the files, or the first error.
absl::StatusOr<SummarySet> ReadSummaries(const std::vector<std::string>& paths,
                                         const std::vector<std::string>& only);

// One of them, of which the lights are kept that `only` names; all when it names none.
absl::StatusOr<SummarySet> ReadSummary(const std::string& path,
                                       const std::vector<std::string>& only);

// InvalidArgument when --metric or --cover were given and are not what the summaries hold.
absl::Status CheckHeld(const FitFlags& flags, const FitOptions& held);

// What the samples were summed by is as in the summaries; the search is as asked for, and without
// statistics. Errors are those of CheckHeld().
absl::StatusOr<FitOptions> OptionsFor(const FitFlags& flags, const FitOptions& held);

// The light's sum as Fit() takes it, or why there is none.
absl::StatusOr<Summary> SummaryOf(const LightSummary& light);

// "light "key": nothing of it in 3 of 24 frames, such as 0007.exr: ...". Empty when all have it.
std::string MissingFramesText(const LightSummary& light);

// The files' names in an order that does not depend on the command line's: for results.
std::string SourceText(std::vector<std::string> paths);

// The file's name, or how many there are: for people.
std::string TitleText(const std::vector<std::string>& paths);

// Takes out of a result what only a read-back can tell.
void ClearReadbackFigures(v1::ReadbackInfo* readback,
                          google::protobuf::RepeatedPtrField<v1::LightResult>* lights);

}  // namespace lightfit
