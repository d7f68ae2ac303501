#include "base/triple_buffer.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <thread>

namespace lightfit {
namespace {

TEST(TripleBuffer, HasNothingToTakeAtFirst) {
  TripleBuffer<int> buffer;
  EXPECT_FALSE(buffer.Take());
}

TEST(TripleBuffer, NewestIsTakenOnce) {
  TripleBuffer<int> buffer;
  buffer.back() = 1;
  EXPECT_FALSE(buffer.Publish());
  buffer.back() = 2;
  EXPECT_TRUE(buffer.Publish());  // in the place of 1
  ASSERT_TRUE(buffer.Take());
  EXPECT_EQ(buffer.front(), 2);
  EXPECT_FALSE(buffer.Take());
  EXPECT_EQ(buffer.front(), 2);
  buffer.back() = 3;
  EXPECT_FALSE(buffer.Publish());
  EXPECT_EQ(buffer.front(), 2) << "until it is taken";
  ASSERT_TRUE(buffer.Take());
  EXPECT_EQ(buffer.front(), 3);
}

// Whatever the order of the two, front and back are different buffers.
TEST(TripleBuffer, WriterAndReaderNeverShareABuffer) {
  for (int order = 0; order < 1 << 12; ++order) {
    TripleBuffer<int> buffer;
    for (int step = 0; step < 12; ++step) {
      if ((order >> step & 1) != 0) {
        buffer.Publish();
      } else {
        buffer.Take();
      }
      ASSERT_NE(&buffer.back(), &buffer.front()) << "order " << order << ", step " << step;
    }
  }
}

// A block is written whole and read whole, and what is read only ever gets newer.
TEST(TripleBuffer, ReaderSeesWholeBlocksInOrder) {
  constexpr int64_t kLast = 20'000;
  TripleBuffer<std::array<int64_t, 64>> buffer;
  int64_t num_replaced = 0;
  std::jthread writer([&] {
    for (int64_t i = 1; i <= kLast; ++i) {
      buffer.back().fill(i);
      if (buffer.Publish()) ++num_replaced;
    }
  });
  int64_t num_taken = 0, newest = 0;
  while (newest < kLast) {
    if (!buffer.Take()) {
      std::this_thread::yield();
      continue;
    }
    ++num_taken;
    ASSERT_GT(buffer.front()[0], newest);
    newest = buffer.front()[0];
    for (const int64_t value : buffer.front()) ASSERT_EQ(value, newest);
  }
  writer.join();
  EXPECT_EQ(num_taken + num_replaced, kLast);
}

}  // namespace
}  // namespace lightfit
