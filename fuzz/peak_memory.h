// fuzz/peak_memory.h
//
// The most memory that the program had from the heap at once, for what must be in proportion.
// In:   peak_memory.cc among the sources of a program; nothing under sanitizers, which have their
//       own heap.
// Out:  bytes.
#pragma once

#include <cstdint>

namespace lightfit::fuzz {

// From here on.
void StartPeak();

// The most at once since then, beyond what there was then. 0 under sanitizers.
int64_t PeakBytes();

}  // namespace lightfit::fuzz
