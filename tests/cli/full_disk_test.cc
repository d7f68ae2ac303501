// A picture that does not fit on the disk: an error, no cut file, and the old one stays.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>

#include <csignal>
#include <cstring>
#include <filesystem>

#include "tests/cli/box_shot.h"
#include "tests/cli/examples.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// Smaller than every picture here, larger than what `shot` writes besides. Whole pages of memory.
constexpr int64_t kRoomBytes = 8192;

// No file may become longer, neither ours nor of the programs started meanwhile.
class FileSizeLimit {
 public:
  FileSizeLimit() {
    handler_ = std::signal(SIGXFSZ, SIG_IGN);  // an error instead of a death
    getrlimit(RLIMIT_FSIZE, &old_);
    rlimit limit = old_;
    limit.rlim_cur = kRoomBytes;
    EXPECT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0) << "errno " << errno;
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit old_ = {};
  void (*handler_)(int) = SIG_DFL;
};

// A disk of four megabytes at a folder, for who may have one.
class SmallDisk {
 public:
  explicit SmallDisk(const std::string& folder) : folder_(folder) {
    std::filesystem::create_directory(folder);
    is_mounted_ = mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=4m") == 0;
  }
  ~SmallDisk() {
    if (is_mounted_) umount2(folder_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  bool is_mounted() const { return is_mounted_; }

  // Leaves kRoomBytes.
  void Fill() const {
    const auto available = static_cast<int64_t>(std::filesystem::space(folder_).available);
    ASSERT_GT(available, kRoomBytes);
    WriteFile(folder_ + "/filler", std::string(available - kRoomBytes, 'x'));
    ASSERT_EQ(static_cast<int64_t>(std::filesystem::space(folder_).available), kRoomBytes);
  }

 private:
  const std::string folder_;
  bool is_mounted_ = false;
};

class FullDiskTest : public ::testing::TestWithParam<std::string> {
 protected:
  // Draws into the folder out/ of the test's.
  ProcessResult Draw() const {
    const std::string picture = PicturePath();
    if (GetParam() == "fit") {
      return RunLightfit({"fit", kYard, "--lights", kYardLights, "--picture", picture});
    }
    if (GetParam() == "shot") return shot_.Run();
    std::vector<std::string> arguments = {GetParam(),
                                          "generate:objects=10,triangles=3000",
                                          "--camera",
                                          "0,1.7,18:0,0.5,0",
                                          "--light",
                                          "low=sun:1,-0.6,0.3",
                                          "--picture",
                                          picture};
    if (GetParam() == "compare") {
      arguments.insert(arguments.end(), {"--screen", "160x120", "--map", "100x100"});
    } else {
      arguments.insert(arguments.end(), {"--picture-size", "960x720"});
    }
    return RunLightfit(arguments);
  }

  void ExpectRefusal(const std::string& reason) const {
    const std::map<std::string, std::string> before = FilesBelow(Output());
    ASSERT_GT(before.at(PictureName()).size(), static_cast<size_t>(kRoomBytes));
    const ProcessResult result = Draw();
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(
        result.err,
        AllOf(StartsWith("lightfit: error: "), HasSubstr(PicturePath()), HasSubstr(reason)));
    EXPECT_TRUE(FilesBelow(Output()) == before);
  }

  std::string Output() const { return shot_.Output(); }
  std::string PictureName() const { return GetParam() == "shot" ? "shot.png" : "out.png"; }
  std::string PicturePath() const { return Output() + "/" + PictureName(); }

  const BoxShot shot_{3};
};

TEST_P(FullDiskTest, AFileThatMayNotGrowIsAnErrorAndTheOldOneStays) {
  std::filesystem::create_directory(Output());
  const ProcessResult first = Draw();
  ASSERT_EQ(first.exit_code, 0) << first.err;
  const FileSizeLimit limit;
  ExpectRefusal("File too large");
}

TEST_P(FullDiskTest, AFullDiskIsAnErrorAndTheOldFileStays) {
  const SmallDisk disk(Output());
  if (!disk.is_mounted()) GTEST_SKIP() << "no disk can be mounted here: wants root";
  const ProcessResult first = Draw();
  ASSERT_EQ(first.exit_code, 0) << first.err;
  disk.Fill();
  ExpectRefusal("No space left on device");
}

INSTANTIATE_TEST_SUITE_P(Verbs,
                         FullDiskTest,
                         ::testing::Values("fit", "compare", "render", "shot"),
                         [](const auto& verb) { return verb.param; });

}  // namespace
}  // namespace lightfit
