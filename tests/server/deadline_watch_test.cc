#include "server/deadline_watch.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

namespace lightfit {
namespace {

TEST(DeadlineWatch, CallsThoseThatAreLateOnce) {
  DeadlineWatch watch;
  constexpr absl::Duration kLimit = absl::Milliseconds(20);
  std::atomic<int> num_late = 0;
  int a, b;
  watch.Begin(&a, kLimit, [&] { ++num_late; });
  watch.Begin(&b, kLimit, [&] { ++num_late; });
  while (num_late < 2) std::this_thread::yield();
  watch.End(&a);
  watch.End(&b);
  EXPECT_EQ(num_late, 2);
}

TEST(DeadlineWatch, LeavesThoseThatEndedAlone) {
  std::atomic<bool> is_told = false;
  int a, never_begun;
  DeadlineWatch watch;
  constexpr absl::Duration kLimit = absl::Seconds(1000);
  watch.Begin(&a, kLimit, [&] { is_told = true; });
  watch.End(&a);
  watch.End(&never_begun);
  EXPECT_FALSE(is_told);
}

TEST(DeadlineWatch, ANewWaitTakesThePlaceOfTheOld) {
  DeadlineWatch watch;
  std::atomic<bool> first_is_told = false, second_is_told = false;
  int a, b;
  watch.Begin(&b, absl::Seconds(1000), [] {});
  watch.Begin(&a, absl::Seconds(1000), [&] { first_is_told = true; });
  watch.Begin(&a, absl::Milliseconds(1), [&] { second_is_told = true; });
  while (!second_is_told) std::this_thread::yield();
  EXPECT_FALSE(first_is_told);
  watch.End(&b);
}

// After End() the call may be deleted, whatever the watch is doing at that moment.
TEST(DeadlineWatch, NobodyIsCalledAfterTheEnd) {
  DeadlineWatch watch;
  constexpr absl::Duration kLimit = absl::Microseconds(50);
  std::vector<std::thread> waiters;
  for (int i = 0; i < 4; ++i) {
    waiters.emplace_back([&watch, kLimit] {
      for (int round = 0; round < 500; ++round) {
        auto alive = std::make_unique<std::atomic<int>>(0);
        watch.Begin(alive.get(), kLimit, [counter = alive.get()] { ++*counter; });
        if (round % 2 == 0) std::this_thread::sleep_for(std::chrono::microseconds(round % 100));
        watch.End(alive.get());
        EXPECT_LE(*alive, 1);
      }
    });
  }
  for (std::thread& waiter : waiters) waiter.join();
}

}  // namespace
}  // namespace lightfit
