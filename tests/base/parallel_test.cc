#include "base/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace lightfit {
namespace {

TEST(ParallelFor, VisitsEveryIndexOnceWhateverTheThreads) {
  for (const int num_threads : {-1, 0, 1, 2, 5, 64}) {
    for (const int count : {0, 1, 7, 64, 1000}) {
      std::vector<int> visits(count, 0);
      ParallelFor(count, 7, num_threads, [&visits](int begin, int end) {
        EXPECT_LT(begin, end);
        EXPECT_LE(end - begin, 7);
        for (int i = begin; i < end; ++i) ++visits[i];
      });
      EXPECT_EQ(std::count(visits.begin(), visits.end(), 1), count) << num_threads << " threads";
    }
  }
}

TEST(ParallelFor, HasReturnedOnlyWhenAllIsDone) {
  std::vector<int> values(10000, 0);
  ParallelFor(10000, 13, 4, [&values](int begin, int end) {
    for (int i = begin; i < end; ++i) values[i] = i;
  });
  EXPECT_EQ(std::accumulate(values.begin(), values.end(), int64_t{0}), int64_t{9999} * 5000);
}

TEST(NumProcessors, IsAtLeastOne) { EXPECT_GE(NumProcessors(), 1); }

}  // namespace
}  // namespace lightfit
