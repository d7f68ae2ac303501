#include "server/upload_watch.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

namespace lightfit {
namespace {

TEST(UploadWatch, CallsThoseThatAreLateOnce) {
  UploadWatch watch(absl::Milliseconds(20));
  std::atomic<int> num_late = 0;
  int a, b;
  watch.Begin(&a, [&] { ++num_late; });
  watch.Begin(&b, [&] { ++num_late; });
  while (num_late < 2) std::this_thread::yield();
  watch.End(&a);
  watch.End(&b);
  EXPECT_EQ(num_late, 2);
}

TEST(UploadWatch, LeavesThoseThatEndedAlone) {
  std::atomic<bool> is_told = false;
  int a, never_begun;
  UploadWatch watch(absl::Seconds(1000));
  watch.Begin(&a, [&] { is_told = true; });
  watch.End(&a);
  watch.End(&never_begun);
  EXPECT_FALSE(is_told);
}

// After End() the call may be deleted, whatever the watch is doing at that moment.
TEST(UploadWatch, NobodyIsCalledAfterTheEnd) {
  UploadWatch watch(absl::Microseconds(50));
  std::vector<std::thread> uploaders;
  for (int i = 0; i < 4; ++i) {
    uploaders.emplace_back([&watch] {
      for (int round = 0; round < 500; ++round) {
        auto alive = std::make_unique<std::atomic<int>>(0);
        watch.Begin(alive.get(), [counter = alive.get()] { ++*counter; });
        if (round % 2 == 0) std::this_thread::sleep_for(std::chrono::microseconds(round % 100));
        watch.End(alive.get());
        EXPECT_LE(*alive, 1);
      }
    });
  }
  for (std::thread& uploader : uploaders) uploader.join();
}

}  // namespace
}  // namespace lightfit
