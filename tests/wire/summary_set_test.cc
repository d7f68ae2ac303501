// Sets of summaries: sums do not depend on order and grouping, and only like things add.
#include "wire/summary_set.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <iostream>
#include <random>

#include "absl/strings/str_cat.h"
#include "optimizer/fit.h"
#include "optimizer/light_matrix.h"
#include "tests/io/summary_examples.h"

namespace lightfit {
namespace {

using testing::BytesOf;
using testing::FitsOrSaysWhy;
using testing::FrameOfYard;
using testing::FramesOfYard;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::SetOf;
using testing::StatusIs;
using testing::Yard;

// Half of the sets go through a file on the way, as on a farm.
TEST(SummarySet, SameBytesInAnyOrderAndGrouping) {
  const std::vector<SummarySet> frames = FramesOfYard(9);
  std::string expected;
  for (uint32_t seed = testing::kSeed; seed < testing::kSeed + 8; ++seed) {
    std::cout << "seed " << seed << "\n";
    std::mt19937 random(seed);
    std::vector<SummarySet> sets = frames;
    while (sets.size() > 1) {
      std::shuffle(sets.begin(), sets.end(), random);
      SummarySet last = sets.back();
      sets.pop_back();
      if (random() % 2 == 0) last = *ParseSummarySet(BytesOf(last));
      ASSERT_THAT(AddToSet(last, &sets[random() % sets.size()]), IsOk());
    }
    const std::string bytes = BytesOf(sets.front());
    if (expected.empty()) expected = bytes;
    EXPECT_TRUE(bytes == expected);
  }
}

// The way over files is the library's own sum.
TEST(SummarySet, SumIsThatOfMergeSummaries) {
  SummarySet sum = SetOf(FrameOfYard(0), "0.exr");
  for (int i = 1; i < 4; ++i) {
    ASSERT_THAT(AddToSet(*ParseSummarySet(BytesOf(SetOf(FrameOfYard(i), "i.exr"))), &sum), IsOk());
  }
  for (const LightSummary& light : sum.lights) {
    const auto same = [&light](const Light& other) { return other.name == light.name(); };
    const Light& original = *std::find_if(Yard().lights.begin(), Yard().lights.end(), same);
    std::vector<Summary> summaries;
    for (int i = 0; i < 4; ++i) summaries.push_back(*Summarize(FrameOfYard(i).View(), original));
    const absl::StatusOr<Summary> merged = MergeSummaries(summaries, original);
    const absl::StatusOr<Summary> added = SummaryOfTotal(light.total);
    ASSERT_THAT(merged, IsOk());
    ASSERT_THAT(added, IsOk());
    EXPECT_EQ(merged->tensor.entries(), added->tensor.entries());
    EXPECT_EQ(merged->footprint_sum, added->footprint_sum);
    EXPECT_EQ(merged->cover.hull, added->cover.hull);
    EXPECT_EQ(light.num_frames(), 4);
  }
}

TEST(SummarySet, FramesWithoutALightAreCountedAndTheFirstMessageKept) {
  const std::vector<std::string> names = {"0007.exr", "0003.exr", "0005.exr"};
  std::string expected;
  for (const std::vector<int>& order : {std::vector<int>{0, 1, 2, 3}, {3, 2, 1, 0}, {1, 3, 0, 2}}) {
    std::optional<SummarySet> sum;
    for (const int i : order) {
      SummarySet set = SetOf(FrameOfYard(i), "whole.exr");
      if (i < 3) {
        const Light light = set.lights[1].total.light;
        const absl::Status status =
            absl::NotFoundError(absl::StrCat("light \"", light.name, "\": no channel"));
        set.lights[1] = SummaryOfFrame(light, status, names[i], set.options);
      }
      set = *ParseSummarySet(BytesOf(set));
      if (!sum.has_value()) {
        sum = set;
      } else {
        ASSERT_THAT(AddToSet(set, &*sum), IsOk());
      }
    }
    EXPECT_EQ(sum->lights[1].total.num_frames, 1);
    EXPECT_EQ(sum->lights[1].num_frames_without, 3);
    EXPECT_EQ(sum->lights[1].failure, absl::NotFoundError("0003.exr: no channel"));
    EXPECT_EQ(sum->lights[0].total.num_frames, 4);
    if (expected.empty()) expected = BytesOf(*sum);
    EXPECT_TRUE(BytesOf(*sum) == expected);
  }
}

// A frame in which all is lit has no samples and no failure.
TEST(SummarySet, FramesWithoutShadowAddNothingButTheirCount) {
  ReadbackFile lit = Yard().file;
  std::fill(lit.shadow_bits.begin(), lit.shadow_bits.end(), 0);
  const SummarySet nothing = *ParseSummarySet(BytesOf(SetOf(lit, "lit.exr")));
  EXPECT_FALSE(FitsOrSaysWhy(nothing.lights[0], nothing.options));
  SummarySet sum = nothing;
  ASSERT_THAT(AddToSet(SetOf(Yard().file, "yard.exr"), &sum), IsOk());
  const SummarySet read = *ParseSummarySet(BytesOf(sum));
  for (const LightSummary& light : read.lights) {
    EXPECT_TRUE(FitsOrSaysWhy(light, read.options));
    EXPECT_EQ(light.total.num_frames, 2);
    EXPECT_EQ(light.num_frames_without, 0);
  }
}

TEST(SummarySet, LongMessagesAreCutAtOnce) {
  const absl::Status status = absl::InternalError(std::string(5000, 'x'));
  const LightSummary light = SummaryOfFrame(Yard().lights[0], status, "0.exr", {});
  EXPECT_EQ(light.failure.message().size(), kMaxFailureBytes);
  const absl::StatusOr<SummarySet> read = ParseSummarySet(BytesOf(MakeSummarySet({}, {light})));
  ASSERT_THAT(read, IsOk());
  EXPECT_EQ(read->lights[0].failure, light.failure);
}

TEST(SummarySet, OnlyLikeThingsAdd) {
  const SummarySet yard = SetOf(Yard().file, "yard.exr");
  const auto refused = [&yard](const std::function<void(SummarySet&)>& change,
                               const std::vector<std::string>& words) {
    SummarySet other = yard, sum = yard;
    change(other);
    const absl::Status status = AddToSet(other, &sum);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_TRUE(testing::HasAll(status.message(), words));
    EXPECT_TRUE(BytesOf(sum) == BytesOf(yard));
  };
  refused([](SummarySet& set) { set.lights[0].total.light.position.x() += 1e-9; },
          {"light", yard.lights[0].name(), "position"});
  refused([](SummarySet& set) { set.lights[2].total.light.direction.x() += 1e-9; },
          {yard.lights[2].name(), "direction"});
  refused([](SummarySet& set) { set.lights[1].total.light.name = "lantern"; },
          {"lantern", yard.lights[1].name(), "--only"});
  refused([](SummarySet& set) { set.lights.pop_back(); }, {"--only"});
  refused([](SummarySet& set) { set.options.metric = Metric::kL2; },
          {"options.metric", "METRIC_L2 here", "METRIC_L1_ACROSS_EDGE"});
  refused([](SummarySet& set) { set.options.cover = Cover::kReceivers; },
          {"options.cover", "COVER_RECEIVERS", "COVER_SHADOWED"});
  refused([](SummarySet& set) { set.options.border = BorderChoice::kDark; },
          {"options.border", "BORDER_CHOICE_DARK", "BORDER_CHOICE_LIT"});
  refused([](SummarySet& set) { set.options.samples.min_cos_eye = 0.25; },
          {"options.samples.min_cos_eye", "0.25", "0.01"});
  refused([](SummarySet& set) { set.options.along_edge_share = 0.5; }, {"along_edge_share"});
  refused([](SummarySet& set) { set.lights[1].weighed_in = Eigen::Matrix4d::Identity(); },
          {"in a given map here", "best map"});
}

TEST(SummarySet, WeighingsMustBeTheSameMap) {
  SummarySet sum = SetOf(Yard().file, "yard.exr");
  for (LightSummary& light : sum.lights) light.weighed_in = Eigen::Matrix4d::Identity();
  SummarySet other = *ParseSummarySet(BytesOf(sum));
  EXPECT_THAT(AddToSet(other, &sum), IsOk());
  other.lights[0].weighed_in->coeffRef(0, 3) = 7.0;
  EXPECT_THAT(AddToSet(other, &sum),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("in another")));
}

}  // namespace
}  // namespace lightfit
