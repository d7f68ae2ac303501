// `lightfit tune` from end to end, on a small scene.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "tests/cli/examples.h"
#include "tests/jobs/compare/compare_scene.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

// A folder with scene.obj in it.
class TuneTest : public ::testing::Test {
 protected:
  TuneTest() { WriteFile(folder_.Path("scene.obj"), ToObj(BoxesOnFloor())); }

  ProcessResult Tune(std::vector<std::string> more) const {
    std::vector<std::string> arguments = {"tune",
                                          folder_.Path("scene.obj"),
                                          "--camera",
                                          kBoxesCamera,
                                          "--screen",
                                          "160x120",
                                          "--map",
                                          "24x24"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunLightfit(arguments);
  }

  // Two lights into NAME.json.
  ProcessResult TuneTwo(const std::string& name, const std::string& evaluations = "60") const {
    return Tune({"--light",
                 "sun=sun:-1,-1.3,0.4",
                 "--light",
                 "lamp=point:4,9,6",
                 "--evaluations",
                 evaluations,
                 "--json",
                 folder_.Path(name + ".json")});
  }

  const TemporaryFolder folder_;
};

void ExpectError(const ProcessResult& result, int exit_code, const std::string& words) {
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  EXPECT_THAT(result.err, AllOf(StartsWith("lightfit: error: "), HasSubstr(words)));
  EXPECT_THAT(result.out, IsEmpty());
}

TEST_F(TuneTest, FindsFewerWrongPixelsAndWritesWhatFitWrites) {
  const ProcessResult result = TuneTwo("out");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, IsEmpty());
  EXPECT_THAT(result.out, AllOf(HasSubstr("fit / limit"), HasSubstr("Fit over limit, 2 lights")));
  EXPECT_THAT(folder_.Files(), ElementsAre("out.json", "out.json.journal", "scene.obj"));
  const v1::FitResult tuned = ReadResult(folder_.Path("out.json"));
  ASSERT_EQ(tuned.lights_size(), 2);
  int64_t sum = 0, fit_sum = 0;
  for (const v1::LightResult& light : tuned.lights()) {
    SCOPED_TRACE(light.name());
    EXPECT_EQ(light.status().code(), 0) << light.status().message();
    sum += light.tuning().wrong() + light.tuning().check();
    fit_sum += light.tuning().fit_wrong() + light.tuning().fit_check();
    EXPECT_TRUE(light.has_clip_from_world());
    EXPECT_TRUE(MatrixOf(light.map_from_world()).allFinite());
    EXPECT_EQ(light.map().width(), 24);
    EXPECT_LE(light.tuning().wrong(), light.tuning().fit_wrong());
    EXPECT_EQ(light.tuning().evaluations(), 60);
    // The table shows the same counts.
    EXPECT_THAT(result.out, HasSubstr(absl::StrCat(light.tuning().wrong())));
  }
  EXPECT_LT(sum, fit_sum);
}

// `lightfit compare` counts the same pixels of the fit and of the tuned matrix.
TEST_F(TuneTest, CompareCountsTheSame) {
  const ProcessResult result = TuneTwo("out");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const ProcessResult compare = RunLightfit({"compare",
                                             folder_.Path("scene.obj"),
                                             "--camera",
                                             kBoxesCamera,
                                             "--screen",
                                             "160x120",
                                             "--map",
                                             "24x24",
                                             "--light",
                                             "sun=sun:-1,-1.3,0.4",
                                             "--light",
                                             "lamp=point:4,9,6",
                                             "--phases",
                                             "4",
                                             "--matrix",
                                             "tuned=" + folder_.Path("out.json"),
                                             "--csv",
                                             folder_.Path("out.csv")});
  ASSERT_EQ(compare.exit_code, 0) << compare.err;
  const v1::FitResult tuned = ReadResult(folder_.Path("out.json"));
  int num_found = 0;
  for (const absl::string_view line : absl::StrSplit(ReadFile(folder_.Path("out.csv")), '\n')) {
    for (const v1::LightResult& light : tuned.lights()) {
      if (!absl::StartsWith(line, light.name() + ",")) continue;
      const v1::Tuning& tuning = light.tuning();
      if (absl::StrContains(line, ",tuned,")) {
        ++num_found;
        EXPECT_TRUE(absl::StrContains(line, absl::StrCat(",ok,", tuning.wrong(), ","))) << line;
      } else if (absl::StrContains(line, ",lightfit,")) {
        ++num_found;
        EXPECT_TRUE(absl::StrContains(line, absl::StrCat(",ok,", tuning.fit_wrong(), ","))) << line;
      }
    }
  }
  EXPECT_EQ(num_found, 4);
}

