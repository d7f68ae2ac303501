// Patterns of file names, against folders of files.

#include "jobs/frames/frame_pattern.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class FramePattern : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"shot.-002.exr",
                             "shot.0000.exr",
                             "shot.0001.exr",
                             "shot.1001.exr",
                             "shot.10012.exr",
                             "shot.1001.25.exr",
                             "shot.7.exr",
                             "other.0001.exr",
                             "._shot.0001.exr",
                             "shot.0001.png"}) {
      WriteFile(folder_.Path(name), "");
    }
    for (const char* frame : {"0003", "0004"}) {
      std::filesystem::create_directory(folder_.Path(frame));
      WriteFile(folder_.Path(absl::StrCat(frame, "/rb.exr")), "");
    }
  }

  // "0001.exr=1 ..." of the files, without the folder; or the error.
  std::string Found(const std::string& pattern) const {
    const absl::StatusOr<std::vector<MatchedFile>> files = FilesMatching(folder_.Path(pattern));
    if (!files.ok()) return std::string(files.status().message());
    return absl::StrJoin(*files, " ", [this](std::string* out, const MatchedFile& file) {
      absl::StrAppend(out,
                      file.path.substr(folder_.Path("").size()),
                      file.number.has_value() ? absl::StrCat("=", file.number->Text()) : "");
    });
  }

  const TemporaryFolder folder_;
};

TEST_F(FramePattern, MarksOfProgramsAreNumbers) {
  for (const char* mark : {"%04d",
                           "####",
                           "@@@@",
                           "$F4",
                           "${F4}",
                           "<F4>",
                           "<frame04>",
                           "<UDIM>",
                           "<udim>",
                           "{frame:04d}",
                           "%04i"}) {
    const std::string found = Found(absl::StrCat("shot.", mark, ".exr"));
    EXPECT_EQ(found,
              "shot.-002.exr=-2 shot.0000.exr=0 shot.0001.exr=1 shot.1001.exr=1001 "
              "shot.10012.exr=10012")
        << mark;
  }
  for (const char* mark : {"%d", "#", "@", "$F", "${F}", "<F>", "<frame>", "{frame}"}) {
    EXPECT_EQ(Found(absl::StrCat("shot.", mark, ".exr")),
              "shot.-002.exr=-2 shot.0000.exr=0 shot.0001.exr=1 shot.7.exr=7 shot.1001.exr=1001 "
              "shot.10012.exr=10012")
        << mark;
  }
  EXPECT_EQ(Found("shot.$FF.exr"),
            "shot.-002.exr=-2 shot.0000.exr=0 shot.0001.exr=1 shot.7.exr=7 "
            "shot.1001.25.exr=1001.25 shot.1001.exr=1001 shot.10012.exr=10012");
  EXPECT_EQ(Found("%04d/rb.exr"), "0003/rb.exr=3 0004/rb.exr=4");
}

TEST_F(FramePattern, GlobsAreNames) {
  EXPECT_EQ(Found("o*.exr"), "other.0001.exr");
  EXPECT_EQ(Found("shot.000?.exr"), "shot.0000.exr shot.0001.exr");
  EXPECT_EQ(Found("shot.000[1-9].exr"), "shot.0001.exr");
  EXPECT_EQ(Found("[os]*.####.exr"),
            "other.0001.exr=1 shot.-002.exr=-2 shot.0000.exr=0 shot.0001.exr=1 shot.1001.exr=1001 "
            "shot.10012.exr=10012");
  EXPECT_EQ(Found("*/rb.exr"), "0003/rb.exr 0004/rb.exr");
}

TEST_F(FramePattern, NothingFoundNamesPatternAndFolder) {
  EXPECT_THAT(
      Found("walk.%04d.exr"),
      AllOf(HasSubstr("walk.%04d.exr: no file in "),
            HasSubstr("matches this pattern; it has 8 .exr files, such as other.0001.exr")));
  EXPECT_THAT(Found("*.summary"), HasSubstr("it has no .summary files"));
  EXPECT_THAT(Found("none/####.exr"), HasSubstr("none matches this pattern"));
}

TEST_F(FramePattern, AFileOfThatNameIsNoPattern) {
  WriteFile(folder_.Path("take[1].exr"), "");
  EXPECT_FALSE(IsFilePattern(folder_.Path("take[1].exr")));
  EXPECT_TRUE(IsFilePattern(folder_.Path("take[2].exr")));
  EXPECT_TRUE(IsFilePattern("shot.####.exr"));
  for (const char* plain : {"shot.0001.exr", "100%.exr", "a<b>.exr", "$HOME.exr", "[", "{frame"}) {
    EXPECT_FALSE(IsFilePattern(plain)) << plain;
  }
  std::filesystem::create_directory(folder_.Path("final [v2]"));
  WriteFile(folder_.Path("final [v2]/a.0001.exr"), "");
  EXPECT_EQ(Found("final [v2]/a.####.exr"), "final [v2]/a.0001.exr=1");
}

}  // namespace
}  // namespace lightfit
