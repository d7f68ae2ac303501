#include "server/memory_budget.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <thread>
#include <vector>

namespace lightfit {
namespace {

TEST(MemoryBudget, RefusesWhatDoesNotFitAndTakesItBack) {
  MemoryBudget budget(100);
  {
    const auto a = budget.TryReserve(60);
    ASSERT_TRUE(a.has_value());
    EXPECT_EQ(a->bytes(), 60);
    EXPECT_FALSE(budget.TryReserve(41).has_value());
    const auto b = budget.TryReserve(40);
    ASSERT_TRUE(b.has_value());
    EXPECT_EQ(budget.used_bytes(), 100);
    EXPECT_TRUE(budget.TryReserve(0).has_value());
    EXPECT_FALSE(budget.TryReserve(1).has_value());
  }
  EXPECT_EQ(budget.used_bytes(), 0);
  EXPECT_EQ(budget.limit_bytes(), 100);
}

TEST(MemoryBudget, AbsurdSizesAreRefused) {
  MemoryBudget budget(100);
  const auto held = budget.TryReserve(1);
  EXPECT_FALSE(budget.TryReserve(std::numeric_limits<int64_t>::max()).has_value());
  EXPECT_FALSE(budget.TryReserve(-1).has_value());
  EXPECT_FALSE(budget.TryReserve(std::numeric_limits<int64_t>::min()).has_value());
  EXPECT_EQ(budget.used_bytes(), 1);
  EXPECT_FALSE(MemoryBudget(-5).TryReserve(1).has_value());
}

TEST(MemoryBudget, AMovedReservationGivesBackOnce) {
  MemoryBudget budget(100);
  auto a = budget.TryReserve(30), b = budget.TryReserve(20);
  ASSERT_TRUE(a.has_value() && b.has_value());
  *a = *std::move(b);  // gives back the 30
  EXPECT_EQ(budget.used_bytes(), 20);
  EXPECT_EQ(b->bytes(), 0);  // NOLINT(bugprone-use-after-move): what is left is what is tested
  b.reset();
  EXPECT_EQ(budget.used_bytes(), 20);
  MemoryBudget::Reservation c = *std::move(a);
  a.reset();  // NOLINT(bugprone-use-after-move)
  EXPECT_EQ(budget.used_bytes(), 20);
  c.Release();
  c.Release();
  EXPECT_EQ(budget.used_bytes(), 0);
}

// Eight threads reserve and give back at random: never more than the limit, nothing lost.
TEST(MemoryBudget, HoldsWithManyThreads) {
  constexpr int64_t kLimitBytes = 1000;
  constexpr int kNumThreads = 8, kNumRounds = 20000;
  MemoryBudget budget(kLimitBytes);
  std::atomic<int64_t> held_bytes = 0, num_granted = 0, num_refused = 0;
  {
    std::vector<std::jthread> threads;
    for (int seed = 0; seed < kNumThreads; ++seed) {
      threads.emplace_back([&, seed] {
        std::mt19937 random(seed);
        for (int i = 0; i < kNumRounds; ++i) {
          const int64_t bytes = 1 + random() % 400;
          const auto reservation = budget.TryReserve(bytes);
          if (!reservation.has_value()) {
            ++num_refused;
            continue;
          }
          ++num_granted;
          EXPECT_LE(held_bytes += bytes, kLimitBytes);
          held_bytes -= bytes;  // before the budget gets them back
        }
      });
    }
  }
  EXPECT_EQ(num_granted + num_refused, kNumThreads * kNumRounds);
  EXPECT_GT(num_granted, 0);
  EXPECT_EQ(budget.used_bytes(), 0);
}

}  // namespace
}  // namespace lightfit
