#include "base/text_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <thread>

#include "tests/io/testing.h"

namespace lightfit {
namespace {

using testing::HasAll;

TEST(TextFile, ReadsBackWhatItWroteAndLeavesNothingElse) {
  const testing::TemporaryFolder folder;
  const std::string text("a\0b\n\xff", 5);
  ASSERT_TRUE(WriteTextFileAtomically(folder.File("a.txt"), text).ok());
  ASSERT_TRUE(WriteTextFileAtomically(folder.File("a.txt"), text + text).ok());
  const auto read = ReadTextFile(folder.File("a.txt"));
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(*read, text + text);
  EXPECT_EQ(folder.num_files(), 1);
}

TEST(TextFile, NewFilesHaveOrdinaryPermissions) {
  const testing::TemporaryFolder folder;
  std::ofstream(folder.File("ordinary")) << "x";
  ASSERT_TRUE(WriteTextFileAtomically(folder.File("ours"), "x").ok());
  struct stat ordinary = {}, ours = {};
  ASSERT_EQ(stat(folder.File("ordinary").c_str(), &ordinary), 0);
  ASSERT_EQ(stat(folder.File("ours").c_str(), &ours), 0);
  EXPECT_EQ(ours.st_mode, ordinary.st_mode);
}

TEST(TextFile, FailedWritesNameThePathAndLeaveNothing) {
  const testing::TemporaryFolder folder;
  const std::string nowhere = folder.File("missing/a.txt");
  EXPECT_TRUE(HasAll(WriteTextFileAtomically(nowhere, "x").message(), {nowhere, "No such file"}));
  std::filesystem::create_directory(folder.File("taken"));
  EXPECT_TRUE(HasAll(WriteTextFileAtomically(folder.File("taken"), "x").message(),
                     {folder.File("taken"), "cannot be written"}));
  EXPECT_EQ(folder.num_files(), 1);
}

TEST(TextFile, ReadersNeverSeeHalfAFile) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("a.txt");
  const std::string first(300000, 'a'), second(300000, 'b');
  ASSERT_TRUE(WriteTextFileAtomically(path, first).ok());
  std::thread writer([&] {
    for (int i = 0; i < 30; ++i) {
      EXPECT_TRUE(WriteTextFileAtomically(path, i % 2 == 0 ? second : first).ok());
    }
  });
  for (int i = 0; i < 200; ++i) {
    const auto read = ReadTextFile(path);
    ASSERT_TRUE(read.ok()) << read.status();
    ASSERT_TRUE(*read == first || *read == second);
  }
  writer.join();
}

TEST(TextFile, RefusesFilesOverTheLimit) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.Write("a.txt", std::string(100001, 'x'));
  EXPECT_TRUE(ReadTextFile(path, 100001).ok());
  EXPECT_TRUE(HasAll(ReadTextFile(path, 100000).status().message(), {path, "100000 bytes"}));
  // An endless file stops at the limit.
  EXPECT_TRUE(HasAll(ReadTextFile("/dev/zero", 1 << 20).status().message(), {"/dev/zero"}));
}

TEST(TextFile, MissingFilesAndFoldersHaveTheirOwnErrors) {
  const testing::TemporaryFolder folder;
  EXPECT_EQ(ReadTextFile(folder.File("none")).status().code(), absl::StatusCode::kNotFound);
  EXPECT_TRUE(HasAll(ReadTextFile(folder.File("")).status().message(), {"is a folder"}));
}

}  // namespace
}  // namespace lightfit
