// `-` for standard input and output, and extensions of outputs.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/box_shot.h"
#include "tests/cli/command_line/shell.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

std::string Json(const std::string& script) {
  const ProcessResult result = RunShell(script);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.out;
}

TEST(Streams, AnyInputComesFromAPipe) {
  const std::string by_file = Json("\"$lightfit\" fit \"$yard\" --lights \"$lights\" -q --json -");
  EXPECT_THAT(by_file, StartsWith("{"));
  EXPECT_EQ(Json("cat \"$lights\" | \"$lightfit\" fit \"$yard\" --lights - -q --json -"), by_file);
  // The read-back: OpenEXR wants to seek.
  std::string by_pipe =
      Json("cat \"$yard\" | \"$lightfit\" fit - --lights \"$lights\" -q --json -");
  const size_t source = by_pipe.find("standard input");
  ASSERT_NE(source, std::string::npos);
  by_pipe.replace(source, std::string("standard input").size(), kYard);
  EXPECT_EQ(by_pipe, by_file);
}

TEST(Streams, ReadbacksGoFromVerbToVerb) {
  const ProcessResult result = RunShell(
      "set -o pipefail\n"
      "\"$lightfit\" render generate:objects=3,triangles=2000 --camera 0,1.7,18:0,0.5,0 "
      "--light sun=sun:0.3,-1,0.2 --size 40x40 -q -o - |\n"
      "\"$lightfit\" summarize - --light sun=sun:0.3,-1,0.2 -q -o - |\n"
      "\"$lightfit\" fit --summary - --json -");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, StartsWith("{"));
  EXPECT_THAT(result.out, HasSubstr("\"mapFromWorld\""));
  EXPECT_THAT(result.err, HasSubstr("standard input: 1 frame;"));
}

// The paths of a list are relative to the list; of one that is piped, to the current folder.
TEST(Streams, AShotIsAListOfPaths) {
  const BoxShot shot(2);
  const ProcessResult result =
      RunShell("cd '" + shot.Path("walk") + "' && ls *.exr | \"$lightfit\" shot - --lights '" +
               shot.LightsPath() + "' -q --per-frame -o '" + shot.Output() + "'");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(ReadResult(shot.ResultPath("per-frame", 1)).lights(0).status().code(), 0);
  // Without a folder of its own.
  const ProcessResult named =
      RunShell("cd '" + shot.Path("") + "' && ls walk/*.exr | \"$lightfit\" " +
               "shot - --lights lights.json -q --per-frame");
  EXPECT_EQ(named.exit_code, 0) << named.err;
  EXPECT_TRUE(std::filesystem::exists(shot.Path("shot_lightfit/shot.csv")));
}

TEST(Streams, MatricesComeFromAPipe) {
  const ProcessResult result = RunShell(
      "\"$lightfit\" fit \"$yard\" --lights \"$lights\" -q --json - |\n"
      "\"$lightfit\" compare \"$yard\" --lights \"$lights\" --only sun --matrix mine=-");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("mine"));
}

// Standard output is the file alone; the table is for people, on stderr.
TEST(Streams, TablesMakeRoomForAnOutput) {
  const ProcessResult result = RunLightfit({"fit", kYard, "--lights", kYardLights, "--json", "-"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, AllOf(StartsWith("{"), Not(HasSubstr("180 x 180 pixels"))));
  EXPECT_THAT(result.err, HasSubstr("180 x 180 pixels"));
  const ProcessResult picture =
      RunLightfit({"fit", kYard, "--lights", kYardLights, "--picture", "-", "-q"});
  EXPECT_THAT(picture.out, StartsWith("\x89PNG"));
  EXPECT_THAT(picture.err, IsEmpty());
}

TEST(Streams, EachIsThatOfOneOptionAlone) {
  const auto refuses = [](const std::vector<std::string>& words, const std::string& message) {
    const ProcessResult result = RunLightfit(words);
    EXPECT_EQ(result.exit_code, 1) << ::testing::PrintToString(words);
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_THAT(result.out, IsEmpty());
  };
  refuses({"fit", kYard, "--lights", kYardLights, "--json", "-", "--picture", "-"},
          "standard output is that of --json already");
  refuses({"fit", kYard, "--lights", "-", "--camera", "-"},
          "standard input is that of --lights already");
  refuses({"shot", kYard, "--lights", kYardLights, "-o", "-"}, "want the name of a folder");
  refuses({"tune", "generate", "--journal", "-"}, "want the name of a file");
}

TEST(Streams, AnEmptyNameIsNone) {
  for (const char* option : {"--json", "--picture", "--camera"}) {
    const ProcessResult result = RunLightfit({"fit", kYard, "--lights", kYardLights, option, ""});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, HasSubstr(std::string(option) + ": is empty, want the name of a file"));
  }
}

