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
  kExitOk = 0,         // everything asked for was done
  kExitUsage = 1,      // the command line could not be understood
  kExitBadInput = 2,   // an input cannot be used, or an output cannot be written
  kExitIncomplete = 3  // done, but for some lights, which were named on stderr
};

// "lightfit: error: ..." on stderr, one line. Where the library names an option that has a flag,
// the flag is what is said.
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
