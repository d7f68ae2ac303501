#include "calls/grow.h"

#include <gtest/gtest.h>

#include <vector>

namespace lightfit {
namespace {

TEST(GrowTo, TakesMemoryForWhatCameAndAsMuchAgain) {
  constexpr size_t kMost = size_t{1} << 40;  // what a header may say
  std::vector<float> values;
  for (size_t size = 1; size < 100000; size += 1 + size / 3) {
    GrowTo(size, kMost, &values);
    EXPECT_EQ(values.size(), size);
    EXPECT_LE(values.capacity(), 2 * size);
    values.back() = 1.0F;
  }
  GrowTo(5, kMost, &values);
  EXPECT_GT(values.size(), 5);
}

TEST(GrowTo, TakesNoMoreThanThereWillBe) {
  std::vector<int> values;
  GrowTo(70, 100, &values);
  GrowTo(80, 100, &values);
  EXPECT_EQ(values.capacity(), 100);
  GrowTo(100, 100, &values);
  EXPECT_EQ(values.size(), 100);
  EXPECT_EQ(values[99], 0);
}

}  // namespace
}  // namespace lightfit
