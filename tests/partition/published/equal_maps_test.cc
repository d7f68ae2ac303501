#include "partition/published/equal_maps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::MatrixNear;
using testing::Random;
using testing::StatusIs;

TEST(EqualSquares, AreTheLargestThatTheBudgetAllows) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const MapSize budget = {random.Int(10, 5000), random.Int(10, 5000)};
    const int num_maps = random.Int(1, 32);
    const int64_t texels = int64_t{budget.width} * budget.height;
    const auto size = EqualSquares(budget, num_maps, 0.0);
    ASSERT_THAT(size, IsOk());
    const int64_t side = size->width;
    EXPECT_EQ(size->height, side);
    EXPECT_LE(num_maps * side * side, texels);
    EXPECT_GT(num_maps * (side + 1) * (side + 1), texels);
  }
}

TEST(EqualSquares, SaysWhenTheBudgetIsTooSmall) {
  EXPECT_THAT(EqualSquares({2, 3}, 7, 0.0),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("map = 2x3: 7 equal maps")));
  EXPECT_THAT(EqualSquares({20, 20}, 4, 5.0),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("margin of 5")));
  EXPECT_THAT(EqualSquares({20, 20}, 4, 4.9), IsOk());
}

TEST(EqualSquares, HaveNoMoreThanTheLargestSide) {
  const auto size = EqualSquares({kMaxMapSide, kMaxMapSide}, 1, 0.0);
  ASSERT_THAT(size, IsOk());
  EXPECT_EQ(size->width, kMaxMapSide);
}

TEST(WithMargin, ShowsTheSameWithinTheMargin) {
  constexpr double kRounding = 2e-6;  // of the side: what WithMargin() adds, and rounding
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    const MapSize size = {random.Int(20, 500), random.Int(20, 500)};
    const double margin = random.Uniform(0.0, 5.0);
    Eigen::Matrix4d map_from_world = Eigen::Matrix4d::Random();
    const Eigen::Matrix4d moved = WithMargin(map_from_world, size, margin);
    EXPECT_EQ(moved.row(2), map_from_world.row(2));
    EXPECT_EQ(moved.row(3), map_from_world.row(3));
    const Eigen::Matrix4d world_from_map = map_from_world.inverse();
    for (const double share : {0.0, 0.25, 1.0}) {
      const Eigen::Vector4d world =
          world_from_map * Eigen::Vector4d(share * size.width, share * size.height, 0.3, 1.0);
      const Eigen::Vector2d expected(margin + share * (size.width - 2.0 * margin),
                                     margin + share * (size.height - 2.0 * margin));
      EXPECT_THAT((moved * world).hnormalized().head<2>(), MatrixNear(expected, 500.0 * kRounding));
    }
  }
}

}  // namespace
}  // namespace lightfit
