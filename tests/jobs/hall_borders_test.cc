// A furnished room with two windows, of a real renderer: nearly all that is in view is dark for the
// lights outside, and what is lit is a few hundred pixels.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "io/fine_cover_exr.h"
#include "io/lights_file.h"
#include "io/readback_exr.h"
#include "optimizer/choose_fit.h"
#include "tests/testing/fit_candidates.h"
#include "tests/testing/matchers.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using testing::ChosenOf;
using testing::FitCandidate;
using testing::FitCandidates;
using testing::IsOk;

constexpr MapSize kMap = {1024, 1024};

class HallBorders : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const std::string folder = RepositoryPath(std::string("../shared/readbacks/") + GetParam());
    if (!std::filesystem::exists(folder + "_180") || !std::filesystem::exists(folder + "_750")) {
      GTEST_SKIP() << "no read-backs at " << folder << "_180 and _750";
    }
    const auto lights = ReadLightsFile(folder + "_180/scene.json");
    ASSERT_THAT(lights, IsOk());
    lights_ = *lights;
    auto file = ReadReadbackExr(folder + "_180/0001.exr", lights_);
    ASSERT_THAT(file, IsOk());
    file_ = *std::move(file);
    auto fine = ReadFineCoverExr(folder + "_750/0001.exr", lights_, {}, file_);
    ASSERT_THAT(fine, IsOk());
    fine_file_ = *std::move(fine);
    fine_cover_ = fine_file_.View();
    options_.border = BorderChoice::kAutomatic;
  }

  std::vector<Light> lights_;
  ReadbackFile file_;
  FineCoverFile fine_file_;
  FineCover fine_cover_;
  FitOptions options_;
};

TEST_P(HallBorders, AreThoseThatTheThresholdsSay) {
  for (const bool is_fine : {false, true}) {
    Readback readback = file_.View();
    if (is_fine) readback.fine_cover = &fine_cover_;
    for (const Light& light : lights_) {
      SCOPED_TRACE(light.name);
      const std::vector<FitCandidate> candidates = FitCandidates(readback, light, kMap, options_);
      const FitCandidate& expected = ChosenOf(candidates);
      const Surfaces surfaces = *FindSurfaces(readback, LightMask(lights_), options_.samples);
      const auto chosen = FitByForecast(surfaces, light, kMap, options_);
      ASSERT_EQ(chosen.status(), expected.matrix.status());
      if (!chosen.ok()) continue;
      for (const FitCandidate& candidate : candidates) {
        if (!candidate.matrix.ok()) continue;
        std::printf("%s, %s: %.4f %%\n",
                    light.name.c_str(),
                    candidate.name.c_str(),
                    100.0 * candidate.share);
      }
      EXPECT_EQ(chosen->map_from_world, expected.matrix->map_from_world) << expected.name;
      EXPECT_EQ(chosen->border, expected.matrix->border);
      EXPECT_EQ(chosen->figures.wrong_share, expected.share);
    }
  }
}

TEST_P(HallBorders, AreDarkWhereTheLightComesThroughWindows) {
  constexpr double kFarFewer = 0.5;  // of what is foretold for the lit border
  const Readback readback = file_.View();
  int num_lights = 0;
  for (const Light& light : lights_) {
    if (light.name != "sun" && light.name != "rim") continue;
    SCOPED_TRACE(light.name);
    const auto chosen = FitLight(readback, light, kMap, options_);
    ASSERT_THAT(chosen, IsOk());
    EXPECT_EQ(chosen->border, Border::kDark);
    EXPECT_EQ(chosen->facing, FacingSource::kGiven);
    FitOptions lit_options;
    const auto lit = FitLight(readback, light, kMap, lit_options);
    ASSERT_THAT(lit, IsOk());
    const auto lit_share = ForetellWrongShare(readback, light, lit->map_from_world, kMap);
    ASSERT_THAT(lit_share, IsOk());
    EXPECT_LT(*chosen->figures.wrong_share, kFarFewer * *lit_share);
    const Surfaces surfaces = *FindSurfaces(readback, LightMask(lights_), options_.samples);
    for (const Border current : {Border::kLit, Border::kDark}) {
      EXPECT_EQ(BorderByForecast(surfaces, light, kMap, options_, current), Border::kDark);
    }
    ++num_lights;
  }
  EXPECT_EQ(num_lights, 2);
}

INSTANTIATE_TEST_SUITE_P(Halls, HallBorders, ::testing::Values("hall", "hall_two"));

}  // namespace
}  // namespace lightfit
