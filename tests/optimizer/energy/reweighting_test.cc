#include "optimizer/energy/reweighting.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

namespace lightfit {
namespace {

TEST(BestOfRounds, KeepsTheLeastAndSaysWhetherItGained) {
  BestOfRounds<std::string> best(/*least_gain=*/0.1);
  EXPECT_TRUE(best.Offer(10.0, "first"));
  EXPECT_FALSE(best.Offer(12.0, "worse"));
  EXPECT_EQ(best.Best(), "first");
  EXPECT_FALSE(best.Offer(9.5, "a little better"));  // kept, though not worth another round
  EXPECT_EQ(best.Best(), "a little better");
  EXPECT_TRUE(best.Offer(8.0, "better"));
  EXPECT_FALSE(best.Offer(8.0, "as good"));
  EXPECT_EQ(std::move(best).Best(), "better");
}

TEST(BestOfRounds, AnyLessIsAGainUnlessToldOtherwise) {
  BestOfRounds<int> best;
  EXPECT_TRUE(best.Offer(1.0, 1));
  EXPECT_TRUE(best.Offer(1.0 - 1e-15, 2));
  EXPECT_FALSE(best.Offer(1.0, 3));
  EXPECT_EQ(best.Best(), 2);
}

}  // namespace
}  // namespace lightfit
