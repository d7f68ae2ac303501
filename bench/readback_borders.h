// bench/readback_borders.h
//
// What a dark border buys on a renderer's own read-backs, by footprints.
// In:   the folder of sets (bench/inputs.h), the size of every map.
// Out:  text: one line for each light of which the third state is known.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "geometry/map_size.h"

namespace lightfit {

// With a dark border over what is fitted by shadow bits alone: the sum of footprints across the
// shadow edges that a map with a dark border serves, in both; each fit's own sum over its own
// edges; and the wrong pixels foretold.
absl::StatusOr<std::string> ReadbackBordersText(const std::string& folder, MapSize map);

}  // namespace lightfit
