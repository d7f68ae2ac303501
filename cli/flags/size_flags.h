// cli/flags/size_flags.h
//
// Sizes of maps on the command line: one size, texels in all, and the rules that sizes keep.
// In:   words; a wrong one is refused (exit code 1).
// Out:  MapSize, a number of texels, MapSizeRules.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "geometry/map_size.h"
#include "optimizer/sizing/map_sizes.h"

namespace CLI {
class App;
}

namespace lightfit::cli {

// Declares the rules of sizes, --multiple and so on.
void DeclareSizeFlags(CLI::App* app, const std::string& group, MapSizeRules* rules);

// Whether any of them was given to `app`, which has them.
bool HasSizeFlags(const CLI::App& app);

// The sides that "1024x512", "1024X512", "1024×512" or "2kx1k" (2048 and 1024) say; absent where
// that is none of them. Not yet within any limits.
std::optional<std::pair<int, int>> ParseSides(const std::string& text);

// As ParseSides(), or a single number for a square; both sides at least 1 and at most 65536.
absl::StatusOr<MapSize> ParseMapSize(const std::string& text);

// "4096x4096", or a number of texels: 4096 are no map of 4096x4096.
absl::StatusOr<int64_t> ParseTexels(const std::string& text);

}  // namespace lightfit::cli
