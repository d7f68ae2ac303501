// `lightfit shot` goes on where it was stopped, and ends in the same bytes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include "absl/strings/match.h"
#include "tests/cli/box_shot.h"
#include "tests/cli/examples.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(ShotResume, ThreadsDoNotChangeABit) {
  const BoxShot shot(6);
  ASSERT_EQ(shot.Run({"--quiet", "--threads", "1"}).exit_code, 0);
  const auto one = FilesBelow(shot.Output());
  ASSERT_EQ(shot.Run({"--quiet", "--threads", "4", "--force"}).exit_code, 0);
  EXPECT_TRUE(one == FilesBelow(shot.Output()));
}

TEST(ShotResume, GoesOnAfterTheFramesThatAreThere) {
  const BoxShot shot(6);
  ASSERT_EQ(shot.Run().exit_code, 0);
  const auto whole = FilesBelow(shot.Output());
  // As a run leaves it that was stopped after three frames.
  for (const auto& [name, text] : whole) {
    const bool is_early = absl::StrContains(name, "walk.0998") ||
                          absl::StrContains(name, "walk.0999") ||
                          absl::StrContains(name, "walk.1000");
    if (!is_early || absl::StartsWith(name, "per-shot")) {
      std::filesystem::remove(shot.Output() + "/" + name);
    }
  }
  const ProcessResult result = shot.Run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("resuming: 3 of 6 frames are done"));
  EXPECT_TRUE(whole == FilesBelow(shot.Output()));
}

TEST(ShotResume, FillsAnyHoles) {
  const BoxShot shot(6);
  ASSERT_EQ(shot.Run({"--quiet"}).exit_code, 0);
  const auto whole = FilesBelow(shot.Output());
  constexpr uint32_t kSeed = 11;
  std::mt19937 random(kSeed);
  for (int round = 0; round < 4; ++round) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed << ", round " << round);
    for (const auto& [name, text] : whole) {
      if (random() % 3 == 0) std::filesystem::remove(shot.Output() + "/" + name);
    }
    ASSERT_EQ(shot.Run({"--quiet"}).exit_code, 0);
    EXPECT_TRUE(whole == FilesBelow(shot.Output()));
  }
}

// A result that is taken over keeps a mark that a fresh one does not have.
class Marked {
 public:
  explicit Marked(const BoxShot& shot) : shot_(shot) {}

  void Mark() const {
    for (const auto& [name, text] : FilesBelow(shot_.Output())) {
      if (absl::EndsWith(name, ".json")) WriteFile(shot_.Output() + "/" + name, text + "\n");
    }
  }
  bool IsKept(const std::string& mode, int frame) const {
    return absl::EndsWith(ReadFile(shot_.ResultPath(mode, frame)), "\n\n");
  }

 private:
  const BoxShot& shot_;
};

TEST(ShotResume, ComputesAgainWhatDependsOnAChangedFile) {
  const BoxShot shot(5);
  ASSERT_EQ(shot.Run({"--quiet"}).exit_code, 0);
  const Marked marked(shot);
  marked.Mark();
  // The same pixels without one of the lights.
  shot.Write(2, {shot.lights()[0]});
  EXPECT_EQ(shot.Run({"--quiet"}).exit_code, 3);
  for (int frame = 0; frame < 5; ++frame) {
    // The crawl looks one frame back, the tracker at all of them, the shot's map at every frame.
    EXPECT_EQ(marked.IsKept("per-frame", frame), frame != 2 && frame != 3) << frame;
    EXPECT_EQ(marked.IsKept("tracked", frame), frame < 2) << frame;
    EXPECT_FALSE(marked.IsKept("per-shot", frame)) << frame;
  }
}

TEST(ShotResume, ComputesAgainWhatDependsOnChangedOptions) {
  const BoxShot shot(3);
  ASSERT_EQ(shot.Run({"--quiet"}).exit_code, 0);
  const Marked marked(shot);
  marked.Mark();
  ASSERT_EQ(shot.Run({"--quiet", "--stability", "0.8"}).exit_code, 0);
  EXPECT_TRUE(marked.IsKept("per-frame", 1));
  EXPECT_FALSE(marked.IsKept("tracked", 1));
  EXPECT_TRUE(marked.IsKept("per-shot", 1));
  marked.Mark();
  ASSERT_EQ(shot.Run({"--quiet", "--stability", "0.8", "--rounds", "0"}).exit_code, 0);
  EXPECT_TRUE(marked.IsKept("tracked", 1));
  EXPECT_FALSE(marked.IsKept("per-shot", 1));
  marked.Mark();
  ASSERT_EQ(
      shot.Run({"--quiet", "--stability", "0.8", "--rounds", "0", "--clip", "opengl"}).exit_code,
      0);
  for (const char* mode : {"per-frame", "tracked", "per-shot"}) {
    EXPECT_FALSE(marked.IsKept(mode, 1)) << mode;
  }
}

TEST(ShotResume, ForceComputesAllAgain) {
  const BoxShot shot(2);
  ASSERT_EQ(shot.Run().exit_code, 0);
  const auto whole = FilesBelow(shot.Output());
  const Marked marked(shot);
  marked.Mark();
  const ProcessResult result = shot.Run({"--force"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, Not(HasSubstr("resuming")));
  EXPECT_TRUE(whole == FilesBelow(shot.Output()));
}

// What a stopped run may leave behind: half a file of another program, an old name.
TEST(ShotResume, DamagedResultsAreReplaced) {
  const BoxShot shot(2);
  ASSERT_EQ(shot.Run({"--quiet"}).exit_code, 0);
  const auto whole = FilesBelow(shot.Output());
  WriteFile(shot.ResultPath("tracked", 0), "{\"lights\": [");
  WriteFile(shot.Output() + "/summaries/walk.0998.summary", "no summary");
  WriteFile(shot.Output() + "/per-shot.json", "");
  const ProcessResult result = shot.Run({"--quiet"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(whole == FilesBelow(shot.Output()));
}

}  // namespace
}  // namespace lightfit
