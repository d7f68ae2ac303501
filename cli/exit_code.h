// cli/exit_code.h
//
// What a verb tells the shell, and how it speaks on stderr.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace lightfit::cli {

enum ExitCode {
  kExitOk = 0,        // everything asked for was done
  kExitUsage = 1,     // the command line could not be understood
  kExitBadInput = 2,  // an input cannot be used, an output cannot be written, or nothing was fitted
  kExitIncomplete = 3  // done, but for some lights, which were named on stderr
};

// Of a verb that did without `num_failed` of `num_all` lights, frames or files.
ExitCode CodeFor(int num_failed, int num_all);

// "lightfit: error: ..." on stderr, one line, in the words of the command line
// (command_line/option_words.h).
void PrintError(absl::string_view message);
void PrintWarning(absl::string_view message);

void PrintWarnings(const std::vector<std::string>& messages);

// The error on stderr; returns `code`.
int Fail(ExitCode code, const absl::Status& status);

// "no matrix for light "sun": ..." on stderr; `what` is what there is none of.
void PrintFailedLight(absl::string_view what,
                      absl::string_view light_name,
                      const absl::Status& status);

}  // namespace lightfit::cli
