// calls/grow.h
//
// Memory for pixels that arrive in pieces.
// In:   an array, and how long it is to be.
// Out:  the array, longer.
//
// A header says how many pixels will come, and anybody can say so. Memory is taken for what has
// come, and as much again.
#pragma once

#include <algorithm>
#include <cstddef>

namespace lightfit {

// `most` is what it will be in the end, at least `size`. It does not get shorter; new values are 0.
template <typename Values>
void GrowTo(size_t size, size_t most, Values* values) {
  if (size <= values->size()) return;
  if (size > values->capacity()) {
    values->reserve(std::min(most, std::max(size, 2 * values->capacity())));
  }
  values->resize(size);
}

}  // namespace lightfit
