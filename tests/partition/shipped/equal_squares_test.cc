#include "partition/shipped/equal_squares.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::Random;
using testing::StatusIs;

TEST(EqualSquares, AreTheLargestThatTheBudgetAllows) {
  Random random(1);
  const Light light = Light::Directional("sun", {0.0, 0.0, -1.0});
  for (int i = 0; i < 2000; ++i) {
    const int num_maps = random.Int(1, 32);
    const auto max_texels = static_cast<int64_t>(random.LogUniform(32.0, 1e10));
    const auto size = EqualSquares(light, max_texels, num_maps);
    ASSERT_THAT(size, IsOk());
    EXPECT_EQ(size->width, size->height);
    const int64_t side = size->width;
    EXPECT_LE(num_maps * side * side, max_texels);
    if (side < kMaxMapSide) {
      EXPECT_GT(num_maps * (side + 1) * (side + 1), max_texels);
    }
  }
}

TEST(EqualSquares, HitWholeRootsAndTheLargestMap) {
  const Light light = Light::Directional("sun", {0.0, 0.0, -1.0});
  EXPECT_EQ(EqualSquares(light, 4 * 1024 * 1024, 4)->width, 1024);
  EXPECT_EQ(EqualSquares(light, 4 * 1024 * 1024 - 1, 4)->width, 1023);
  EXPECT_EQ(EqualSquares(light, INT64_MAX, 1)->width, kMaxMapSide);
}

TEST(EqualSquares, SayWhatABudgetTooSmallWants) {
  const Light light = Light::Directional("sun", {0.0, 0.0, -1.0});
  EXPECT_THAT(EqualSquares(light, 3, 4),
              StatusIs(absl::StatusCode::kInvalidArgument,
                       HasSubstr("light \"sun\": max_texels = 3, want at least 4")));
  EXPECT_THAT(EqualSquares(light, -5, 1),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("-5")));
  EXPECT_THAT(EqualSquares(light, 15, 4, 2),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("4 squares of 2x2")));
}

}  // namespace
}  // namespace lightfit
