#include "optimizer/search/search_result.h"

namespace lightfit {

const char* StopReasonName(StopReason reason) {
  switch (reason) {
    case StopReason::kNoSearch:
      return "no_search";
    case StopReason::kConverged:
      return "converged";
    case StopReason::kRoundLimit:
      return "round_limit";
    case StopReason::kAxisAtLimit:
      return "axis_at_limit";
    case StopReason::kTooFewSamples:
      return "too_few_samples";
  }
  return "unknown";
}

}  // namespace lightfit
