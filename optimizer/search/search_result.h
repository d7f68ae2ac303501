// optimizer/search/search_result.h
//
// What a search for the axis ends with: the best map, how it was found, and why the search stopped.
#pragma once

#include <string>
#include <string_view>

#include "base/scratch.h"
#include "optimizer/search/affine.h"

namespace lightfit {

enum class StopReason {
  kNoSearch,      // kFocused: there was nothing to search
  kConverged,     // no neighbour of the axis is better
  kRoundLimit,    // the rounds asked for are done
  kAxisAtLimit,   // the best axis lies on the limit of the warp (SearchOptions::min_w)
  kTooFewSamples  // fewer than SampleOptions::min_samples: the focused map instead
};

const char* StopReasonName(StopReason reason);

// One accepted step of the search.
struct TraceStep {
  // A literal: "start", "line_search", "grid", "refine", "polish", "exact".
  std::string_view station;
  int evaluations = 0;  // matrices evaluated so far
  double energy = 0;
};

// How a search went.
struct SearchReport {
  double energy_start = 0.0;  // where it began; what it ends with never exceeds it
  StopReason stop_reason = StopReason::kConverged;
  int evaluations = 0;  // of maps
  ScratchVector<TraceStep> trace;
  std::string solver_report;  // Ceres' own words, Refiner::kCeres only
};

// What every station of the search returns; those that only go on from a start leave
// `energy_start` and `trace` alone.
struct SearchResult {
  AffineFit fit;
  SearchReport report;
};

}  // namespace lightfit
