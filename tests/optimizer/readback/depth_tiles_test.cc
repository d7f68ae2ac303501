#include "optimizer/readback/depth_tiles.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "geometry/affine_depth.h"
#include "tests/testing/plane_readback.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::PlaneReadback;
using testing::Random;

constexpr DepthKind kAllKinds[] = {DepthKind::kCameraZ,
                                   DepthKind::kDistance,
                                   DepthKind::kNdcZeroToOne,
                                   DepthKind::kNdcMinusOneToOne,
                                   DepthKind::kNdcReversedZeroToOne};

// Random depths with holes and rubbish, and random bits: rare ones (0), some (1), all (2), none
// (3).
PlaneReadback RandomReadback(
    Random& random, DepthKind kind, bool orthographic, int width, int height) {
  Camera camera = testing::FloorCamera(width, height);
  if (orthographic) {
    camera.orthographic = true;
    camera.screen_from_camera(0, 0) = camera.screen_from_camera(1, 1) = 0.2 * height;
  }
  PlaneReadback readback(camera, kind, Eigen::Vector3d::UnitZ(), 0.0);
  const AffineDepth affine_depth(camera, kind);
  const bool is_ndc = kind != DepthKind::kCameraZ && kind != DepthKind::kDistance;
  const auto background =
      static_cast<float>(is_ndc ? affine_depth.background_max() : 2.0 * kBackgroundDepth);
  const int rarity = random.Int(1, 12);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const size_t pixel = readback.Index(x, y);
      readback.depth[pixel] =
          static_cast<float>(readback.DepthValue(x, y, random.LogUniform(1.0, 20.0)));
      const int hole = random.Int(0, 3 * rarity);
      if (hole == 0) readback.depth[pixel] = background;
      if (hole == 1) readback.depth[pixel] = std::numeric_limits<float>::quiet_NaN();
      if (random.Int(0, 20 * rarity) == 0) readback.shadow_bits[pixel] |= 1u;
      if (random.Coin()) readback.shadow_bits[pixel] |= 2u;
      readback.shadow_bits[pixel] |= 4u;
    }
  }
  return readback;
}

// What a tile should be, looked up pixel by pixel.
DepthTile Plainly(const Readback& readback,
                  const AffineDepth& affine_depth,
                  uint32_t mask,
                  DepthTile tile) {
  tile.d_min = std::numeric_limits<double>::infinity();
  tile.d_max = -tile.d_min;
  tile.num_surfaces = 0;
  for (int y = tile.y_begin; y < tile.y_end; ++y) {
    for (int x = tile.x_begin; x < tile.x_end; ++x) {
      const size_t pixel = static_cast<size_t>(y) * readback.width() + x;
      if (!affine_depth.IsSurface(readback.depth[pixel])) continue;
      if (mask != 0 && (readback.shadow_bits[pixel] & mask) == 0) continue;
      const double d = affine_depth.At(x, y, readback.depth[pixel]);
      tile.d_min = std::min(tile.d_min, d);
      tile.d_max = std::max(tile.d_max, d);
      ++tile.num_surfaces;
    }
  }
  return tile;
}

void ExpectTilesOf(const PlaneReadback& readback, uint32_t mask) {
  const Readback view = readback.View();
  const AffineDepth affine_depth(view.camera, view.depth_kind);
  const DepthTiles tiles = BuildDepthTiles(view, affine_depth, {view.shadow_bits, mask});
  EXPECT_EQ(tiles.filter.mask, mask);
  const DepthTile whole =
      Plainly(view, affine_depth, mask, {0, 0, view.width(), view.height(), 0.0, 0.0, 0});
  EXPECT_EQ(tiles.num_surfaces, whole.num_surfaces);
  int64_t num_background = 0;
  for (const float depth : view.depth) {
    num_background += static_cast<int64_t>(depth >= affine_depth.background_min() &&
                                           depth <= affine_depth.background_max());
  }
  EXPECT_EQ(tiles.num_background, num_background);

  ASSERT_FALSE(tiles.grids.empty());
  EXPECT_LE(tiles.grids.back().tiles.size(), 64u);
  for (const TileGrid& grid : tiles.grids) {
    ASSERT_EQ(grid.tiles.size(), static_cast<size_t>(grid.columns) * grid.rows);
    std::vector<int> times_covered(view.depth.size(), 0);
    for (const DepthTile& tile : grid.tiles) {
      for (int y = tile.y_begin; y < tile.y_end; ++y) {
        for (int x = tile.x_begin; x < tile.x_end; ++x) ++times_covered[readback.Index(x, y)];
      }
      const DepthTile expected = Plainly(view, affine_depth, mask, tile);
      EXPECT_EQ(tile.num_surfaces, expected.num_surfaces);
      if (expected.num_surfaces == 0) continue;
      EXPECT_EQ(tile.d_min, expected.d_min);
      EXPECT_EQ(tile.d_max, expected.d_max);
    }
    EXPECT_EQ(std::count(times_covered.begin(), times_covered.end(), 1),
              static_cast<std::ptrdiff_t>(view.depth.size()));
  }
}

