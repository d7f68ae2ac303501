// optimizer/sizing/map_sizes.h
//
// The sizes that a shadow map may have: what hardware, or an engine's texture pool, takes.
// In:   MapSizeRules.
// Out:  the sides to choose from, and sizes in order of their texels.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "geometry/map_size.h"

namespace lightfit {

// Both sides of every map. Maps need not be square.
struct MapSizeRules {
  int multiple = 64;           // texels; sides are multiples of it. >= 1
  bool powers_of_two = false;  // sides are powers of two instead, and `multiple` does not count
  int min_side = 64;           // texels, >= 1
  int max_side = 16384;        // texels, min_side ... 65536
};

// InvalidArgument also when no side at all keeps the rules, or `margin_texels` on both sides
// (FitOptions::margin_texels) leave nothing of the smallest. `field` is what messages call them.
absl::Status ValidateMapSizeRules(const MapSizeRules& rules,
                                  double margin_texels = 0.0,
                                  absl::string_view field = "rules");

// The sides that keep the rules, ascending. Beyond 64 multiples only some of them, 1/64 apart:
// nothing is to be gained by smaller steps.
std::vector<int> AllowedSides(const MapSizeRules& rules);

// Whether both sides are among them, or, of multiples, would be but for the steps.
bool KeepsRules(MapSize map, const MapSizeRules& rules);

inline int64_t TexelsOf(MapSize map) { return int64_t{map.width} * map.height; }

// A size, and what a light's map of that size costs (its energy, say).
struct RatedSize {
  MapSize map;
  int64_t texels = 0;
  double cost = 0.0;
};

// Those sizes that cost less than every size of no more texels: ascending in texels, descending in
// cost.
std::vector<RatedSize> WorthwhileSizes(std::vector<RatedSize> sizes);

}  // namespace lightfit
