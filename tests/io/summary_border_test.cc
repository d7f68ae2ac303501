// Border and facing of a summary file: what was written comes back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "io/summary_file.h"
#include "optimizer/fit.h"
#include "tests/io/summary_examples.h"

namespace lightfit {
namespace {

using testing::BytesOf;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::kMap;
using testing::kWriter;
using testing::SetOf;
using testing::StatusIs;
using testing::Yard;

// The yard as if all of it faced all lights: planes that contradict are left out.
ReadbackFile YardWithFacing() {
  ReadbackFile file = Yard().file;
  file.facing_bits.assign(file.depth.size(), ~uint32_t{0});
  file.facing_lights = ~uint32_t{0};
  return file;
}

FitOptions OptionsWith(BorderChoice border) {
  FitOptions options;
  options.border = border;
  return options;
}

TEST(SummaryBorder, BorderAndFacingComeBack) {
  for (const BorderChoice choice : {BorderChoice::kLit, BorderChoice::kDark}) {
    for (const bool is_given : {false, true}) {
      SCOPED_TRACE(static_cast<int>(choice));
      SCOPED_TRACE(is_given);
      const Border border = choice == BorderChoice::kDark ? Border::kDark : Border::kLit;
      const FacingSource facing = is_given ? FacingSource::kGiven : FacingSource::kGuessed;
      const testing::TemporaryFolder folder;
      const SummarySet set =
          SetOf(is_given ? YardWithFacing() : Yard().file, "yard.exr", OptionsWith(choice));
      ASSERT_THAT(WriteSummaryFile(folder.File("a.summary"), set, kWriter), IsOk());
      const absl::StatusOr<SummarySet> read = ReadSummaryFile(folder.File("a.summary"));
      ASSERT_THAT(read, IsOk());
      EXPECT_EQ(read->options.border, choice);
      ASSERT_EQ(read->lights.size(), set.lights.size());
      for (size_t i = 0; i < read->lights.size(); ++i) {
        const SummaryTotal &before = set.lights[i].total, &after = read->lights[i].total;
        ASSERT_EQ(after.num_frames, 1);
        EXPECT_EQ(after.border, border);
        EXPECT_EQ(after.facing, facing);
        EXPECT_EQ(after.counts.used, before.counts.used);
        EXPECT_EQ(after.counts.beyond_map, before.counts.beyond_map);
        const absl::StatusOr<Summary> old_sum = SummaryOfTotal(before);
        const absl::StatusOr<Summary> new_sum = SummaryOfTotal(after);
        ASSERT_EQ(old_sum.status(), new_sum.status());
        if (!old_sum.ok()) continue;
        EXPECT_EQ(new_sum->cover.border, border);
        EXPECT_EQ(new_sum->cover.hull, old_sum->cover.hull);
        const auto expected = Fit(*old_sum, before.light, kMap, set.options);
        const auto matrix = Fit(*new_sum, after.light, kMap, read->options);
        ASSERT_THAT(expected, IsOk());
        ASSERT_THAT(matrix, IsOk());
        EXPECT_EQ(matrix->map_from_world, expected->map_from_world);
        EXPECT_EQ(matrix->border, border);
        EXPECT_EQ(matrix->facing, facing);
      }
      EXPECT_TRUE(BytesOf(*read) == testing::Bytes(folder.File("a.summary")));
    }
  }
}

// Half of it on the way through a file.
TEST(SummaryBorder, SumsAreGivenOnlyIfAllFramesAre) {
  const FitOptions dark = OptionsWith(BorderChoice::kDark);
  const SummarySet given = SetOf(YardWithFacing(), "a.exr", dark);
  const SummarySet guessed = SetOf(Yard().file, "b.exr", dark);
  for (const bool other_is_given : {false, true}) {
    SummarySet sum = given;
    const absl::StatusOr<SummarySet> other =
        ParseSummarySet(BytesOf(other_is_given ? given : guessed));
    ASSERT_THAT(other, IsOk());
    ASSERT_THAT(AddToSet(*other, &sum), IsOk());
    const absl::StatusOr<SummarySet> read = ParseSummarySet(BytesOf(sum));
    ASSERT_THAT(read, IsOk());
    for (const LightSummary& light : read->lights) {
      EXPECT_EQ(light.total.border, Border::kDark);
      EXPECT_EQ(light.total.facing, other_is_given ? FacingSource::kGiven : FacingSource::kGuessed);
    }
  }
}

TEST(SummaryBorder, FilesOfDifferentBordersDoNotAdd) {
  SummarySet lit = SetOf(YardWithFacing(), "a.exr", OptionsWith(BorderChoice::kLit));
  const absl::StatusOr<SummarySet> dark =
      ParseSummarySet(BytesOf(SetOf(YardWithFacing(), "a.exr", OptionsWith(BorderChoice::kDark))));
  ASSERT_THAT(dark, IsOk());
  EXPECT_THAT(AddToSet(*dark, &lit),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("options.border")));
}

}  // namespace
}  // namespace lightfit
