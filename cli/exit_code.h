// cli/exit_code.h
//
// What a verb tells the shell, and how it speaks on stderr.
#pragma once

#include <cstdio>
#include <string>

#include "absl/strings/string_view.h"

namespace lightfit {

enum ExitCode {
  kExitOk = 0,         // everything asked for was done
  kExitUsage = 1,      // the command line could not be understood
  kExitBadInput = 2,   // an input cannot be used, or an output cannot be written
  kExitIncomplete = 3  // done, but for some lights, which were named on stderr
};

// "lightfit: error: ..." on stderr, one line.
inline void PrintError(absl::string_view message) {
  std::fprintf(stderr, "lightfit: error: %s\n", std::string(message).c_str());
}

inline void PrintWarning(absl::string_view message) {
  std::fprintf(stderr, "lightfit: warning: %s\n", std::string(message).c_str());
}

}  // namespace lightfit
