#include "server/work_pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <thread>
#include <vector>

namespace lightfit {
namespace {

TEST(WorkPool, RunsEverythingOnce) {
  constexpr int kNumWriters = 4, kNumPieces = 2000;
  std::vector<std::atomic<int>> runs(kNumWriters * kNumPieces);
  {
    WorkPool pool(3, kNumWriters * kNumPieces);
    std::vector<std::thread> writers;
    for (int w = 0; w < kNumWriters; ++w) {
      writers.emplace_back([&, w] {
        for (int i = 0; i < kNumPieces; ++i) {
          EXPECT_TRUE(pool.TrySubmit([&runs, at = w * kNumPieces + i] { ++runs[at]; }));
        }
      });
    }
    for (std::thread& writer : writers) writer.join();
  }  // runs what waits
  for (const std::atomic<int>& count : runs) EXPECT_EQ(count, 1);
}

TEST(WorkPool, RefusesWhatDoesNotFitTheQueue) {
  std::promise<void> go_on;
  std::shared_future<void> gate = go_on.get_future().share();
  std::atomic<int> num_done = 0;
  {
    WorkPool pool(2, 3);
    const auto wait = [&] {
      gate.wait();
      ++num_done;
    };
    for (int i = 0; i < 5; ++i) EXPECT_TRUE(pool.TrySubmit(wait)) << i;  // 2 at work, 3 wait
    EXPECT_FALSE(pool.TrySubmit(wait));
    while (pool.num_running() < 2) std::this_thread::yield();
    EXPECT_EQ(pool.num_waiting(), 3);
    EXPECT_FALSE(pool.TrySubmit(wait));
    pool.Submit(wait);  // takes its turn all the same
    EXPECT_EQ(pool.num_waiting(), 4);
    go_on.set_value();
  }
  EXPECT_EQ(num_done, 6);
}

TEST(WorkPool, WithoutAQueueTakesWhatThreadsAreFreeFor) {
  std::promise<void> go_on;
  std::shared_future<void> gate = go_on.get_future().share();
  WorkPool pool(1, 0);
  EXPECT_TRUE(pool.TrySubmit([gate] { gate.wait(); }));
  EXPECT_FALSE(pool.TrySubmit([] {}));
  go_on.set_value();
}

TEST(WorkPool, KeepsTheOrder) {
  std::vector<int> order;
  {
    WorkPool pool(1, 100);
    for (int i = 0; i < 100; ++i) pool.Submit([&order, i] { order.push_back(i); });
  }
  ASSERT_EQ(order.size(), 100u);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(order[i], i);
}

}  // namespace
}  // namespace lightfit
