// Which frames a sum is of: the same for the same content, small, and in order.

#include "wire/frame_identity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/io/summary_examples.h"

namespace lightfit {
namespace {

using testing::FrameOfYard;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::Yard;

FrameIdentity Numbered(int number, uint8_t first_byte = 0) {
  FrameIdentity frame;
  frame.number = FrameNumber::Whole(number);
  frame.hash[0] = first_byte;
  return frame;
}

TEST(FrameIdentity, IsOfDepthAndCamera) {
  const ReadbackFile& yard = Yard().file;
  const FrameIdentity known = IdentityOf(yard.View(), FrameNumber::Whole(1));
  ReadbackFile other = yard;
  other.shadow_bits.assign(other.shadow_bits.size(), 0);  // other lights
  EXPECT_EQ(IdentityOf(other.View(), FrameNumber::Whole(1)), known);
  EXPECT_NE(IdentityOf(other.View(), FrameNumber::Whole(2)), known);
  EXPECT_NE(IdentityOf(other.View(), std::nullopt), known);
  other.depth[4321] += 1e-6F * other.depth[4321];
  EXPECT_NE(IdentityOf(other.View(), FrameNumber::Whole(1)), known);
  other = yard;
  other.camera.camera_from_world(0, 3) += 1e-9;
  EXPECT_NE(IdentityOf(other.View(), FrameNumber::Whole(1)), known);
  other = yard;
  other.depth_kind = DepthKind::kDistance;
  EXPECT_NE(IdentityOf(other.View(), FrameNumber::Whole(1)), known);
  EXPECT_EQ(IdentityText(known), "frame 1");
  EXPECT_THAT(IdentityText(IdentityOf(yard.View(), {})), HasSubstr("without a number ("));
}

// What files hold stays what it is.
TEST(FrameIdentity, IsTheSameOnEveryMachine) {
  const std::vector<float> depth = {1.0F, 2.0F, 3.0F, 4.0F};
  Readback readback;
  readback.camera.width = readback.camera.height = 2;
  readback.camera.camera_from_world.setIdentity();
  readback.camera.screen_from_camera.setIdentity();
  readback.depth = depth;
  const FrameIdentity frame = IdentityOf(readback, std::nullopt);
  EXPECT_EQ(IdentityText(frame), "a frame without a number (abbb6002)");
}

TEST(FrameIdentity, ListsFindRepeatsAsAPlainLookDoes) {
  std::mt19937 random(testing::kSeed);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<FrameIdentity> lists[2];
    for (auto& list : lists) {
      const auto count = random() % 12;
      while (list.size() < count) {
        list.push_back(Numbered(static_cast<int>(random() % 40), random() % 2));
        if (random() % 8 == 0) list.back().number.reset();
      }
      std::sort(list.begin(), list.end());
      list.erase(std::unique(list.begin(), list.end()), list.end());
    }
    std::optional<FrameIdentity> expected;
    for (const FrameIdentity& frame : lists[0]) {
      const bool is_in_both = std::find(lists[1].begin(), lists[1].end(), frame) != lists[1].end();
      if (is_in_both && !expected.has_value()) expected = frame;
    }
    EXPECT_EQ(FirstInBoth(lists[0], lists[1]), expected);
    EXPECT_EQ(FirstInBoth(lists[1], lists[0]), expected);
    std::vector<FrameIdentity> all = lists[0];
    InsertInOrder(lists[1], &all);
    EXPECT_TRUE(std::is_sorted(all.begin(), all.end()));
    EXPECT_EQ(all.size(), lists[0].size() + lists[1].size());
  }
}

TEST(FrameIdentity, NumbersOfSeveralAreNamedOnce) {
  const std::vector<FrameIdentity> frames = {
      Numbered(1), Numbered(2, 1), Numbered(2, 2), Numbered(2, 3), Numbered(3)};
  EXPECT_THAT(NumbersOfSeveral(frames), ::testing::ElementsAre(FrameNumber::Whole(2)));
}

// A hundred thousand frames are two megabytes in a file, and come back as they were.
TEST(FrameIdentity, TakesTwentyBytesInAFile) {
  constexpr int kFrames = 20000;
  SummarySet set = testing::SetOf(Yard().file, "yard.exr");
  const size_t without = testing::BytesOf(set).size();
  for (LightSummary& light : set.lights) light.total.num_frames = kFrames;
  for (int i = 0; i < kFrames; ++i) set.frames.push_back(Numbered(1001 + i, i % 251));
  set.frames[0].number.reset();
  const std::string bytes = testing::BytesOf(set);
  EXPECT_LT(bytes.size() - without, 20u * kFrames);
  const absl::StatusOr<SummarySet> read = ParseSummarySet(bytes);
  ASSERT_THAT(read, IsOk());
  EXPECT_TRUE(read->frames == set.frames);
}

TEST(FrameIdentity, FilesThatContradictThemselvesAreRefused) {
  SummarySet set = testing::SetOf(Yard().file, "yard.exr");
  set.frames.push_back(Numbered(7));
  const auto error = [](v1::SummaryFile proto) {
    return std::string(
        ParseSummarySet(testing::FileAround(proto.SerializeAsString())).status().message());
  };
  v1::SummaryFile good;
  ASSERT_TRUE(good.ParseFromString(testing::BytesOf(set).substr(20)));
  EXPECT_EQ(error(good), "");
  v1::SummaryFile bad = good;
  bad.mutable_frame_hashes()->append(16, 'x');
  EXPECT_THAT(error(bad), HasSubstr("at most 1 frames"));
  bad = good;
  bad.mutable_frame_hashes()->pop_back();
  EXPECT_THAT(error(bad), HasSubstr("frame_hashes"));
  bad = good;
  bad.clear_frame_numbers();
  EXPECT_THAT(error(bad), HasSubstr("frames_without_number"));
  bad = good;
  bad.set_frame_numbers(0, std::numeric_limits<int64_t>::max());
  EXPECT_THAT(error(bad), HasSubstr("frame_numbers"));
  // A file of before is read, and says nothing.
  bad = good;
  bad.clear_frame_numbers();
  bad.clear_frame_hashes();
  EXPECT_EQ(error(bad), "");
}

TEST(SummarySet, AFrameThatIsInBothIsRefused) {
  std::vector<SummarySet> sets = testing::FramesOfYard(3);
  for (int i = 0; i < 3; ++i) {
    sets[i].frames = {IdentityOf(FrameOfYard(i).View(), FrameNumber::Whole(1001 + i))};
  }
  SummarySet sum = sets[0];
  ASSERT_THAT(AddToSet(sets[1], &sum), IsOk());
  SummarySet other = sets[2];
  ASSERT_THAT(AddToSet(sets[1], &other), IsOk());
  const std::string before = testing::BytesOf(sum);
  const absl::Status status = AddToSet(other, &sum);
  EXPECT_EQ(status.code(), absl::StatusCode::kAlreadyExists);
  EXPECT_THAT(status.message(), HasSubstr("frame 1002 is in what it is to be added to already"));
  EXPECT_TRUE(testing::BytesOf(sum) == before);
  ASSERT_THAT(AddToSet(sets[2], &sum), IsOk());
  EXPECT_EQ(sum.frames.size(), 3u);
  EXPECT_EQ(sum.num_unknown_frames(), 0);
}

}  // namespace
}  // namespace lightfit
