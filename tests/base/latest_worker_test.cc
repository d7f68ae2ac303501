#include "base/latest_worker.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <thread>

namespace lightfit {
namespace {

using Worker = LatestWorker<int64_t, int64_t>;

std::unique_ptr<Worker> StartSquaring() {
  return std::move(Worker::Start([](const int64_t& job, int64_t* answer) { *answer = job * job; },
                                 "run the test alone"))
      .value();
}

void WaitUntilIdle(const Worker& worker) {
  while (true) {
    const Worker::Counts counts = worker.counts();
    if (counts.done + counts.skipped == counts.submitted) return;
    std::this_thread::yield();
  }
}

TEST(LatestWorker, AnswersAreThoseOfTheJobsAndOnlyGetNewer) {
  const std::unique_ptr<Worker> worker = StartSquaring();
  constexpr int64_t kLast = 20'000;
  int64_t newest = 0;
  const auto poll = [&] {
    const int64_t* answer = worker->Poll();
    if (answer == nullptr) return;
    EXPECT_GT(*answer, newest * newest);
    while (newest * newest < *answer) ++newest;
    EXPECT_EQ(*answer, newest * newest);
  };
  for (int64_t job = 1; job <= kLast; ++job) {
    worker->Lend() = job;
    worker->Submit();
    poll();
  }
  WaitUntilIdle(*worker);
  while (newest < kLast) poll();
  EXPECT_EQ(worker->Poll(), nullptr);
  EXPECT_EQ(worker->counts().submitted, kLast);
}

TEST(LatestWorker, WakesUpAfterALongSleep) {
  const std::unique_ptr<Worker> worker = StartSquaring();
  std::this_thread::sleep_for(std::chrono::milliseconds(150));  // beyond its naps
  worker->Lend() = 7;
  worker->Submit();
  const int64_t* answer = nullptr;
  while ((answer = worker->Poll()) == nullptr) std::this_thread::yield();
  EXPECT_EQ(*answer, 49);
}

TEST(LatestWorker, ItsEndStopsTheJobInWork) {
  std::atomic<bool> has_begun = false, was_stopped = false;
  auto worker = std::move(Worker::Start(
                              [&](const int64_t& /*job*/, int64_t* /*answer*/) {
                                has_begun = true;
                                while (!StopRequested()) std::this_thread::yield();
                                was_stopped = true;
                              },
                              "run the test alone"))
                    .value();
  worker->Submit();
  while (!has_begun) std::this_thread::yield();
  worker.reset();
  EXPECT_TRUE(was_stopped);
}

}  // namespace
}  // namespace lightfit
