#include "partition/shipped/cascade_parts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "methods/view_body.h"
#include "tests/testing/plane_readback.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::Random;

constexpr double kRounding = 1e-12;  // a few operations, of depths that are a few thousand at most

TEST(CascadeSplits, HaveOneRatioOrOneLengthAtTheEnds) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const double near = random.LogUniform(0.01, 10.0), far = near * random.LogUniform(1.1, 1e4);
    const int num_parts = random.Int(1, 12);
    const std::vector<double> logarithmic = CascadeSplits(near, far, num_parts, 1.0);
    const std::vector<double> uniform = CascadeSplits(near, far, num_parts, 0.0);
    const std::vector<double> half = CascadeSplits(near, far, num_parts, 0.5);
    ASSERT_EQ(static_cast<int>(half.size()), num_parts + 1);
    EXPECT_EQ(half.front(), near);
    EXPECT_EQ(half.back(), far);
    for (int k = 0; k < num_parts; ++k) {
      EXPECT_NEAR(std::pow(logarithmic[k + 1] / logarithmic[k], num_parts) / (far / near),
                  1.0,
                  100.0 * kRounding);
      EXPECT_NEAR((uniform[k + 1] - uniform[k]) * num_parts / (far - near), 1.0, 1e3 * kRounding);
      EXPECT_NEAR(half[k], 0.5 * (logarithmic[k] + uniform[k]), far * kRounding);
      EXPECT_GT(half[k + 1], half[k]);
    }
  }
}

// An orthographic view may begin behind its own plane, where there are no logarithms.
TEST(CascadeSplits, AreUniformFromAnyDepthOn) {
  EXPECT_EQ(CascadeSplits(-3.0, 5.0, 4, 0.0), (std::vector<double>{-3.0, -1.0, 1.0, 3.0, 5.0}));
  EXPECT_EQ(CascadeSplits(2.0, 2.0, 2, 1.0), (std::vector<double>{2.0, 2.0, 2.0}));
}

TEST(BetweenDepths, HoldsThePointsOfTheseDepths) {
  constexpr double kEverywhere = std::numeric_limits<double>::infinity();
  Random random(2);
  const Camera camera = testing::CameraAround(random, 5.0, false);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d point = random.InCube(10.0);
    const double depth = CameraDepth(camera, point);
    const double from = i % 3 == 0 ? -kEverywhere : 10.0, to = i % 3 == 1 ? kEverywhere : 15.0;
    bool is_inside = true;
    for (const Eigen::RowVector4d& half_space : BetweenDepths(camera, from, to)) {
      is_inside &= half_space * point.homogeneous() >= 0.0;
    }
    EXPECT_EQ(is_inside, depth >= from && depth <= to);
  }
}

}  // namespace
}  // namespace lightfit
