// optimizer/readback/fine_cover.h
//
// What stands between the pixels of a read-back: things thinner than one, for the cover alone.
// In:   Readback with a FineCover.
// Out:  the same view as one or two finer read-backs, of the nearest and of the furthest surfaces.
#pragma once

#include "absl/status/status.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

// InvalidArgument for sizes that do not belong together.
absl::Status ValidateFineCover(const Readback& readback);

// How many layers of surfaces its cells have, and one of them as a read-back with `words` for
// shadow bits. Requires readback.fine_cover != nullptr; refers to its buffers.
int NumFineLayers(const FineCover& fine);
Readback FineLayer(const Readback& readback, int layer, absl::Span<const uint32_t> words);

}  // namespace lightfit
