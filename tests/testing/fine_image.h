// tests/testing/fine_image.h
//
// A finer image of a view as the finer cover of a coarser one.
// In:   a SyntheticReadback.
// Out:  FineCover, of cells of one pixel or reduced by blocks of pixels.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "optimizer/readback/readback.h"
#include "tests/testing/box_scene.h"

namespace lightfit::testing {

// Owns what its cover refers to.
struct FineImage {
  FineCover cover;
  std::vector<float> nearest, furthest;
  std::vector<uint32_t> shadow, lit;

  explicit FineImage(const SyntheticReadback& image, int block = 1) {
    cover.columns = image.camera.width / block;
    cover.rows = image.camera.height / block;
    for (int y = 0; y < cover.rows; ++y) {
      for (int x = 0; x < cover.columns; ++x) {
        float near = kSyntheticBackground, far = 0.0f;
        uint32_t any_shadow = 0, any_lit = 0;
        for (int i = 0; i < block * block; ++i) {
          const size_t pixel = static_cast<size_t>(y * block + i / block) * image.camera.width +
                               x * block + i % block;
          if (!(image.depth[pixel] < kSyntheticBackground)) continue;
          near = std::min(near, image.depth[pixel]);
          far = std::max(far, image.depth[pixel]);
          any_shadow |= image.shadow_bits[pixel] & image.facing_bits[pixel];
          any_lit |= image.facing_bits[pixel] & ~image.shadow_bits[pixel];
        }
        nearest.push_back(near);
        furthest.push_back(far > 0.0f ? far : kSyntheticBackground);
        shadow.push_back(any_shadow);
        lit.push_back(any_lit);
      }
    }
    cover.nearest = nearest;
    if (block > 1) cover.furthest = furthest;
    cover.shadow_bits = shadow;
    cover.lit_bits = lit;
  }
  FineImage(const FineImage&) = delete;
};

}  // namespace lightfit::testing
