// picture/compare_choice.h
//
// What of a comparison a picture shows, and in which order.
// In:   LightComparisons; with their images for the crop.
// Out:  the light, the methods in order, the part of the image to enlarge.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/types/span.h"
#include "jobs/compare/rows.h"
#include "picture/shadow_panel.h"
#include "render/judge.h"

namespace lightfit {

// Whether there are wrong pixels to count and, with CompareOptions::keep_images, shadows to draw:
// what the next two require.
bool HasImage(const ComparedRow& map);
int64_t CountOf(const ComparedRow& map, Bias bias);
const std::vector<Lighting>& ShadowsOf(const ComparedRow& map, Bias bias);

// Lightfit first, then from the fewest wrong pixels up, then those without a matrix.
std::vector<const ComparedRow*> InOrder(const LightComparison& light, Bias bias);

// The method that the crop sets lightfit against: the focused map, or where there is none the one
// with most wrong pixels. Null when no other method has an image.
const ComparedRow* Rival(const LightComparison& light, Bias bias);

// Where the rival has most wrong pixels over lightfit's, in an image of width x height.
CropBox ChooseCrop(const LightComparison& light, Bias bias, int width, int height, CropBox size);

// The light on which the focused map and lightfit differ most in wrong pixels; the first when there
// is none. Requires a light.
size_t MostTellingLight(absl::Span<const LightComparison> lights, Bias bias);

}  // namespace lightfit
