#include "optimizer/readback/kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "tests/testing/highway_targets.h"
#include "tests/testing/random_cases.h"

namespace lightfit::internal {
namespace {

using lightfit::testing::ForEachTarget;
using lightfit::testing::Random;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

float RandomDepth(Random& random) {
  constexpr float kSpecial[] = {kNaN,
                                -kNaN,
                                kInfinity,
                                -kInfinity,
                                -1.0f,
                                0.0f,
                                -0.0f,
                                1e9f,
                                1e10f,
                                1.0f,
                                1e-40f,
                                std::numeric_limits<float>::max(),
                                std::numeric_limits<float>::lowest()};
  if (random.Int(0, 3) == 0) return kSpecial[random.Int(0, std::size(kSpecial) - 1)];
  return static_cast<float>(random.LogUniform(1e-3, 1e8));
}

DepthStatistics ScanDepthPlainly(const float* depth,
                                 const uint32_t* bits,
                                 uint32_t mask,
                                 size_t stride,
                                 size_t columns,
                                 size_t rows,
                                 const DepthIntervals& intervals) {
  DepthStatistics statistics;
  statistics.min = std::numeric_limits<float>::max();
  statistics.max = std::numeric_limits<float>::lowest();
  for (size_t y = 0; y < rows; ++y) {
    for (size_t x = 0; x < columns; ++x) {
      const float value = depth[y * stride + x];
      if (value > intervals.surface_min && value < intervals.surface_max) {
        if (bits != nullptr && (bits[y * stride + x] & mask) == 0) continue;
        ++statistics.num_surface;
        statistics.min = std::min(statistics.min, value);
        statistics.max = std::max(statistics.max, value);
      } else if (value >= intervals.background_min && value <= intervals.background_max) {
        ++statistics.num_background;
      }
    }
  }
  return statistics;
}

// Without bits every surface counts; with them those with a bit of the mask, from rare to frequent.
// The background counts either way.
TEST(ScanDepth, EqualsPlainLoopOnEveryTarget) {
  constexpr DepthIntervals kIntervals[] = {{0.0f, 1e9f, 1e9f, kInfinity},   // distances
                                           {-1.000001f, 1.0f, 1.0f, 1.0f},  // NDC
                                           {0.0f, 1.000001f, 0.0f, 0.0f}};  // reversed NDC
  ForEachTarget([&](const char*) {
    Random random(131);
    for (int i = 0; i < 1200; ++i) {
      const size_t columns = random.Int(1, 40), rows = random.Int(1, 9);
      const size_t stride = columns + random.Int(0, 7);
      // Exactly as large as the image, so that reading past its end is caught by the sanitizer.
      std::vector<float> depth(stride * (rows - 1) + columns);
      for (float& value : depth) value = RandomDepth(random);
      const int rarity = random.Int(0, 5);
      std::vector<uint32_t> words(depth.size());
      for (uint32_t& word : words) word = random.Int(0, rarity) == 0 ? random.Bits() : 0u;
      const uint32_t masks[] = {uint32_t{1} << random.Int(0, 31), random.Bits(), ~0u, 0u};
      const uint32_t mask = masks[random.Int(0, 3)];
      const uint32_t* bits = i % 2 == 0 ? nullptr : words.data();
      const DepthIntervals& intervals = kIntervals[i % 3];
      const DepthStatistics expected =
          ScanDepthPlainly(depth.data(), bits, mask, stride, columns, rows, intervals);
      const DepthStatistics actual =
          ScanDepth(depth.data(), bits, mask, stride, columns, rows, intervals);
      EXPECT_EQ(actual.num_surface, expected.num_surface) << columns << " x " << rows;
      EXPECT_EQ(actual.num_background, expected.num_background) << columns << " x " << rows;
      if (expected.num_surface == 0) continue;
      EXPECT_EQ(actual.min, expected.min) << columns << " x " << rows;
      EXPECT_EQ(actual.max, expected.max) << columns << " x " << rows;
    }
  });
}

TEST(ScanDepth, CountsNothingInInvalidDepth) {
  ForEachTarget([](const char*) {
    const std::vector<float> depth(37, kNaN);
    const DepthStatistics statistics =
        ScanDepth(depth.data(), nullptr, 0, 37, 37, 1, {0.0f, 1e9f, 1e9f, kInfinity});
    EXPECT_EQ(statistics.num_surface, 0);
    EXPECT_EQ(statistics.num_background, 0);
  });
}

std::vector<int32_t> ScanBoundaryPlainly(const std::vector<uint32_t>& bits,
                                         size_t row,
                                         size_t width,
                                         uint32_t mask) {
  std::vector<int32_t> columns;
  for (size_t x = 1; x + 1 < width; ++x) {
    const size_t here = row * width + x;
    for (const size_t other : {here - 1, here + 1, here - width, here + width}) {
      if (((bits[here] ^ bits[other]) & mask) == 0) continue;
      columns.push_back(static_cast<int32_t>(x));
      break;
    }
  }
  return columns;
}

TEST(ScanBoundary, EqualsPlainLoopOnEveryTarget) {
  ForEachTarget([](const char*) {
    Random random(132);
    for (int i = 0; i < 600; ++i) {
      const size_t width = random.Int(1, 70);
      // From rare to frequent changes; single bits and all of them.
      const int changes = random.Int(1, 30);
      std::vector<uint32_t> bits(3 * width);
      for (uint32_t& word : bits) {
        word = random.Int(0, changes) == 0 ? random.Bits() : 0u;
      }
      const uint32_t mask = i % 2 == 0 ? uint32_t{1} << random.Int(0, 31) : random.Bits();
      std::vector<int32_t> columns(width, -1);
      const size_t count = ScanBoundary(bits.data() + width, width, width, mask, columns.data());
      ASSERT_LE(count, width);
      columns.resize(count);
      EXPECT_EQ(columns, ScanBoundaryPlainly(bits, 1, width, mask)) << "width " << width;
    }
  });
}

TEST(ScanBoundary, FindsEveryColumnOfACheckerboard) {
  ForEachTarget([](const char*) {
    constexpr size_t kWidth = 65;
    std::vector<uint32_t> bits(3 * kWidth);
    for (size_t i = 0; i < bits.size(); ++i) bits[i] = i % 2 == 0 ? 0u : 1u << 31;
    std::vector<int32_t> columns(kWidth);
    EXPECT_EQ(ScanBoundary(bits.data() + kWidth, kWidth, kWidth, 1u << 31, columns.data()),
              kWidth - 2);
    EXPECT_EQ(ScanBoundary(bits.data() + kWidth, kWidth, kWidth, 1u, columns.data()), 0u);
  });
}

TEST(ScanBoundary, FindsNothingInImagesWithoutInnerColumns) {
  const std::vector<uint32_t> bits = {0, 1, 1, 0, 0, 1};
  int32_t columns[2];
  EXPECT_EQ(ScanBoundary(bits.data() + 1, 1, 1, ~0u, columns), 0u);
  EXPECT_EQ(ScanBoundary(bits.data() + 2, 2, 2, ~0u, columns), 0u);
}

}  // namespace
}  // namespace lightfit::internal
