// optimizer/search/axis_search.h
//
// The search that SearchOptions ask for: which axis, in which metric.
// In:   one light's summary, and its samples where the search needs them.
// Out:  the best fitted map, where the search began, the trace.   math.md 4 and 6
#pragma once

#include "absl/status/statusor.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "optimizer/energy/summary.h"
#include "optimizer/readback/samples.h"
#include "optimizer/readback/surfaces.h"
#include "optimizer/search/affine.h"
#include "optimizer/search/search_options.h"
#include "optimizer/search/search_result.h"

namespace lightfit {

// What one light's search works on. `samples` and `surfaces` are null when only a summary is known.
struct SearchInputs {
  const Light& light;
  const Summary& summary;
  const Samples* samples = nullptr;
  const Surfaces* surfaces = nullptr;
};

// How far the global and the refined search go.
enum class SearchEffort {
  kUsual,
  kToTheEnd  // of what double precision tells (Polish::kExact), so that the result does not depend
             // on how a summary came about; from a summary alone
};

// What the affine part is fitted for, as the options ask.
AffineProblem MakeAffineProblem(const Summary& summary, MapSize map, const SearchOptions& options);

// Runs SearchOptions::search in SearchOptions::metric. The L1 metrics follow it on reweighted
// samples; from a summary alone they take the weights that are in it (Summary::footprint_sum).
// FailedPrecondition when no axis can be used; CancelledError once a StopScope says so.
absl::StatusOr<SearchResult> SearchAxis(const SearchInputs& inputs,
                                        MapSize map,
                                        const SearchOptions& options,
                                        SearchEffort effort = SearchEffort::kUsual);

}  // namespace lightfit
