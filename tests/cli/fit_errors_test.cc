// What `lightfit` says and returns when the command line or a file is wrong.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/examples.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

// Runs `lightfit fit` on good files with `more` arguments.
ProcessResult FitYard(std::vector<std::string> more) {
  std::vector<std::string> arguments = {"fit", kYard, "--lights", kYardLights};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return RunLightfit(arguments);
}

// An error is one line that starts with the program's name, and nothing goes to stdout.
void ExpectError(const ProcessResult& result, int exit_code, const std::string& words) {
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  EXPECT_THAT(result.err, AllOf(StartsWith("lightfit: error: "), HasSubstr(words)));
  EXPECT_THAT(result.out, IsEmpty());
}

TEST(CommandLine, HelpAndVersionSucceed) {
  const ProcessResult help = RunLightfit({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, AllOf(HasSubstr("fit"), HasSubstr("Exit codes")));
  const ProcessResult fit_help = RunLightfit({"fit", "--help"});
  EXPECT_EQ(fit_help.exit_code, 0);
  EXPECT_THAT(fit_help.out, AllOf(HasSubstr("--map"), HasSubstr("texels"), HasSubstr("Examples")));
  const ProcessResult version = RunLightfit({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_THAT(version.out, StartsWith("lightfit 0."));
}

TEST(CommandLine, WrongUsageIsExitCodeOne) {
  ExpectError(RunLightfit({}), 1, "");
  ExpectError(RunLightfit({"fti"}), 1, "");
  ExpectError(RunLightfit({"fit"}), 1, "read-back");
  ExpectError(FitYard({"--no-such-option"}), 1, "--no-such-option");
  ExpectError(FitYard({"--map"}), 1, "--map");
  ExpectError(FitYard({"--margin-percent", "-1"}), 1, "--margin-percent");
  ExpectError(FitYard({"--margin-percent", "nan"}),
              1,
              "--margin-percent: \"nan\", want a number from 0 to 100");
  ExpectError(FitYard({"--as-published", "--search", "line"}), 1, "--as-published");
}

TEST(CommandLine, RefusesMapsThatAreNoSize) {
  for (const char* map : {"foo", "0x10", "-4x4", "10x", "10x10x10", "1e3x10", "99999x10"}) {
    SCOPED_TRACE(map);
    ExpectError(FitYard({"--map", map}), 1, map);
  }
}

TEST(CommandLine, SuggestsTheWordThatWasMeant) {
  ExpectError(FitYard({"--search", "globl"}), 1, "did you mean \"global\"?");
  ExpectError(FitYard({"--only", "sum"}), 2, "did you mean \"sun\"?");
}

TEST(CommandLine, RefusesLightsWithoutADirection) {
  ExpectError(FitYard({"--light", "sun=sun:0,0,0"}), 1, "direction");
  ExpectError(FitYard({"--light", "sun"}), 1, "--light");
  ExpectError(FitYard({"--light", "sun=point:1,2"}), 1, "--light");
  ExpectError(FitYard({"--light", "sun=point:1,2,nan"}), 1, "--light");
}

TEST(Inputs, AFitNeedsLights) { ExpectError(RunLightfit({"fit", kYard}), 2, "--lights"); }

TEST(Inputs, MissingFilesAreNamed) {
  ExpectError(
      RunLightfit({"fit", "/no/such/file.exr", "--lights", kYardLights}), 2, "/no/such/file.exr");
  ExpectError(RunLightfit({"fit", kYard, "--lights", "/no/lights.json"}), 2, "/no/lights.json");
  ExpectError(FitYard({"--camera", "/no/camera.json"}), 2, "/no/camera.json");
}

TEST(Inputs, DamagedReadBacksAreRefused) {
  const TemporaryFolder folder;
  const std::string whole = ReadFile(kYard);
  ASSERT_GT(whole.size(), 10000u);
  const std::pair<const char*, std::string> files[] = {
      {"empty.exr", ""},
      {"text.exr", "this is no image\n"},
      {"header_only.exr", whole.substr(0, 600)},
      {"half.exr", whole.substr(0, whole.size() / 2)}};
  for (const auto& [name, bytes] : files) {
    SCOPED_TRACE(name);
    WriteFile(folder.Path(name), bytes);
    ExpectError(RunLightfit({"fit", folder.Path(name), "--lights", kYardLights}), 2, name);
  }
}

TEST(Inputs, DamagedLightsFilesAreRefused) {
  const TemporaryFolder folder;
  const std::pair<const char*, const char*> files[] = {
      {"broken.json", "{\"lights\": ["},
      {"none.json", "{\"lights\": []}"},
      {"zero.json", "{\"lights\": [{\"name\": \"sun\", \"direction\": [0, 0, 0]}]}"}};
  for (const auto& [name, text] : files) {
    SCOPED_TRACE(name);
    WriteFile(folder.Path(name), text);
    ExpectError(RunLightfit({"fit", kYard, "--lights", folder.Path(name)}), 2, "");
  }
}

TEST(Inputs, MisspeltChannelsAreAnsweredWithThoseThereAre) {
  ExpectError(FitYard({"--depth-channel", "Depth"}), 2, "Z");
}

TEST(Outputs, UnusablePathsAreRefusedBeforeTheFit) {
  const TemporaryFolder folder;
  ExpectError(FitYard({"--json", "/no/such/folder/out.json"}), 2, "/no/such/folder");
  ExpectError(FitYard({"--picture", folder.Path("")}), 2, "folder");
  ExpectError(FitYard({"--json", "/dev/null"}), 2, "device");
  EXPECT_THAT(folder.Files(), IsEmpty());
}

// An output that is already there survives a run that fails.
TEST(Outputs, AnOldFileSurvivesAFailedRun) {
  const TemporaryFolder folder;
  const std::string json = folder.Path("out.json");
  WriteFile(json, "old");
  EXPECT_EQ(RunLightfit({"fit", "/no/such.exr", "--lights", kYardLights, "--json", json}).exit_code,
            2);
  EXPECT_EQ(ReadFile(json), "old");
}

}  // namespace
}  // namespace lightfit
