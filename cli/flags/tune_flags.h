// cli/flags/tune_flags.h
//
// The options of `lightfit tune` as they stand on the command line.
// In:   words; a wrong one is refused while parsing (exit code 1).
// Out:  TuneFlags.
#pragma once

#include <string>

#include "cli/flags/compare_flags.h"
#include "geometry/clip.h"
#include "jobs/tune/tune.h"

namespace CLI {
class App;
}

namespace lightfit::cli {

struct TuneFlags {
  // The scene, its camera and lights, the sizes, how lights are fitted: what `lightfit compare`
  // takes as well.
  CompareFlags compare;

  Bias bias = Bias::kIdeal;
  int evaluations = TuneOptions().evaluations;
  ClipConvention clip = ClipConvention::Vulkan();

  std::string json_path;
  std::string journal_path;  // empty: JournalPath()
  bool quiet = false;

  // Beside the JSON file; empty when there is none and none was named.
  std::string JournalPath() const;
};

// Declares every option on `app`, to be parsed into `flags`, which must stay where it is.
void DeclareTuneFlags(CLI::App* app, TuneFlags* flags);

}  // namespace lightfit::cli
