#include "optimizer/sizing/map_sizes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::Random;
using testing::StatusIs;

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

TEST(AllowedSides, AreAllMultiplesWhileTheyAreFew) {
  MapSizeRules rules;
  rules.multiple = 100;
  rules.min_side = 150;
  rules.max_side = 599;
  EXPECT_THAT(AllowedSides(rules), ElementsAre(200, 300, 400, 500));
  rules.powers_of_two = true;
  EXPECT_THAT(AllowedSides(rules), ElementsAre(256, 512));
}

TEST(AllowedSides, KeepTheRulesAndLieCloseTogether) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    MapSizeRules rules;
    rules.multiple = random.Int(1, 256);
    rules.min_side = random.Int(1, 2000);
    rules.max_side = rules.min_side + random.Int(256, 60000);
    ASSERT_THAT(ValidateMapSizeRules(rules), IsOk());
    const std::vector<int> sides = AllowedSides(rules);
    EXPECT_LT(sides.front() - rules.min_side, rules.multiple);
    EXPECT_LT(rules.max_side - sides.back(), rules.multiple);
    for (size_t s = 0; s < sides.size(); ++s) {
      EXPECT_EQ(sides[s] % rules.multiple, 0);
      EXPECT_LE(sides[s], rules.max_side);
      if (s == 0) continue;
      EXPECT_GT(sides[s], sides[s - 1]);
      EXPECT_LE(sides[s] - sides[s - 1], std::max(rules.multiple, sides[s - 1] / 64));
    }
  }
}

TEST(MapSizeRules, SayWhatIsWrong) {
  MapSizeRules rules;
  rules.multiple = 0;
  EXPECT_THAT(ValidateMapSizeRules(rules), StatusIs(kInvalid, HasSubstr("rules.multiple = 0")));
  rules = MapSizeRules();
  rules.min_side = 4096;
  rules.max_side = 1024;
  EXPECT_THAT(ValidateMapSizeRules(rules), StatusIs(kInvalid, HasSubstr("4096, 1024 texels")));
  rules.min_side = 1000;
  rules.max_side = 1010;
  EXPECT_THAT(ValidateMapSizeRules(rules),
              StatusIs(kInvalid, HasSubstr("no multiple of 64 lies in")));
  rules.powers_of_two = true;
  EXPECT_THAT(ValidateMapSizeRules(rules), StatusIs(kInvalid, HasSubstr("no power of two lies")));
  rules.max_side = 1 << 20;
  EXPECT_THAT(ValidateMapSizeRules(rules), StatusIs(kInvalid, HasSubstr("<= 65536")));
}

// The twin: a size is worthwhile if no other of as few texels costs as little.
TEST(WorthwhileSizes, AreThoseThatNoOtherBeats) {
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    std::vector<RatedSize> sizes;
    for (int n = random.Int(1, 60); n > 0; --n) {
      const MapSize map = {random.Int(1, 12), random.Int(1, 12)};
      sizes.push_back({map, TexelsOf(map), 0.1 * random.Int(1, 30)});
    }
    std::set<std::pair<int64_t, double>> expected;
    for (const RatedSize& size : sizes) {
      const bool beaten = std::any_of(sizes.begin(), sizes.end(), [&size](const RatedSize& other) {
        return other.texels <= size.texels && other.cost <= size.cost &&
               (other.texels < size.texels || other.cost < size.cost);
      });
      if (!beaten) expected.emplace(size.texels, size.cost);
    }
    const std::vector<RatedSize> found = WorthwhileSizes(sizes);
    ASSERT_EQ(found.size(), expected.size());
    auto want = expected.begin();
    for (const RatedSize& size : found) {
      EXPECT_EQ(size.texels, want->first);
      EXPECT_EQ(size.cost, want->second);
      ++want;
    }
  }
}

}  // namespace
}  // namespace lightfit
