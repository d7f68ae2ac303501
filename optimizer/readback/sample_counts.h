// optimizer/readback/sample_counts.h
//
// Where the candidate samples of one light went.
#pragma once

#include <cstdint>

namespace lightfit {

// Counts of read-back pixels.
struct SampleCounts {
  int64_t receivers = 0;      // pixels with a surface
  int64_t invalid_depth = 0;  // pixels with NaN, negative or out-of-range depth: ignored
  int64_t candidates = 0;     // pixels whose shadow bit differs from a neighbour's; background: 0
  int64_t background = 0;     // candidates without a surface, or with none on the other side
  int64_t discontinuity = 0;  // candidates at a depth discontinuity
  int64_t facing_away = 0;    // candidates whose surface, or whose lit side, faces away
  int64_t edge_on = 0;        // candidates edge-on to the light or the eye
  int64_t used = 0;           // candidates - all of these but receivers, invalid_depth
  int64_t beyond_map = 0;     // candidates far outside what a map with a dark border must cover
};

}  // namespace lightfit
