// What the program answers to what people type: verbs and options nearly right, help in every form,
// files where verbs should be.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/box_shot.h"
#include "tests/cli/examples.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

void ExpectUsage(const std::vector<std::string>& words, const std::string& message) {
  const ProcessResult result = RunLightfit(words);
  EXPECT_EQ(result.exit_code, 1) << ::testing::PrintToString(words);
  EXPECT_THAT(result.err, AllOf(StartsWith("lightfit: error: "), HasSubstr(message)));
  EXPECT_THAT(result.out, IsEmpty());
}

TEST(Usage, AVerbThatThereIsNotIsAnsweredWithTheOneThatWasMeant) {
  for (const auto& [typed, meant] : {std::pair{"fti", "fit"},
                                     {"Fit", "fit"},
                                     {"summarise", "summarize"},
                                     {"compar", "compare"},
                                     {"rander", "render"},
                                     {"serv", "serve"},
                                     {"shoot", "shot"},
                                     {"alloc", "allocate"},
                                     {"tunes", "tune"}}) {
    const std::string hint = std::string("did you mean \"") + meant + "\"";
    ExpectUsage({typed}, hint);
    ExpectUsage({typed, kYard, "--lights", kYardLights}, hint);
    ExpectUsage({typed, "--help"}, hint);
    ExpectUsage({"help", typed}, hint);
  }
  ExpectUsage({}, "want a verb: one of allocate, compare, fit, ");
  ExpectUsage({"frobnicate"}, "there is no verb \"frobnicate\", want one of allocate, ");
}

TEST(Usage, AllOptionsThatThereAreNotAreNamedAtOnce) {
  ExpectUsage({"fit", kYard, "--lihgts", kYardLights, "--zzz", "--cilp=vulkan"},
              "lightfit fit has no options --lihgts (did you mean --lights?), --zzz, --cilp (did "
              "you mean --clip?)");
  for (const auto& [typed, meant] : {std::pair{"--margin_percent", "--margin-percent"},
                                     {"--MAP", "--map"},
                                     {"-map", "--map"},
                                     {"--pic", "--picture"},
                                     {"--channel", "--depth-channel"},
                                     {"--near-clip", "--near"},
                                     {"--output", "--json"},
                                     {"-o", "--json"},
                                     {"--silent", "--quiet"},
                                     {"-quiet", "--quiet"}}) {
    ExpectUsage({"fit", kYard, "--lights", kYardLights, typed},
                std::string("(did you mean ") + meant);
  }
}

// The option is at fault, not what it leaves behind: its value, or what is required.
TEST(Usage, AnUnknownOptionComesBeforeWhatFollowsFromIt) {
  ExpectUsage({"shot", "--frames", "walk"}, "lightfit shot has no option --frames");
  ExpectUsage({"summarize", "--outptu", "x.summary", kYard}, "--outptu (did you mean --output?)");
  ExpectUsage({"render", "--camrea", "0,1,5:0,0,0"}, "--camrea (did you mean --camera?)");
}

TEST(Usage, HelpHasEveryForm) {
  const std::string fit = RunLightfit({"fit", "--help"}).out;
  EXPECT_THAT(fit, HasSubstr("--map"));
  EXPECT_EQ(RunLightfit({"fit", "-h"}).out, fit);
  EXPECT_EQ(RunLightfit({"help", "fit"}).out, fit);
  const ProcessResult all = RunLightfit({"help"});
  EXPECT_EQ(all.exit_code, 0);
  EXPECT_EQ(all.out, RunLightfit({"--help"}).out);
  const std::string version = RunLightfit({"--version"}).out;
  EXPECT_THAT(version, StartsWith("lightfit 0."));
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"-V"}, {"version"}, {"fit", "-V"}, {"shot", "--version"}}) {
    const ProcessResult result = RunLightfit(words);
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.out, version);
  }
}

TEST(Usage, QuietAndVerboseAreShortAndMayComeFirst) {
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"fit", kYard, "--lights", kYardLights, "-q"},
                                             {"-q", "fit", kYard, "--lights", kYardLights},
                                             {"--quiet", "fit", kYard, "--lights", kYardLights}}) {
    const ProcessResult quiet = RunLightfit(words);
    EXPECT_EQ(quiet.exit_code, 0) << quiet.err;
    EXPECT_THAT(quiet.out + quiet.err, IsEmpty());
  }
  const ProcessResult verbose = RunLightfit({"fit", kYard, "--lights", kYardLights, "-v"});
  EXPECT_EQ(verbose.exit_code, 0);
  EXPECT_THAT(verbose.err,
              AllOf(HasSubstr("lightfit: read " + kYard + " (depth \"Z\""),
                    HasSubstr("lightfit: light \"sun\": its shadows are there"),
                    HasSubstr("lightfit: fitting sun: 0."),
                    HasSubstr("lightfit: sun, start: "),
                    HasSubstr("lightfit: sun, search: ")));
  EXPECT_THAT(RunLightfit({"fit", kYard, "--lights", kYardLights}).err, IsEmpty());
}

TEST(Usage, AFileInPlaceOfAVerbIsAnsweredWithTheVerb) {
  ExpectUsage({kYard, "--lights", kYardLights}, "Say a verb first: lightfit fit " + kYard);
  const TemporaryFolder folder;
  ExpectUsage({folder.Path("")}, "lightfit shot " + folder.Path(""));
  ExpectUsage({"walk.summary"}, "lightfit fit --summary walk.summary");
  ExpectUsage({"scene.glb"}, "lightfit compare scene.glb");
}

