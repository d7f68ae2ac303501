// cli/summary_inputs.h
//
// Summary files as the inputs of a verb.
// In:   files of `lightfit summarize`, and the lights that --only names.
// Out:  their sum, and the options to fit it by.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "cli/flags/fit_flags.h"
#include "io/summary_file.h"

namespace lightfit::cli {

// All of the files, also of patterns, or the first error. Prints SummaryAdder::Notes().
absl::StatusOr<SummarySet> ReadSummaries(const std::vector<std::string>& paths,
                                         const std::vector<std::string>& only);

// One of them, of which the lights are kept that `only` names; all when it names none.
absl::StatusOr<SummarySet> ReadSummary(const std::string& path,
                                       const std::vector<std::string>& only);

// InvalidArgument when --metric or --cover were given and are not what the summaries hold.
absl::Status CheckHeld(const FitFlags& flags, const FitOptions& held);

// OptionsForSummaries() of what the flags ask for. Errors are also those of CheckHeld().
absl::StatusOr<FitOptions> OptionsFor(const FitFlags& flags, const FitOptions& held);

// The files' names in an order that does not depend on the command line's: for results.
std::string SourceText(std::vector<std::string> paths);

// The file's name, or how many there are: for people.
std::string TitleText(const std::vector<std::string>& paths);

}  // namespace lightfit::cli
