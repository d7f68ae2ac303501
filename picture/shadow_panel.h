// picture/shadow_panel.h
//
// A shadow image as one panel of a picture, wrong pixels marked, and a crop of it enlarged.
// In:   what the camera sees, the truth, the shadows that some map gives.
// Out:  images; and the crop that shows best where two sets of shadows differ.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/types/span.h"
#include "geometry/light.h"
#include "picture/image.h"
#include "render/surface_image.h"
#include "render/true_lighting.h"

namespace lightfit {

// A part of the image, pixels.
struct CropBox {
  int x = 0, y = 0;
  int width = 0, height = 0;
};

// Grey by the cosine between surface and light; darker in shadow. Where `shadows` and `truth`
// differ the pixel is kFalseShadowColor (dark, should be lit) or kLightLeakColor. The others are
// tinted by MapColor() of the map that they ask, where `asked` is not empty and not negative. Grey
// is exposed before it is marked or tinted.
Image ShadeShadows(const SurfaceImage& image,
                   const Light& light,
                   absl::Span<const Lighting> truth,
                   absl::Span<const Lighting> shadows,
                   absl::Span<const int> asked = {},
                   const Exposure& exposure = Exposure());

// What makes the true shadows of a scene that is mostly dark visible.
Exposure ExposureFor(const SurfaceImage& image,
                     const Light& light,
                     absl::Span<const Lighting> truth);

// `full` scaled down by a whole number; wrong pixels stay visible however thin they are. `wrong` is
// row-major, not 0 at wrong pixels.
Image ReducedPanel(const Image& full, absl::Span<const uint8_t> wrong, int factor);

// The crop, every pixel a square of `factor` pixels.
Image EnlargedCrop(const Image& full, const CropBox& crop, int factor);

// 1 where the shadows differ from the truth, else 0.
std::vector<uint8_t> WrongMask(absl::Span<const Lighting> truth,
                               absl::Span<const Lighting> shadows);

// The crop of that size with the largest sum of `gain`, row-major over an image of
// width x height; the first of several, the middle when all sums are alike.
CropBox BestCrop(absl::Span<const int32_t> gain, int width, int height, CropBox size);

}  // namespace lightfit
