// `lightfit summarize` and `lightfit fit --summary` end to end: frames summed on a farm.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <random>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "io/lights_file.h"
#include "io/readback_exr.h"
#include "io/summary_file.h"
#include "optimizer/fit.h"
#include "tests/cli/examples.h"
#include "tests/cli/summaries.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

constexpr uint32_t kSeed = 20240611;
constexpr double kSearchTolerance = 1e-5;  // of energies, where the search is let end

TEST(Summarize, SaysWhatIsInTheFile) {
  const TemporaryFolder folder;
  const std::string path = folder.Path("yard.summary");
  const ProcessResult result =
      RunLightfit({"summarize", kYard, "--lights", kYardLights, "-o", path});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, IsEmpty());
  for (const char* words : {"key: ", "rim: ", "sun: ", " samples of 1 frame, ", " kB\n"}) {
    EXPECT_THAT(result.out, HasSubstr(words));
  }
  EXPECT_THAT(folder.Files(), ElementsAre("yard.summary"));
  const absl::StatusOr<SummarySet> set = ReadSummaryFile(path);
  ASSERT_TRUE(set.ok()) << set.status();
  ASSERT_EQ(set->lights.size(), 3u);
  EXPECT_THAT(result.out,
              HasSubstr(absl::StrCat("sun: ", set->lights[2].total.counts.used, " samples")));
  const ProcessResult quiet =
      RunLightfit({"summarize", kYard, "--lights", kYardLights, "-o", path, "--quiet"});
  EXPECT_EQ(quiet.exit_code, 0);
  EXPECT_THAT(quiet.out, IsEmpty());
}

// One map per light from the summary of one frame is that frame's, but for the rounds of
// reweighting; with squares there are none.
TEST(Summarize, FitOfOneFrameIsThatOfItsReadBack) {
  const TemporaryFolder folder;
  const Arguments l2 = {"--metric", "l2"};
  const std::string summary = YardSummary(folder, "yard.summary", l2);
  const std::string direct = folder.Path("direct.json"), from_sum = folder.Path("sum.json");
  EXPECT_EQ(
      RunLightfit(Joined({"fit", kYard, "--lights", kYardLights, "--json", direct}, l2)).exit_code,
      0);
  const ProcessResult fit = RunLightfit({"fit", "--summary", summary, "--json", from_sum});
  EXPECT_EQ(fit.exit_code, 0) << fit.err;
  EXPECT_THAT(fit.out, AllOf(HasSubstr("1 frames"), HasSubstr("need a read-back")));
  v1::FitResult expected = ReadResult(direct), result = ReadResult(from_sum);
  ASSERT_EQ(result.lights_size(), 3);
  EXPECT_EQ(result.readback().source(), summary);
  EXPECT_FALSE(result.readback().has_camera());
  for (const v1::LightResult& light : result.lights()) {
    const auto same = std::find_if(
        expected.lights().begin(), expected.lights().end(), [&light](const v1::LightResult& other) {
          return other.name() == light.name();
        });
    ASSERT_NE(same, expected.lights().end());
    // A sum through light space is the same to rounding; in a crease the search then stops a little
    // elsewhere, found: 3e-6.
    EXPECT_NEAR(light.energies().final() / same->energies().final(), 1.0, kSearchTolerance);
    EXPECT_NEAR(light.footprint().rms() / same->footprint().rms(), 1.0, kSearchTolerance);
    EXPECT_EQ(light.samples().used(), same->samples().used());
    EXPECT_FALSE(light.footprint().has_p99());
    EXPECT_FALSE(light.has_foretold_wrong());
  }
}

TEST(Summarize, OnlyKeepsTheNamedLightsOfReadBacksAndSummaries) {
  const TemporaryFolder folder;
  const std::string all = YardSummary(folder, "all.summary");
  const std::string direct = YardSummary(folder, "direct.summary", {"--only", "rim"});
  const std::string kept = folder.Path("kept.summary");
  RunSummarize({all, "--only", "rim", "-o", kept});
  EXPECT_FALSE(ReadFile(direct).empty());
  EXPECT_TRUE(ReadFile(kept) == ReadFile(direct));
  const std::string json = folder.Path("out.json");
  EXPECT_EQ(RunLightfit({"fit", "--summary", all, "--only", "sun", "--json", json}).exit_code, 0);
  ASSERT_EQ(ReadResult(json).lights_size(), 1);
  EXPECT_EQ(ReadResult(json).lights(0).name(), "sun");
  ExpectError(
      RunLightfit({"fit", "--summary", all, "--only", "sum"}), 2, {"did you mean \"sun\"?"});
}

TEST(Summarize, AddsInPlace) {
  const TemporaryFolder folder;
  const std::string sum = YardSummary(folder, "sum.summary");
  RunSummarize({sum, kYard, "--lights", kYardLights, "-o", sum});
  const absl::StatusOr<SummarySet> set = ReadSummaryFile(sum);
  ASSERT_TRUE(set.ok()) << set.status();
  EXPECT_EQ(set->lights[0].num_frames(), 2);
  EXPECT_THAT(folder.Files(), ElementsAre("sum.summary"));
}

