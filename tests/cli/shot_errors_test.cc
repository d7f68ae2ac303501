// What `lightfit shot` says and returns when a frame, a light or the command line is wrong.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/cli/box_shot.h"
#include "tests/cli/examples.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

TEST(ShotErrors, ABadFrameIsNamedAndTheOthersGoOn) {
  const BoxShot shot(4);
  const std::string good = ReadFile(shot.FramePath(1));
  WriteFile(shot.FramePath(1), good.substr(0, good.size() / 2));
  for (int run = 0; run < 2; ++run) {  // it is tried again
    const ProcessResult result = shot.Run({"--quiet"});
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_THAT(result.err, AllOf(HasSubstr("frame walk.0999: "), Not(HasSubstr("walk.1000"))));
    for (const char* mode : {"per-frame", "tracked", "per-shot"}) {
      const v1::FitResult bad = ReadResult(shot.ResultPath(mode, 1));
      EXPECT_EQ(bad.shot().key(), "");
      EXPECT_NE(bad.lights(0).status().code(), 0);
      EXPECT_FALSE(bad.lights(0).has_map_from_world());
      const v1::FitResult next = ReadResult(shot.ResultPath(mode, 2));
      EXPECT_EQ(next.lights(0).status().code(), 0);
      EXPECT_FALSE(next.lights(0).shot().has_crawl());
    }
  }
  WriteFile(shot.FramePath(1), good);
  EXPECT_EQ(shot.Run({"--quiet"}).exit_code, 0);
  EXPECT_EQ(ReadResult(shot.ResultPath("tracked", 1)).lights(0).status().code(), 0);
}

TEST(ShotErrors, ALightWithoutAChannelInOneFrameFailsThereAlone) {
  const BoxShot shot(4);
  const std::string name = shot.lights()[1].name;
  shot.Write(2, {shot.lights()[0]});
  const ProcessResult result = shot.Run({"--quiet"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("light \"" + name + "\""),
                    HasSubstr("frame walk.1000"),
                    HasSubstr("shadow." + name),
                    Not(HasSubstr("light \"" + shot.lights()[0].name))));
  for (int frame = 0; frame < 4; ++frame) {
    const v1::FitResult fit = ReadResult(shot.ResultPath("tracked", frame));
    EXPECT_EQ(fit.lights(0).status().code(), 0);
    EXPECT_EQ(fit.lights(1).status().code() == 0, frame != 2);
  }
}

TEST(ShotErrors, MistakesAreNamedWithTheWayOut) {
  const BoxShot shot(1);
  const auto expect_error = [](const ProcessResult& result, int code, const std::string& words) {
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_THAT(result.err, HasSubstr(words));
    EXPECT_THAT(result.out, IsEmpty());
  };
  std::filesystem::create_directory(shot.Path("empty"));
  const std::vector<std::string> lights = {"--lights", shot.LightsPath()};
  const auto run = [&](const std::string& input) {
    return RunLightfit({"shot", input, lights[0], lights[1], "-o", shot.Output()});
  };
  expect_error(run(shot.Path("empty")), 2, "there is no .exr file in this folder");
  expect_error(run(shot.Path("none.txt")), 2, "no such file");
  WriteFile(shot.Path("bad.txt"), "walk/readme.md\n");
  expect_error(run(shot.Path("bad.txt")), 2, "want the path of one .exr file per line");
  WriteFile(shot.Path("comments.txt"), "# nothing\n");
  expect_error(run(shot.Path("comments.txt")), 2, "the list is empty");
  // A read-back whose header has no lights either.
  expect_error(RunLightfit({"shot", kYard, "-o", shot.Output()}), 2, "--lights");
  const std::string below_a_file = shot.LightsPath() + "/out";
  expect_error(
      RunLightfit({"shot", shot.Path("walk"), lights[0], lights[1], "--output", below_a_file}),
      2,
      "choose another with --output");
  expect_error(shot.Run({"--camera", "/no/camera.json"}), 2, "/no/camera.json");
  expect_error(shot.Run({"--stability", "2"}), 1, "--stability");
  expect_error(shot.Run({"--update-every", "0"}), 1, "--update-every");
}

}  // namespace
}  // namespace lightfit
