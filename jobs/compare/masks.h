// jobs/compare/masks.h
//
// The wrong pixels of every method for one light, as images: for `lightfit compare --masks`.
// In:   a LightComparison with its images, CompareOptions::keep_images.
// Out:  channels for WriteImageExr(), a layer for each method; the name of the light's file.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "io/image_exr_write.h"
#include "jobs/compare/rows.h"

namespace lightfit {

// METHOD.ideal and METHOD.practical, 1 where the method's shadow is wrong with that bias, else 0;
// truth.shadow, 1 in shadow, and truth.facing, 1 where the surface faces the light: only there a
// shadow is looked up. Where a wrong pixel is in shadow, light leaks; where it is not, the shadow
// is false. Of the first phase, JudgeOptions::phases. Spaces in names become "_"; methods without
// maps have no layer. InvalidArgument where there are no images.
absl::StatusOr<std::vector<ExrImage>> MaskImages(const LightComparison& light);

// "LIGHT.exr" for each: what is no letter, digit, ".", "_" or "-" becomes "_", and names that would
// be the same get numbers.
std::vector<std::string> MaskFileNames(absl::Span<const Light> lights);

}  // namespace lightfit
