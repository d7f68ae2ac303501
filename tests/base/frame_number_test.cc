#include "base/frame_number.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lightfit {
namespace {

TEST(FrameNumber, IsWhatNamesSay) {
  const struct {
    const char* text;
    int64_t millionths;
    const char* written;
  } cases[] = {{"0", 0, "0"},
               {"-0", 0, "0"},
               {"007", 7000000, "7"},
               {"-002", -2000000, "-2"},
               {"1001.25", 1001250000, "1001.25"},
               {"1001.500", 1001500000, "1001.5"},
               {"-1.5", -1500000, "-1.5"},
               {"1001.000001", 1001000001, "1001.000001"},
               {"000000000000000000000012", 12000000, "12"},
               {"999999999999", 999999999999000000, "999999999999"}};
  for (const auto& c : cases) {
    const std::optional<FrameNumber> number = ParseFrameNumber(c.text);
    ASSERT_TRUE(number.has_value()) << c.text;
    EXPECT_EQ(number->millionths, c.millionths) << c.text;
    EXPECT_EQ(number->Text(), c.written);
    EXPECT_EQ(number->floor() * FrameNumber::kUnit + number->rest(), c.millionths);
    EXPECT_GE(number->rest(), 0);
  }
  for (const char* bad :
       {"", "-", "a", "1a", "1.", ".5", "--1", "1.2.3", "+1", "1000000000000", "1.0000001", " 1"}) {
    EXPECT_FALSE(ParseFrameNumber(bad).has_value()) << bad;
  }
}

TEST(FrameNumber, TakesNumbersOfFiles) {
  EXPECT_EQ(FrameNumberOf(1001.25)->Text(), "1001.25");
  EXPECT_EQ(FrameNumberOf(-2.0), FrameNumber::Whole(-2));
  EXPECT_EQ(FrameNumberOf(0.1)->Text(), "0.1");
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e13, -1e300}) {
    EXPECT_FALSE(FrameNumberOf(bad).has_value()) << bad;
  }
  EXPECT_LT(FrameNumber::Whole(-2), FrameNumber::Whole(-1));
}

}  // namespace
}  // namespace lightfit
