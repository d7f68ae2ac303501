// Which files are the frames of a shot, in which order, and what they are called.

#include "jobs/shot/frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> Names(const FrameList& list) {
  std::vector<std::string> names;
  for (const ShotFrame& frame : list.frames) names.push_back(frame.name);
  return names;
}

std::vector<std::string> Numbers(const FrameList& list) {
  std::vector<std::string> numbers;
  for (const ShotFrame& frame : list.frames) numbers.push_back(frame.number.Text());
  return numbers;
}

TEST(NaturalLess, CountsAsPeopleDo) {
  std::vector<std::string> names = {
      "b1", "a10", "a9", "a", "a09", "a9b", "A2", "a99999999999999999999"};
  std::sort(names.begin(), names.end(), NaturalLess);
  EXPECT_THAT(names,
              ElementsAre("A2", "a", "a09", "a9", "a9b", "a10", "a99999999999999999999", "b1"));
  for (const std::string& a : names) EXPECT_FALSE(NaturalLess(a, a));
}

TEST(ListFrames, TakesTheReadBacksOfAFolderInOrder) {
  const TemporaryFolder folder;
  for (const char* name : {"shot.10.exr", "shot.9.EXR", "shot.11.exr", "notes.txt"}) {
    WriteFile(folder.Path(name), "");
  }
  const absl::StatusOr<FrameList> list = ListFrames({folder.Path("")});
  ASSERT_TRUE(list.ok()) << list.status();
  EXPECT_THAT(Names(*list), ElementsAre("shot.9", "shot.10", "shot.11"));
  EXPECT_THAT(Numbers(*list), ElementsAre("9", "10", "11"));
  EXPECT_EQ(list->shot, std::filesystem::path(folder.Path("x")).parent_path().filename());
}

TEST(ListFrames, CountsWhereSomeHaveNoNumber) {
  const absl::StatusOr<FrameList> list = ListFrames({"b/7.exr", "b/6.exr", "b/last.exr"});
  ASSERT_TRUE(list.ok()) << list.status();
  EXPECT_THAT(Names(*list), ElementsAre("7", "6", "last"));
  EXPECT_THAT(Numbers(*list), ElementsAre("1", "2", "3"));
  EXPECT_EQ(list->shot, "b");
}

TEST(ListFrames, TwoFilesOfOneFrameAreRefusedByName) {
  const TemporaryFolder folder;
  for (const char* name : {"beauty.1001.exr", "beauty.1002.exr", "depth.1001.exr"}) {
    WriteFile(folder.Path(name), "");
  }
  const absl::Status status = ListFrames({folder.Path("")}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr("beauty.1001.exr and "));
  EXPECT_THAT(status.message(), HasSubstr("depth.1001.exr are both frame 1001"));
  EXPECT_THAT(Numbers(*ListFrames({folder.Path("beauty.####.exr")})), ElementsAre("1001", "1002"));
  EXPECT_THAT(ListFrames({"left/1.exr", "right/1.exr"}).status().message(),
              HasSubstr("left/1.exr and right/1.exr are both frame 1"));
  EXPECT_FALSE(ListFrames({"a.1.exr", "a.01.exr"}).ok());
}

TEST(ListFrames, TwoSequencesAreRefused) {
  const TemporaryFolder folder;
  for (const char* name : {"a.1001.exr", "a.1002.exr", "b.1003.exr"}) {
    WriteFile(folder.Path(name), "");
  }
  EXPECT_THAT(ListFrames({folder.Path("")}).status().message(),
              HasSubstr("are not of one sequence (a.* and b.*)"));
  EXPECT_FALSE(ListFrames({"a.1001.exr", "b.1002.exr"}).ok());
}

