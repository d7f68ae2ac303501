// cli/flags/allocate_flags.h
//
// The options of `lightfit allocate` as they stand on the command line.
// In:   words; a wrong one is refused while parsing (exit code 1).
// Out:  AllocateFlags.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "cli/flags/fit_flags.h"
#include "optimizer/sizing/map_sizes.h"
#include "optimizer/sizing/tolerance.h"

namespace CLI {
class App;
}

namespace lightfit::cli {

struct AllocateFlags {
  FitFlags fit;  // the read-back or summaries, the lights, the method, the output

  // One of the two.
  std::optional<int64_t> budget_texels;
  std::optional<Tolerance> tolerance;  // image_scale is set once the read-back is known

  std::map<std::string, double> weights;  // by light name
  MapSizeRules rules;
  std::optional<MapSize> image;  // absent: the read-back's own pixels; not with summaries
};

// Declares every option on `app`, to be parsed into `flags`, which must stay where it is.
void DeclareAllocateFlags(CLI::App* app, AllocateFlags* flags);

// "rms:1.0", "p99:1.5" or "worst:3".
absl::StatusOr<Tolerance> ParseTolerance(const std::string& text);

// What the words of ParseTolerance() say: "99 % of the footprints at most 1.5 pixels".
std::string ToleranceText(const Tolerance& tolerance);

// "p99:2.31": the same kind of tolerance, no less than what was reached, as ParseTolerance() takes
// it.
std::string ToleranceThatHolds(const Tolerance& tolerance, double reached_px);

// "sun=2": a name and a number above 0.
absl::StatusOr<std::pair<std::string, double>> ParseWeight(const std::string& text);

}  // namespace lightfit::cli
