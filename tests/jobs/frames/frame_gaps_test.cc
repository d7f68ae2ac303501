// Frames that a shot lacks.

#include "jobs/frames/frame_gaps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_join.h"

namespace lightfit {
namespace {

using ::testing::ElementsAre;

FrameGaps GapsOf(const std::vector<std::string>& numbers) {
  std::vector<FrameNumber> parsed;
  for (const std::string& number : numbers) parsed.push_back(*ParseFrameNumber(number));
  return FindGaps(parsed);
}

std::string Missing(const std::vector<std::string>& numbers) {
  return absl::StrJoin(GapsOf(numbers).missing, " ");
}

TEST(FrameGaps, NameWhatIsMissing) {
  const FrameGaps gaps = GapsOf({"1001", "1002", "1003", "1007", "1009"});
  EXPECT_EQ(GapsText(gaps), "frames 1004-1006, 1008 are missing (4)");
  EXPECT_THAT(gaps.is_after, ElementsAre(false, false, false, true, true));
  EXPECT_EQ(GapsText(GapsOf({"-1", "1", "2"})), "frame 0 is missing");
  EXPECT_EQ(GapsText(GapsOf({"1", "2", "3"})), "");
  EXPECT_EQ(GapsText(GapsOf({"7"})), "");
  EXPECT_EQ(GapsText(FindGaps({})), "");
}

TEST(FrameGaps, KeepToTheStepOfTheShot) {
  EXPECT_EQ(Missing({"1001", "1003", "1005"}), "");
  EXPECT_EQ(GapsOf({"1001", "1003", "1005"}).step, FrameNumber::Whole(2));
  EXPECT_EQ(Missing({"1001", "1003", "1007"}), "1005");
  EXPECT_EQ(Missing({"1001", "1001.25", "1001.5", "1001.75", "1002.25"}), "1002");
  // No gap before a whole frame is missing where they lie unevenly.
  EXPECT_EQ(Missing({"1001", "1001.25", "1001.5", "1002", "1003"}), "");
  EXPECT_EQ(Missing({"1001", "1001.25", "1001.5", "1002", "1004"}), "1003");
}

TEST(FrameGaps, ListTheFirstOfMany) {
  std::vector<FrameNumber> numbers;
  for (int i = 0; i < 40; ++i) numbers.push_back(FrameNumber::Whole(i * 3 + i % 2));
  const std::string text = GapsText(FindGaps(numbers));
  EXPECT_NE(text.find(", ... are missing"), std::string::npos) << text;
  EXPECT_LT(text.size(), 120u);
}

}  // namespace
}  // namespace lightfit