TEST(BuildDepthTiles, EqualsAPlainLoopForEveryKindAndFilter) {
  Random random(181);
  for (const DepthKind kind : kAllKinds) {
    for (const bool orthographic : {false, true}) {
      for (const auto& [width, height] :
           {std::pair(1, 1), std::pair(9, 7), std::pair(100, 67), std::pair(530, 31)}) {
        SCOPED_TRACE(DepthKindName(kind) + std::string(orthographic ? " orthographic " : " ") +
                     std::to_string(width));
        const PlaneReadback readback = RandomReadback(random, kind, orthographic, width, height);
        for (const uint32_t mask : {0u, 1u, 2u, 3u, 4u, 8u}) ExpectTilesOf(readback, mask);
      }
    }
  }
}

// A tile of a coarse grid is made of the 4 x 4 finer ones at the same place.
TEST(BuildDepthTiles, CoarseTilesAreMadeOfFinerOnes) {
  Random random(182);
  const PlaneReadback readback = RandomReadback(random, DepthKind::kCameraZ, false, 323, 177);
  const AffineDepth affine_depth(readback.camera, readback.kind);
  const DepthTiles tiles =
      BuildDepthTiles(readback.View(), affine_depth, {readback.shadow_bits, 1u});
  ASSERT_GE(tiles.grids.size(), 2u);
  constexpr int kSide = DepthTiles::kTilesPerSide;
  for (size_t level = 1; level < tiles.grids.size(); ++level) {
    const TileGrid& coarse = tiles.grids[level];
    const TileGrid& fine = tiles.grids[level - 1];
    for (int row = 0; row < fine.rows; ++row) {
      for (int column = 0; column < fine.columns; ++column) {
        const DepthTile& part = fine.tiles[static_cast<size_t>(row) * fine.columns + column];
        const DepthTile& whole =
            coarse.tiles[static_cast<size_t>(row / kSide) * coarse.columns + column / kSide];
        EXPECT_LE(whole.x_begin, part.x_begin);
        EXPECT_LE(whole.y_begin, part.y_begin);
        EXPECT_GE(whole.x_end, part.x_end);
        EXPECT_GE(whole.y_end, part.y_end);
      }
    }
  }
}

TEST(ForEachSurface, VisitsWhatTheFilterLetsThroughInRowOrder) {
  Random random(183);
  const PlaneReadback readback = RandomReadback(random, DepthKind::kDistance, false, 40, 30);
  const AffineDepth affine_depth(readback.camera, readback.kind);
  const DepthTile tile = {5, 3, 33, 27, 0.0, 0.0, 0};
  for (const uint32_t mask : {0u, 1u, 2u, 8u}) {
    std::vector<std::pair<size_t, double>> visited, expected;
    ForEachSurface(readback.View(),
                   affine_depth,
                   {readback.shadow_bits, mask},
                   tile,
                   [&](int x, int y, double d) { visited.emplace_back(readback.Index(x, y), d); });
    for (int y = 3; y < 27; ++y) {
      for (int x = 5; x < 33; ++x) {
        const size_t pixel = readback.Index(x, y);
        if (!affine_depth.IsSurface(readback.depth[pixel])) continue;
        if (mask != 0 && (readback.shadow_bits[pixel] & mask) == 0) continue;
        expected.emplace_back(pixel, affine_depth.At(x, y, readback.depth[pixel]));
      }
    }
    EXPECT_EQ(visited, expected) << mask;
  }
}

}  // namespace
}  // namespace lightfit