TEST(Summarize, OneBadFrameIsReportedAndTheRestGoOn) {
  const TemporaryFolder folder;
  const std::string bad = folder.Path("bad.exr"), cut = folder.Path("cut.summary");
  const std::string sum = folder.Path("sum.summary");
  WriteFile(bad, ReadFile(kYard).substr(0, 1000));
  WriteFile(cut, ReadFile(YardSummary(folder, "good.summary")).substr(0, 1000));
  const ProcessResult result =
      RunLightfit({"summarize", bad, kYard, cut, "--lights", kYardLights, "-o", sum});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, AllOf(HasSubstr("bad.exr"), HasSubstr("cut.summary")));
  EXPECT_TRUE(ReadFile(sum) == ReadFile(folder.Path("good.summary")));
  // Nothing is left to write.
  std::filesystem::remove(sum);
  const ProcessResult none =
      RunLightfit({"summarize", bad, cut, "--lights", kYardLights, "-o", sum});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(sum));
  // A sum that lacks a part is no sum.
  ExpectError(
      RunLightfit({"fit", "--summary", folder.Path("good.summary"), cut}), 2, {"cut.summary"});
}

TEST(Summarize, ALightThatAFrameHasNothingOfStopsNoOther) {
  const TemporaryFolder folder;
  const std::string one = folder.Path("one.summary"), two = folder.Path("two.summary");
  const Arguments lights = {"--lights", kYardLights, "--light", "lamp=point:1,2,3"};
  const ProcessResult first = RunLightfit(Joined({"summarize", kYard, "-o", one}, lights));
  EXPECT_EQ(first.exit_code, 3);
  EXPECT_THAT(first.err,
              AllOf(HasSubstr("light \"lamp\": nothing of it in 1 of 1 frames, such as 0001.exr: "),
                    HasSubstr("shadow.lamp"),
                    Not(HasSubstr("light \"sun\""))));
  EXPECT_THAT(first.out, HasSubstr("lamp: 0 samples of 0 frames"));
  // It was reported then; the sum says so again and is complete.
  const ProcessResult second = RunLightfit({"summarize", one, one, "-o", two});
  EXPECT_EQ(second.exit_code, 0) << second.err;
  EXPECT_THAT(second.err, StartsWith("lightfit: warning: light \"lamp\": nothing of it in 2 of 2"));
  const std::string json = folder.Path("out.json");
  const ProcessResult fit = RunLightfit({"fit", "--summary", two, "--json", json});
  EXPECT_EQ(fit.exit_code, 3);
  EXPECT_THAT(fit.err, HasSubstr("no matrix for light \"lamp\""));
  EXPECT_THAT(fit.out, HasSubstr("no matrix, see below"));
  int num_matrices = 0;
  const v1::FitResult result = ReadResult(json);
  for (const v1::LightResult& light : result.lights()) {
    EXPECT_EQ(light.has_map_from_world(), light.name() != "lamp");
    num_matrices += light.has_map_from_world() ? 1 : 0;
  }
  EXPECT_EQ(num_matrices, 3);
}

TEST(Summarize, ALightWithoutAMapToWeighByFailsAlone) {
  const TemporaryFolder folder;
  const std::string json = folder.Path("sun.json"), sum = folder.Path("sum.summary");
  const std::string plain = YardSummary(folder, "plain.summary");
  ASSERT_EQ(RunLightfit({"fit", "--summary", plain, "--only", "sun", "--json", json}).exit_code, 0);
  const ProcessResult result =
      RunLightfit({"summarize", kYard, "--lights", kYardLights, "--weigh-by", json, "-o", sum});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("light \"rim\""), HasSubstr("--only"), Not(HasSubstr("\"sun\""))));
  const absl::StatusOr<SummarySet> set = ReadSummaryFile(sum);
  ASSERT_TRUE(set.ok()) << set.status();
  EXPECT_TRUE(set->lights[2].weighed_in.has_value());
  EXPECT_EQ(set->lights[2].total.num_frames, 1);
  EXPECT_EQ(set->lights[1].num_frames_without, 1);
  ExpectError(
      RunLightfit({"summarize", kYard, "--lights", kYardLights, "--weigh-by", kYard, "-o", sum}),
      2,
      {"0001.exr", "JSON"});
}

TEST(Summarize, OnlyLikeThingsAreAdded) {
  const TemporaryFolder folder;
  const std::string sum = folder.Path("sum.summary");
  const std::string plain = YardSummary(folder, "plain.summary");
  const std::string l2 = YardSummary(folder, "l2.summary", {"--metric", "l2"});
  const std::string wide = YardSummary(folder, "wide.summary", {"--cover", "receivers"});
  const std::string only = YardSummary(folder, "only.summary", {"--only", "sun"});
  const std::string moved = YardSummary(folder, "moved.summary", {"--light", "sun=sun:0,0,-1"});
  const std::pair<std::string, std::vector<std::string>> others[] = {
      {l2, {"l2.summary", "--metric is l2 here", "l1-edge"}},
      {wide, {"wide.summary", "--cover is receivers", "shadowed"}},
      {only, {"only.summary", "\"sun\"", "\"rim\"", "--only"}},
      {moved, {"moved.summary", "\"sun\"", "direction"}}};
  for (const auto& [other, words] : others) {
    ExpectError(RunLightfit({"summarize", plain, other, "-o", sum}), 2, words);
    ExpectError(RunLightfit({"fit", "--summary", plain, other}), 2, words);
  }
  // A read-back is summed as the flags say, not as the file beside it was.
  ExpectError(RunLightfit({"summarize", l2, kYard, "--lights", kYardLights, "-o", sum}),
              2,
              {"0001.exr", "--metric is l1-edge"});
  RunSummarize({l2, kYard, "--lights", kYardLights, "--metric", "l2", "-o", sum});
}