// As a run leaves it that was killed: in the middle of a line, of a light, before anything.
TEST_F(TuneTest, AStoppedRunGoesOnToTheSameBytes) {
  ASSERT_EQ(TuneTwo("out").exit_code, 0);
  const std::string json = ReadFile(folder_.Path("out.json"));
  const std::string journal = ReadFile(folder_.Path("out.json.journal"));
  for (const double share : {0.0, 0.01, 0.3, 0.71, 1.0}) {
    SCOPED_TRACE(share);
    const auto size = static_cast<size_t>(share * static_cast<double>(journal.size()));
    WriteFile(folder_.Path("again.json.journal"), journal.substr(0, size));
    const ProcessResult result = TuneTwo("again");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(ReadFile(folder_.Path("again.json")), json);
    EXPECT_EQ(ReadFile(folder_.Path("again.json.journal")), journal);
  }
}

TEST_F(TuneTest, MoreEvaluationsGoOnWhereFewerEnded) {
  ASSERT_EQ(TuneTwo("all", "50").exit_code, 0);
  ASSERT_EQ(TuneTwo("more", "20").exit_code, 0);
  ASSERT_EQ(TuneTwo("more", "50").exit_code, 0);
  EXPECT_EQ(ReadFile(folder_.Path("all.json")), ReadFile(folder_.Path("more.json")));
}

TEST_F(TuneTest, AJournalOfSomethingElseIsRefused) {
  const std::string journal = folder_.Path("a.journal");
  const auto tune = [&](const std::string& light, const std::string& flag, const char* value) {
    return Tune(
        {"--light", light, "--evaluations", "3", "--journal", journal, "--quiet", flag, value});
  };
  const std::string sun = "sun=sun:-1,-1.3,0.4";
  ASSERT_EQ(tune(sun, "--seed", "1").exit_code, 0);
  const std::string text = ReadFile(journal);
  ExpectError(
      tune("sun=sun:-1,-1.3,0.5", "--seed", "1"), 2, "a.journal: is the journal of another");
  ExpectError(tune(sun, "--seed", "2"), 2, "another --journal");
  ExpectError(tune(sun, "--bias", "practical"), 2, "another --journal");
  ExpectError(tune(sun, "--metric", "l2"), 2, "another --journal");
  WriteFile(folder_.Path("scene.obj"),
            absl::StrCat(ToObj(BoxesOnFloor()), "v 9 1 9\nv 9 1 8\nv 8 1 9\nf -1 -2 -3\n"));
  ExpectError(tune(sun, "--seed", "1"), 2, "another --journal");
  EXPECT_EQ(ReadFile(journal), text);
}

// Receivers surround a lamp inside a box.
TEST_F(TuneTest, LightsWithoutAMatrixAreNamed) {
  const ProcessResult result = Tune({"--light",
                                     "boxed=point:-2.5,1,2.5",
                                     "--light",
                                     "sun=sun:-1,-1.3,0.4",
                                     "--evaluations",
                                     "5",
                                     "--json",
                                     folder_.Path("out.json")});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("no matrix for light \"boxed\""));
  EXPECT_THAT(result.out, HasSubstr("no matrix, see below"));
  const v1::FitResult tuned = ReadResult(folder_.Path("out.json"));
  ASSERT_EQ(tuned.lights_size(), 2);
  EXPECT_NE(tuned.lights(0).status().code(), 0);
  EXPECT_EQ(tuned.lights(1).status().code(), 0);
}

TEST_F(TuneTest, QuietSaysNothing) {
  const ProcessResult result =
      Tune({"--light", "sun=sun:-1,-1.3,0.4", "--evaluations", "2", "--quiet"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out + result.err, IsEmpty());
  EXPECT_THAT(folder_.Files(), ElementsAre("scene.obj"));
}

TEST_F(TuneTest, HelpHasUnitsAndExamples) {
  const ProcessResult result = RunLightfit({"tune", "--help"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("--evaluations"),
                    HasSubstr("--journal"),
                    HasSubstr("texels [1024x1024]"),
                    HasSubstr("Of the random lights and of the search"),
                    HasSubstr("Examples"),
                    HasSubstr("--metric")));
}

TEST_F(TuneTest, WrongUsageAndUnusableInputsAreNamed) {
  const std::string sun = "sun=sun:-1,-1.3,0.4";
  ExpectError(RunLightfit({"tune"}), 1, "");
  ExpectError(Tune({"--light", sun, "--evaluations", "0"}), 1, "--evaluations");
  ExpectError(Tune({"--light", sun, "--bias", "none"}), 1, "--bias");
  ExpectError(Tune({}), 2, "no lights");
  ExpectError(RunLightfit({"tune", kYard, "--light", sun}), 2, "want a scene");
  ExpectError(Tune({"--light", sun, "--json", "/no/out.json"}), 2, "/no");
  ExpectError(Tune({"--light", sun, "--journal", "/no/out.journal"}), 2, "/no");
}

}  // namespace
}  // namespace lightfit
