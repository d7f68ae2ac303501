// Which digits of a name are the frame's number.

#include "jobs/frames/frame_names.h"

#include <gtest/gtest.h>

#include "absl/strings/str_join.h"

namespace lightfit {
namespace {

struct Case {
  std::vector<std::string> names;
  std::vector<std::string> numbers;  // "-": none
  bool is_one_series = true;
};

std::string NumbersOf(const std::vector<FrameName>& names) {
  return absl::StrJoin(names, " ", [](std::string* out, const FrameName& name) {
    out->append(name.number.has_value() ? name.number->Text() : "-");
  });
}

TEST(FrameNames, AreReadAsProgramsWriteThem) {
  const Case cases[] = {
      {{"1001"}, {"1001"}},
      {{"shot.1001"}, {"1001"}},
      {{"shot_v002_1001"}, {"1001"}},
      {{"shot.v002.1001", "shot.v002.1002"}, {"1001", "1002"}},
      {{"frame0009", "frame0010"}, {"9", "10"}},
      {{"shot.9", "shot.10", "shot.11"}, {"9", "10", "11"}},
      {{"shot_1001_left", "shot_1002_left"}, {"1001", "1002"}},
      {{"shot.1001.denoised"}, {"1001"}},
      {{"sh010_0040_lgt.1001", "sh010_0040_lgt.1002"}, {"1001", "1002"}},
      {{"0001_180", "0002_180"}, {"1", "2"}},  // what varies
      {{"shot_v02"}, {"-"}},
      {{"beauty"}, {"-"}},
      {{"beauty4k"}, {"-"}},
      {{"20261127192309123"}, {"-"}},  // a date
      // Below zero.
      {{"shot.-002", "shot.-001", "shot.000", "shot.001"}, {"-2", "-1", "0", "1"}},
      {{"shot_-002"}, {"-2"}},
      {{"-0002"}, {"-2"}},
      {{"shot--002"}, {"-2"}},
      {{"shot-0002"}, {"2"}},
      {{"shot-0002", "shot-0001"}, {"2", "1"}},
      {{"shot-0001", "shot0000", "shot0001"}, {"-1", "0", "1"}},
      {{"shot-0001", "shot0002"}, {"1", "2"}, false},  // nobody knows
      // Between frames.
      {{"shot.1001", "shot.1001.25", "shot.1001.5", "shot.1002"},
       {"1001", "1001.25", "1001.5", "1002"}},
      {{"1001.25"}, {"1001.25"}},
      {{"shot.1001.25", "shot.1001.50", "shot.1001.75"}, {"1001.25", "1001.5", "1001.75"}},
      {{"shot.9.5", "shot.10.5", "shot.10"}, {"9.5", "10.5", "10"}},
      {{"shot.-001.5", "shot.-001", "shot.000"}, {"-1.5", "-1", "0"}},
      {{"shot.9.25", "shot.10.25"}, {"9.25", "10.25"}},
      // A take or a version, and then the frame.
      {{"shot.2.1001", "shot.2.1002"}, {"1001", "1002"}},
      {{"shot.2.1001"}, {"1001"}},
      {{"shot.0012.001", "shot.0012.002"}, {"1", "2"}},
      {{"shot.2024.1001", "shot.2024.1002"}, {"1001", "1002"}},
      {{"shot.v1.1001"}, {"1001"}},
      // Two sequences.
      {{"beauty.1001", "depth.1001"}, {"1001", "1001"}, false},
      {{"shot.1.0001", "shot.2.0001"}, {"1", "1"}, false},
      {{"b.1001", "a.1002", "notes"}, {"1001", "1002", "-"}, false},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(absl::StrJoin(c.names, " "));
    const std::vector<FrameName> names = ReadFrameNames(c.names);
    EXPECT_EQ(NumbersOf(names), absl::StrJoin(c.numbers, " "));
    bool is_one_series = true;
    for (const FrameName& name : names) is_one_series &= name.series == names[0].series;
    EXPECT_EQ(is_one_series, c.is_one_series);
  }
}

TEST(FrameNames, OfNoFilesAreNone) { EXPECT_TRUE(ReadFrameNames({}).empty()); }

}  // namespace
}  // namespace lightfit