TEST(Usage, SeveralReadbacksAFolderOrASummaryAreAnsweredWithTheVerbForThem) {
  ExpectUsage({"fit", kYard, kRoom, "--lights", kYardLights},
              "\"" + kRoom + "\": lightfit fit takes one READBACK.exr, and has " + kYard);
  ExpectUsage({"fit", kYard, kRoom, "--lights", kYardLights}, "lightfit shot");
  ExpectUsage({"allocate", kYard, kRoom}, "lightfit allocate --summary");
  const TemporaryFolder folder;
  for (const std::string verb : {"fit", "allocate"}) {
    ExpectUsage({verb, folder.Path(""), "--lights", kYardLights},
                "is a folder: for all its frames lightfit shot " + folder.Path(""));
  }
  const std::string summary = folder.Path("yard.summary");
  ASSERT_EQ(
      RunLightfit({"summarize", kYard, "--lights", kYardLights, "-q", "-o", summary}).exit_code, 0);
  ExpectUsage({"fit", summary}, "is a summary: lightfit fit --summary " + summary);
  ExpectUsage({"shot", summary, "--lights", kYardLights}, "lightfit fit --summary");
}

TEST(Usage, WhatIsMissingIsNamedAllAtOnce) {
  ExpectUsage({"summarize"}, "READBACK.exr|FILE.summary and --output FILE.summary");
  ExpectUsage({"shot"}, "lightfit shot wants FOLDER|LIST|PATTERN|READBACK.exr");
  for (const std::string verb : {"render", "compare", "tune"}) {
    const ProcessResult result = RunLightfit({verb, "generate"});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err,
                AllOf(HasSubstr("no camera: want --camera EYE:TARGET"),
                      HasSubstr("no lights: want --lights FILE")));
    EXPECT_THAT(result.err.find("nothing to write: want -o FILE.exr") != std::string::npos,
                verb == "render");
  }
}

TEST(Usage, OnlySomeLightsOfASceneAreCompared) {
  const std::vector<std::string> words = {"compare",
                                          "generate:objects=2,triangles=2000",
                                          "--camera",
                                          "0,1.7,18:0,0.5,0",
                                          "--light",
                                          "a=sun:0.2,-1,0.1",
                                          "--light",
                                          "b=sun:-0.6,-1,0.3",
                                          "--screen",
                                          "60x60",
                                          "--map",
                                          "64",
                                          "--phases",
                                          "1",
                                          "--csv",
                                          "-",
                                          "-q"};
  std::vector<std::string> only = words;
  only.insert(only.end(), {"--only", "b"});
  const ProcessResult result = RunLightfit(only);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("\nb,sun,"), Not(HasSubstr("\na,sun,"))));
  only.back() = "bb";
  EXPECT_THAT(RunLightfit(only).err, HasSubstr("--only bb: there is no such light"));
  // Of a read-back as well.
  const ProcessResult readback =
      RunLightfit({"compare", kYard, "--lights", kYardLights, "--only", "sun", "--csv", "-", "-q"});
  EXPECT_EQ(readback.exit_code, 0) << readback.err;
  EXPECT_THAT(readback.out, AllOf(HasSubstr("\nsun,"), Not(HasSubstr("\nkey,"))));
}

TEST(Usage, AsPublishedAShotHasTheModesThatAreDefined) {
  const BoxShot shot(3);
  const ProcessResult result = shot.Run({"--as-published"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("--as-published: per-frame and tracked only"), Not(HasSubstr("_"))));
  EXPECT_THAT(result.out, Not(HasSubstr("per-shot")));
  EXPECT_TRUE(std::filesystem::exists(shot.ResultPath("tracked", 2)));
  EXPECT_FALSE(std::filesystem::exists(shot.ResultPath("per-shot", 2)));
  EXPECT_THAT(shot.Run({"--as-published", "--tracked", "-q"}).err, IsEmpty());
  const ProcessResult both = shot.Run({"--as-published", "--per-shot"});
  EXPECT_EQ(both.exit_code, 1);
  EXPECT_THAT(both.err, HasSubstr("--as-published: does not go with --per-shot"));
}

// Some lights: 3, and the rest is done. None: 2.
TEST(ExitCode, TellsNothingFromSome) {
  const std::vector<std::string> lamp = {"--light", "lamp=point:1,2,3"};
  const auto run = [&](const std::vector<std::string>& start, bool with_others) {
    std::vector<std::string> words = start;
    words.insert(words.end(), lamp.begin(), lamp.end());
    if (with_others) words.insert(words.end(), {"--lights", kYardLights});
    words.emplace_back("-q");
    return RunLightfit(words).exit_code;
  };
  const TemporaryFolder folder;
  for (const std::vector<std::string>& start :
       {std::vector<std::string>{"fit", kYard},
        {"fit", kYard, "--maps", "2"},
        {"compare", kYard},
        {"allocate", kYard, "--budget", "512x512"},
        {"allocate", kYard, "--tolerance", "rms:2"},
        {"summarize", kYard, "-o", folder.Path("out.summary")},
        {"shot", kYard, "-o", folder.Path("out")}}) {
    EXPECT_EQ(run(start, false), 2) << ::testing::PrintToString(start);
    EXPECT_EQ(run(start, true), 3) << ::testing::PrintToString(start);
  }
  // A map that misses its tolerance is a map.
  EXPECT_EQ(RunLightfit({"allocate",
                         kYard,
                         "--lights",
                         kYardLights,
                         "--tolerance",
                         "rms:0.01",
                         "--max-side",
                         "512"})
                .exit_code,
            3);
}

}  // namespace
}  // namespace lightfit