TEST(Streams, NothingStaysBehind) {
  const TemporaryFolder folder;
  const ProcessResult result = RunShell(
      "TMPDIR='" + folder.Path("") +
      "' \"$lightfit\" fit - --lights \"$lights\" -q --json - < \"$yard\"; " + "TMPDIR='" +
      folder.Path("") + "' \"$lightfit\" fit - --lights \"$lights\" --json - --foo < \"$yard\"");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(folder.Files(), IsEmpty());
}

// Errors name the stream, not the file that holds it meanwhile.
TEST(Streams, ErrorsCallThemByName) {
  const ProcessResult result =
      RunShell("echo nonsense | \"$lightfit\" fit \"$yard\" --lights - -q");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("standard input: "), Not(HasSubstr("/lightfit-"))));
  const ProcessResult full =
      RunShell("\"$lightfit\" fit \"$yard\" --lights \"$lights\" -q --json - > /dev/full");
  EXPECT_EQ(full.exit_code, 2);
  EXPECT_THAT(full.err, HasSubstr("--json -: standard output cannot be written"));
}

TEST(Extensions, AreObeyedOrRefusedByName) {
  const TemporaryFolder folder;
  const std::string out = folder.Path("out");
  const std::vector<std::string> fit = {"fit", kYard, "--lights", kYardLights, "-q"};
  const std::vector<std::string> render = {
      "render", "generate", "--camera", "0,1,9:0,0,0", "--light", "a=sun:0,-1,0.1", "-q"};
  struct Case {
    std::vector<std::string> verb;
    std::string option, extension, wanted;
  };
  for (const Case& wrong :
       {Case{fit, "--json", ".png", "writes JSON, want a name that ends in .json; --picture"},
        {fit, "--json", ".txt", ".json"},
        {fit, "--picture", ".jpg", "writes a PNG picture, want a name that ends in .png"},
        {fit, "--picture", ".exr", ".png"},
        {render, "-o", ".png", "writes an OpenEXR image, want a name that ends in .exr; --picture"},
        {render, "--output", ".txt", ".exr"},
        {render, "--lights-out", ".yaml", ".json"},
        {{"summarize", kYard, "--lights", kYardLights}, "-o", ".json", ".summary"},
        {{"compare", kYard, "--lights", kYardLights}, "--csv", ".xlsx", ".csv"},
        {{"allocate", kYard, "--lights", kYardLights, "--budget", "512x512"},
         "--json",
         ".csv",
         ".json"}}) {
    std::vector<std::string> words = wrong.verb;
    words.insert(words.end(), {wrong.option, out + wrong.extension});
    const ProcessResult result = RunLightfit(words);
    EXPECT_EQ(result.exit_code, 1) << ::testing::PrintToString(words);
    EXPECT_THAT(result.err, AllOf(HasSubstr(out + wrong.extension), HasSubstr(wrong.wanted)));
  }
  EXPECT_THAT(folder.Files(), IsEmpty());
  for (const std::string good : {".PNG", ".Png", ""}) {
    std::vector<std::string> words = fit;
    words.insert(words.end(), {"--picture", out + good});
    EXPECT_EQ(RunLightfit(words).exit_code, 0) << good;
    EXPECT_THAT(ReadFile(out + good), StartsWith("\x89PNG"));
  }
}

}  // namespace
}  // namespace lightfit
