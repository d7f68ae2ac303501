// tests/testing/allocation_counter.h
//
// Counts what a whole program takes from the heap, for tests that allow nothing.
// In:   allocation_counter.cc among the sources of the test program.
// Out:  the number of allocations so far: malloc, and so operator new, Eigen and every library.
#pragma once

#include <cstdint>

namespace lightfit::testing {

// By all threads, since the program began.
int64_t NumAllocations();

}  // namespace lightfit::testing
