#include "server/call_gate.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace lightfit {
namespace {

using Entry = CallGate::Entry;

TEST(CallGate, LetsInAsManyAsItMay) {
  CallGate gate(2);
  int a, b, c;
  EXPECT_EQ(gate.TryEnter(&a, nullptr), Entry::kIn);
  EXPECT_EQ(gate.TryEnter(&b, nullptr), Entry::kIn);
  EXPECT_EQ(gate.TryEnter(&c, nullptr), Entry::kFull);
  gate.Leave(&a);
  EXPECT_EQ(gate.TryEnter(&c, nullptr), Entry::kIn);
  EXPECT_EQ(gate.num_inside(), 2);
}

TEST(CallGate, TellsThoseInsideThatItCloses) {
  CallGate gate(10);
  int a, b, c, told_a = 0, told_b = 0;
  gate.TryEnter(&a, [&] { ++told_a; });
  gate.TryEnter(&b, [&] { ++told_b; });
  gate.Leave(&b);
  gate.Close();
  gate.Close();
  EXPECT_EQ(told_a, 1);
  EXPECT_EQ(told_b, 0);
  EXPECT_EQ(gate.TryEnter(&c, nullptr), Entry::kClosed);
  EXPECT_FALSE(gate.WaitUntilEmpty(absl::Milliseconds(1)));
  gate.Leave(&a);
  EXPECT_TRUE(gate.WaitUntilEmpty(absl::InfiniteDuration()));
}

// Calls that come and go while it closes: none is inside when the wait is over, none comes after.
TEST(CallGate, NobodyIsInsideWhenItHasEmptied) {
  for (int round = 0; round < 20; ++round) {
    CallGate gate(1000);
    std::atomic<int> num_inside = 0;
    std::atomic<bool> has_emptied = false;
    std::vector<std::thread> callers;
    for (int i = 0; i < 4; ++i) {
      callers.emplace_back([&] {
        int owner;
        while (gate.TryEnter(&owner, nullptr) == Entry::kIn) {
          EXPECT_FALSE(has_emptied);
          ++num_inside;
          std::this_thread::yield();
          --num_inside;
          gate.Leave(&owner);
        }
      });
    }
    std::this_thread::yield();
    gate.Close();
    EXPECT_TRUE(gate.WaitUntilEmpty(absl::InfiniteDuration()));
    EXPECT_EQ(num_inside, 0);
    has_emptied = true;
    for (std::thread& caller : callers) caller.join();
  }
}

}  // namespace
}  // namespace lightfit