TEST(ListFrames, FoldersNumberFramesOfOneName) {
  const absl::StatusOr<FrameList> list =
      ListFrames({"x/0002/rb.exr", "x/0001/rb.exr", "x/0005/rb.exr"});
  ASSERT_TRUE(list.ok()) << list.status();
  EXPECT_THAT(Names(*list), ElementsAre("0001", "0002", "0005"));
  EXPECT_THAT(Numbers(*list), ElementsAre("1", "2", "5"));
  const absl::StatusOr<FrameList> views = ListFrames({"left/rb.exr", "right/rb.exr"});
  ASSERT_TRUE(views.ok()) << views.status();
  EXPECT_THAT(Names(*views), ElementsAre("0001", "0002"));
  EXPECT_FALSE(views->is_numbered);
}

TEST(ListFrames, HiddenFilesAreNoFrames) {
  const TemporaryFolder folder;
  for (const char* name : {"shot.1001.exr", "._shot.1001.exr", ".shot.1002.exr"}) {
    WriteFile(folder.Path(name), "");
  }
  std::filesystem::create_directory(folder.Path("shot.1003.exr"));
  EXPECT_THAT(Numbers(*ListFrames({folder.Path("")})), ElementsAre("1001"));
  EXPECT_THAT(Numbers(*ListFrames({folder.Path("*.exr")})), ElementsAre("1001"));
  EXPECT_FALSE(ListFrames({folder.Path("._shot.1001.exr")}).ok());
}

TEST(ListFrames, NumbersBelowZeroAndBetweenFramesAreInOrder) {
  const TemporaryFolder folder;
  for (const char* name : {"s.-001.exr",
                           "s.-002.exr",
                           "s.000.exr",
                           "s.001.exr",
                           "s.002.exr",
                           "s.001.5.exr",
                           "s.001.25.exr"}) {
    WriteFile(folder.Path(name), "");
  }
  const absl::StatusOr<FrameList> list = ListFrames({folder.Path("")});
  ASSERT_TRUE(list.ok()) << list.status();
  EXPECT_THAT(Numbers(*list), ElementsAre("-2", "-1", "0", "1", "1.25", "1.5", "2"));
  EXPECT_THAT(Names(*list),
              ElementsAre("s.-002", "s.-001", "s.000", "s.001", "s.001.25", "s.001.5", "s.002"));
  EXPECT_EQ(list->missing, "");
}

TEST(ListFrames, SaysWhatIsMissing) {
  const absl::StatusOr<FrameList> list =
      ListFrames({"s.1003.exr", "s.1001.exr", "s.1002.exr", "s.1007.exr"});
  ASSERT_TRUE(list.ok()) << list.status();
  EXPECT_THAT(Numbers(*list), ElementsAre("1001", "1002", "1003", "1007"));
  EXPECT_EQ(list->missing, "frames 1004-1006 are missing (3)");
  EXPECT_THAT(list->reordered, HasSubstr("in the order of their numbers"));
  EXPECT_TRUE(list->frames[3].is_after_gap);
  EXPECT_FALSE(list->frames[2].is_after_gap);
  EXPECT_THAT(ListFrames({"s.1.exr", "s.3.exr", "s.5.exr"})->apart, HasSubstr("2 apart"));
}

TEST(ListFrames, PathsOfAListAreRelativeToIt) {
  const TemporaryFolder folder;
  WriteFile(folder.Path("walk.v2.txt"), "# two frames\r\n\r\n a/1.exr \r\n/b/2.exr\r\n");
  const absl::StatusOr<FrameList> list = ListFrames({folder.Path("walk.v2.txt")});
  ASSERT_TRUE(list.ok()) << list.status();
  ASSERT_EQ(list->frames.size(), 2u);
  EXPECT_EQ(list->frames[0].path, folder.Path("a/1.exr"));
  EXPECT_EQ(list->frames[1].path, "/b/2.exr");
  EXPECT_EQ(list->shot, "walk.v2");
}

TEST(ListFrames, RefusesMixtures) {
  const TemporaryFolder folder;
  const absl::StatusOr<FrameList> list = ListFrames({"1.exr", folder.Path("")});
  ASSERT_FALSE(list.ok());
  EXPECT_THAT(list.status().message(), HasSubstr("want one folder, one list, or .exr files alone"));
  EXPECT_FALSE(ListFrames({}).ok());
}

}  // namespace
}  // namespace lightfit
