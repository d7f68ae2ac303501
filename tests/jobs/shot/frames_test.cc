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

std::vector<int64_t> Numbers(const FrameList& list) {
  std::vector<int64_t> numbers;
  for (const ShotFrame& frame : list.frames) numbers.push_back(frame.number);
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
  EXPECT_THAT(Numbers(*list), ElementsAre(9, 10, 11));
  EXPECT_EQ(list->shot, std::filesystem::path(folder.Path("x")).parent_path().filename());
}

TEST(ListFrames, CountsWhereNumbersDoNotRise) {
  const absl::StatusOr<FrameList> list = ListFrames({"b/7.exr", "b/6.exr", "b/last.exr"});
  ASSERT_TRUE(list.ok()) << list.status();
  EXPECT_THAT(Names(*list), ElementsAre("7", "6", "last"));
  EXPECT_THAT(Numbers(*list), ElementsAre(1, 2, 3));
  EXPECT_EQ(list->shot, "b");
}

TEST(ListFrames, NumbersFramesOfOneName) {
  const absl::StatusOr<FrameList> list = ListFrames({"left/1.exr", "right/1.exr"});
  ASSERT_TRUE(list.ok()) << list.status();
  EXPECT_THAT(Names(*list), ElementsAre("0001", "0002"));
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