TEST(Summarize, FlagsThatMeanNothingAreRefused) {
  const TemporaryFolder folder;
  const std::string plain = YardSummary(folder, "plain.summary");
  const std::string out = folder.Path("out.summary");
  ExpectError(RunLightfit({"summarize", kYard, "--lights", kYardLights}), 1, {"--output"});
  ExpectError(RunLightfit({"summarize", "-o", out}), 1, {"READBACK.exr|FILE.summary"});
  ExpectError(RunLightfit({"summarize", kYard, "-o", out}), 2, {"--lights"});
  ExpectError(RunLightfit({"summarize", plain, "-o", "/no/such/folder/x"}), 2, {"/no/such/folder"});
  ExpectError(RunLightfit({"summarize", plain, "--metric", "l2", "-o", out}),
              2,
              {"--metric l2", "--metric l1-edge"});
  ExpectError(RunLightfit({"summarize", plain, "--weigh-by", plain, "-o", out}), 2, {"--weigh-by"});
  ExpectError(
      RunLightfit({"summarize", kYard, "--lights", kYardLights, "--search", "line", "-o", out}),
      1,
      {"--search"});
  EXPECT_THAT(folder.Files(), ElementsAre("plain.summary"));
}

TEST(FitSummary, FlagsOfReadBacksAreRefusedWithTheReason) {
  const TemporaryFolder folder;
  const std::string sum = YardSummary(folder, "sum.summary");
  const auto fit = [&sum](const Arguments& more) {
    return RunLightfit(Joined({"fit", "--summary", sum}, more));
  };
  ExpectError(fit({"--picture", folder.Path("a.png")}), 1, {"--picture", "pixels"});
  ExpectError(fit({"--as-published"}), 1, {"--as-published", "one by one"});
  ExpectError(fit({"--lights", kYardLights}), 1, {"--lights", "hold the lights"});
  ExpectError(fit({"--light", "a=sun:0,0,-1"}), 1, {"--light"});
  ExpectError(fit({"--camera", kYardLights}), 1, {"--camera"});
  ExpectError(fit({"--depth-kind", "distance"}), 1, {"--depth-kind"});
  ExpectError(fit({"--metric", "l1"}),
              2,
              {"--metric l1:", "--metric l1-edge, --cover shadowed and --border lit"});
  ExpectError(fit({"--border", "dark"}), 2, {"--border dark:", "--border lit"});
  ExpectError(fit({"--cover", "receivers"}), 2, {"--cover receivers", "--metric l1-edge"});
  ExpectError(RunLightfit({"fit", kYard, "--summary", sum}), 1, {"one of the two"});
  ExpectError(RunLightfit({"fit", "--summary", kYard}), 2, {"0001.exr", "no summary file"});
  ExpectError(RunLightfit({"fit", "--summary", "/no/such.summary"}), 2, {"/no/such.summary"});
  // What says the same is no conflict; how the map is searched for is free.
  const ProcessResult good = fit({"--metric",
                                  "l1-edge",
                                  "--cover",
                                  "shadowed",
                                  "--search",
                                  "line",
                                  "--affine",
                                  "rectangle",
                                  "--margin-percent",
                                  "5"});
  EXPECT_EQ(good.exit_code, 0) << good.err;
  EXPECT_THAT(good.out, HasSubstr("line search, rectangle, l1-edge"));
  const ProcessResult few = fit({"--min-samples", "1000000"});
  EXPECT_EQ(few.exit_code, 0);
  EXPECT_THAT(few.err, HasSubstr("fewer than 1000000 (--min-samples): its matrix is the focused"));
}

TEST(FitSummary, FilesMayBeNamedInAnyOrder) {
  const TemporaryFolder folder;
  const std::string a = YardSummary(folder, "a.summary"), b = folder.Path("b.summary");
  RunSummarize({a, a, "-o", b});
  std::string json[2];
  for (int i = 0; i < 2; ++i) {
    const std::string path = folder.Path("out.json");
    const ProcessResult result = RunLightfit(
        {"fit", "--summary", i == 0 ? a : b, i == 0 ? b : a, "--quiet", "--json", path});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, IsEmpty());
    json[i] = ReadFile(path);
  }
  EXPECT_FALSE(json[0].empty());
  EXPECT_EQ(json[0], json[1]);
  EXPECT_EQ(ReadResult(folder.Path("out.json")).readback().source(), absl::StrCat(a, ", ", b));
}

}  // namespace
}  // namespace lightfit
