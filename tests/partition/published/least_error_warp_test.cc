#include "partition/published/least_error_warp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::Random;

double Error(const std::vector<WarpCorner>& corners, double length, double one_over_n) {
  double largest = 0.0;
  for (const WarpCorner& corner : corners) {
    const double w = 1.0 + corner.b * one_over_n;
    largest = std::max(largest, w * w / (1.0 + length * one_over_n) / corner.pixel_width);
  }
  return largest;
}

TEST(LeastErrorWarp, HasLessErrorThanOthers) {
  Random random(1);
  int num_warped = 0;
  for (int i = 0; i < 500; ++i) {
    const double length = random.LogUniform(1e-3, 1e3);
    std::vector<WarpCorner> corners = {{0.0, random.LogUniform(0.01, 10.0)},
                                       {length, random.LogUniform(0.01, 10.0)}};
    for (int k = random.Int(0, 10); k > 0; --k) {
      corners.push_back({random.Uniform(0.0, length), random.LogUniform(0.01, 10.0)});
    }
    const double best = LeastErrorWarp(corners);
    ASSERT_TRUE(std::isfinite(best));
    ASSERT_GE(best, 0.0);
    num_warped += best * length > 1e-3 ? 1 : 0;
    const double least = Error(corners, length, best);
    EXPECT_LE(least, Error(corners, length, 0.0) * (1.0 + 1e-12));
    for (int k = 0; k < 200; ++k) {
      const double other = random.LogUniform(1e-4, 1e4) / length;
      EXPECT_LE(least, Error(corners, length, other) * (1.0 + 1e-12)) << i;
    }
  }
  EXPECT_GT(num_warped, 100);
}

TEST(LeastErrorWarp, IsThatOfLightSpacePerspectiveMapsOnATrapezoid) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const double length = random.LogUniform(1e-3, 1e3), near = random.LogUniform(1e-3, 1e3);
    const double far = near * random.LogUniform(1.01, 1e4);
    const std::vector<WarpCorner> corners = {
        {0.0, near}, {0.0, near}, {length, far}, {length, far}};
    const double expected = (std::sqrt(far / near) - 1.0) / length;
    // The two ends' errors cross there, so that it is found to all digits.
    EXPECT_NEAR(LeastErrorWarp(corners) / expected, 1.0, 1e-9);
  }
}

TEST(LeastErrorWarp, IsNoneWherePixelsShrink) {
  EXPECT_LE(LeastErrorWarp({{0.0, 2.0}, {1.0, 1.0}}), 1e-12);
  EXPECT_LE(LeastErrorWarp({{0.0, 1.0}, {1.0, 1.0}}), 1e-12);
  EXPECT_EQ(LeastErrorWarp({{0.0, 1.0}, {0.0, 2.0}}), 0.0);
  EXPECT_EQ(LeastErrorWarp({}), 0.0);
  EXPECT_LE(LeastErrorWarp({{0.0, 2.0}, {0.5, 1.0}, {1.0, 2.0}}), 1e-6);
}

}  // namespace
}  // namespace lightfit
