// optimizer/readback/kernels.h
//
// The two passes over all pixels of a read-back, vectorised with run-time dispatch (Highway).
// Everything else looks at few pixels only. Results do not depend on the vector width.
#pragma once

#include <cstddef>
#include <cstdint>

namespace lightfit::internal {

// What a depth value is: surfaces lie strictly between surface_min and surface_max, the background
// from background_min to background_max; anything else (NaN among it) is invalid.
struct DepthIntervals {
  float surface_min, surface_max;
  float background_min, background_max;
};

struct DepthStatistics {
  float min = 0, max = 0;  // over the surfaces; meaningless without any
  int num_surface = 0;
  int num_background = 0;
};

// Statistics of the rectangle of `columns` x `rows` values whose rows are `stride` apart. With
// `bits` (laid out as `depth`; else null) only surfaces with a bit of `mask` count.
DepthStatistics ScanDepth(const float* depth,
                          const uint32_t* bits,
                          uint32_t mask,
                          size_t stride,
                          size_t columns,
                          size_t rows,
                          const DepthIntervals& intervals);

// Columns x of 1 ... width - 2 at which a bit of `mask` differs from the neighbour's to the left,
// right, above or below. `row` points at the first word of the row; the rows above and below are
// `stride` words away. Writes the columns to `columns` (room for width) in order, returns how many.
size_t ScanBoundary(
    const uint32_t* row, size_t stride, size_t width, uint32_t mask, int32_t* columns);

}  // namespace lightfit::internal
