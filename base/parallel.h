// base/parallel.h
//
// Loops over all processors. What each step writes is its own, so results never depend on how many.
#pragma once

#include <functional>

namespace lightfit {

// As many as there are processors.
int NumProcessors();

// Calls `run(begin, end)` for consecutive ranges of at most `chunk` that together are 0 ... count,
// from `num_threads` threads (the caller's among them); returns when all are done.
void ParallelFor(int count, int chunk, int num_threads, const std::function<void(int, int)>& run);

}  // namespace lightfit
