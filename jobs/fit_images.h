// jobs/fit_images.h
//
// What a fit does to each pixel of its read-back, as images: for `lightfit fit --footprint`.
// In:   a Readback, the comparisons of its lights.
// Out:  channels for WriteImageExr(): footprints of the answer, and which pixels it will get wrong.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "io/image_exr_write.h"
#include "jobs/fit_comparison.h"
#include "optimizer/fit_options.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

// Of each light that has an answer:
//  - footprint.LIGHT, read-back pixels per texel, of the map that the pixel asks
//  (FootprintImage());
//    0 without a surface, at depth edges, on surfaces edge-on or turned away, outside of all maps;
//  - wrong.LIGHT, how likely the pixel's shadow is to be wrong, 0 ... 1 (ForetellWrongImage()).
// Over the samples of the tables, FigureOptions(). CancelledError once a StopScope says so.
absl::StatusOr<std::vector<ExrImage>> FitImages(const Readback& readback,
                                                absl::Span<const FitComparison> lights,
                                                const FitOptions& options);

}  // namespace lightfit
