// optimizer/search/search_result.h
//
// What a search for the axis ends with: the best map, how it was found, and why the search stopped.
#pragma once

#include <string_view>

#include "base/scratch.h"
#include "optimizer/search/affine.h"

namespace lightfit {

enum class StopReason {
  kNoSearch,     // kFocused: there was nothing to search
  kConverged,    // no neighbour of the axis is better
  kRoundLimit,   // the rounds asked for are done
  kAxisAtLimit,  // the best axis lies on the limit of the warp (SearchOptions::min_w)
};

const char* StopReasonName(StopReason reason);

// One accepted step of the search.
struct TraceStep {
  // A literal: "start", "line_search", "grid", "refine", "polish", "exact".
  std::string_view station;
  int evaluations = 0;  // matrices evaluated so far
  double energy = 0;
};

struct SearchResult {
  AffineFit fit;
  ScratchVector<TraceStep> trace;
  StopReason stop_reason = StopReason::kConverged;
};

}  // namespace lightfit
