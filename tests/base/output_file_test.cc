// Outputs are seen whole or not at all.

#include "base/output_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <string>

#include "base/text_file.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(OutputFile, ReplacesTheOldFile) {
  const TemporaryFolder folder;
  WriteFile(folder.Path("a"), "old and longer");
  const absl::Status status = WriteTextFileAtomically(folder.Path("a"), "new");
  ASSERT_TRUE(status.ok()) << status;
  EXPECT_EQ(ReadFile(folder.Path("a")), "new");
  EXPECT_THAT(folder.Files(), ElementsAre("a"));
}

TEST(OutputFile, AFailureLeavesTheOldFileAndNothingElse) {
  const TemporaryFolder folder;
  WriteFile(folder.Path("a"), "old");
  // No room for more than a kilobyte, until the end of the test.
  rlimit before = {};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit little = {1024, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &little), 0);
  const absl::Status status = WriteTextFileAtomically(folder.Path("a"), std::string(100'000, 'x'));
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_FALSE(status.ok());
  EXPECT_THAT(std::string(status.message()), HasSubstr(folder.Path("a")));
  EXPECT_EQ(ReadFile(folder.Path("a")), "old");
  EXPECT_THAT(folder.Files(), ElementsAre("a"));
}

TEST(OutputFile, AFolderThatRefusesFilesIsAnError) {
  EXPECT_FALSE(WriteTextFileAtomically("/proc/lightfit", "").ok());
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
