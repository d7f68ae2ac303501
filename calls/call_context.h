// calls/call_context.h
//
// What a call is given beside its request: how much it may take, and when to stop.
#pragma once

#include <cstdint>
#include <stop_token>

namespace lightfit {

// More than this is refused with RESOURCE_EXHAUSTED before any memory is taken for it.
struct CallLimits {
  int64_t max_pixels = int64_t{64} << 20;  // of one read-back: 8192 x 8192
  // Of one read-back, at the borders of shadows and, where that is known, of surfaces that face a
  // light: each takes some 250 bytes while lights are fitted, 400 while plans are.
  int64_t max_boundary_pixels = int64_t{1} << 20;
  int max_maps = 32;         // PlanOptions.max_maps; what a plan takes of time grows with it
  int max_matrices = 1024;   // EvaluateRequest.matrices
  int max_summaries = 4096;  // summaries and summary_files together
};

struct CallContext {
  CallLimits limits;

  // When it says stop, the call returns CANCELLED within a few milliseconds.
  std::stop_token stop;
};

}  // namespace lightfit
