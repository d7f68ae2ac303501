// Outputs are seen whole or not at all.

#include "base/output_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(OutputFile, ReplacesTheOldFile) {
  const TemporaryFolder folder;
  WriteFile(folder.Path("a"), "old and longer");
  const absl::Status status =
      WriteThroughTemporary(folder.Path("a"), [](const std::string& temporary) {
        WriteFile(temporary, "new");
        return absl::OkStatus();
      });
  ASSERT_TRUE(status.ok()) << status;
  EXPECT_EQ(ReadFile(folder.Path("a")), "new");
  EXPECT_THAT(folder.Files(), ElementsAre("a"));
}

TEST(OutputFile, AFailureLeavesTheOldFileAndNothingElse) {
  const TemporaryFolder folder;
  WriteFile(folder.Path("a"), "old");
  const absl::Status status =
      WriteThroughTemporary(folder.Path("a"), [](const std::string& temporary) {
        WriteFile(temporary, "half of it");
        return absl::UnknownError("out of ink");
      });
  EXPECT_THAT(std::string(status.message()), HasSubstr("out of ink"));
  EXPECT_EQ(ReadFile(folder.Path("a")), "old");
  EXPECT_THAT(folder.Files(), ElementsAre("a"));
}

TEST(OutputFile, AFolderThatRefusesFilesIsAnError) {
  const auto write_nothing = [](const std::string&) { return absl::OkStatus(); };
  EXPECT_FALSE(WriteThroughTemporary("/proc/lightfit", write_nothing).ok());
}

TEST(OutputFile, ChecksTheFolderBeforehand) {
  const TemporaryFolder folder;
  EXPECT_TRUE(CheckWritable("--json", folder.Path("new.json")).ok());
  EXPECT_TRUE(CheckWritable("--json", "relative.json").ok());
  EXPECT_FALSE(CheckWritable("--json", "").ok());
  EXPECT_FALSE(CheckWritable("--json", folder.Path("")).ok());
  EXPECT_THAT(std::string(CheckWritable("--json", folder.Path("no/new.json")).message()),
              HasSubstr("--json"));
}

}  // namespace
}  // namespace lightfit
