// cli/flags/summarize_flags.h
//
// The options of `lightfit summarize` as they stand on the command line.
// In:   words; a wrong one is refused while parsing (exit code 1).
// Out:  SummarizeFlags.
#pragma once

#include <string>
#include <vector>

#include "cli/flags/fit_flags.h"

namespace CLI {
class App;
}

namespace lightfit::cli {

struct SummarizeFlags {
  std::vector<std::string> inputs;  // read-backs and summary files
  std::string output_path;
  std::string weigh_by_path;
  FitFlags fit;  // of it: lights, --only, the read-back's channels and camera, metric, cover, quiet
};

// Declares every option on `app`, to be parsed into `flags`, which must stay where it is.
void DeclareSummarizeFlags(CLI::App* app, SummarizeFlags* flags);

}  // namespace lightfit::cli
