// Plans beside single maps of as many texels, and lamps that have no single one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "absl/strings/str_format.h"
#include "io/lights_file.h"
#include "io/readback_exr.h"
#include "jobs/fit_comparison.h"
#include "optimizer/fit.h"
#include "optimizer/readback/surfaces.h"
#include "tests/testing/matchers.h"
#include "tests/testing/process.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using ::testing::EndsWith;
using testing::IsOk;
using testing::StatusIs;
using testing::TestScene;

constexpr double kRelativeTolerance = 1e-9;  // the same sums, in another order

TEST(PlanComparison, HasThePlanBesideSingleMapsOfAsManyTexels) {
  const TestScene scene(/*seed=*/7, /*num_lights=*/3);
  PlanOptions options;
  options.texels = 120000;
  const int64_t before = NumSurfacesFound();
  int num_begun = 0;
  const ComparedReadback compared = CompareLights(
      scene.View(), scene.lights, std::vector<absl::Status>(3), options, [&](const Light&) {
        ++num_begun;
      });
  EXPECT_EQ(NumSurfacesFound() - before, 1);
  EXPECT_EQ(num_begun, 3);
  int num_plans = 0;
  for (const FitComparison& light : compared.comparisons) {
    if (!light.ok()) continue;
    ASSERT_TRUE(light.plan.has_value());
    const JudgedPlan& judged = **light.plan;
    ++num_plans;
    EXPECT_LE(NumTexels(PlanOf(judged.plan)), 120000);
    EXPECT_EQ(light.border(), judged.plan.border);
    EXPECT_EQ(light.figures().wrong_share, judged.figures.wrong_share);
    // The fit's options are those of the figures, so that both have the same samples.
    EXPECT_NEAR(judged.figures.energy, judged.plan.energy, kRelativeTolerance * judged.plan.energy);
    EXPECT_EQ(judged.own_figures.energy, judged.figures.energy);
    EXPECT_EQ(light.samples().used, judged.own_figures.samples.used);
    if (!light.final.ok()) continue;
    EXPECT_EQ(light.final->matrix.map.width, 346);  // 346^2 <= 120000 < 347^2
    EXPECT_EQ(light.published->matrix.map.height, 346);
    EXPECT_LE(judged.figures.energy, light.final->figures.energy);
  }
  EXPECT_GE(num_plans, 2);
}

TEST(PlanComparison, OneMapHasTheTexelsOfAllMapsThatThereMayBe) {
  PlanOptions options;
  options.max_maps = 4;
  options.each = MapSize{300, 100};
  EXPECT_EQ(OneMapSize(options).width, 346);
  options.each = MapSize{kMaxMapSide, kMaxMapSide};
  EXPECT_EQ(OneMapSize(options).width, kMaxMapSide);
}

TEST(PlanComparison, AnUnreadableLightFailsAlone) {
  const TestScene scene(/*seed=*/7, /*num_lights=*/2);
  PlanOptions options;
  options.max_maps = 2;
  const ComparedReadback compared =
      CompareLights(scene.View(),
                    scene.lights,
                    std::vector<absl::Status>{absl::NotFoundError("no channel"), absl::OkStatus()},
                    options,
                    [](const Light&) {});
  EXPECT_THAT(compared.comparisons[0].status(),
              StatusIs(absl::StatusCode::kNotFound, "no channel"));
  EXPECT_FALSE(compared.comparisons[0].plan.has_value());
}

// What a call says of a plan is what the command line writes of it.
TEST(PlanComparison, OwnFiguresAreThoseOfTheResultFile) {
  const auto lights = ReadLightsFile(RepositoryPath("examples/yard_180/scene.json"));
  ASSERT_THAT(lights, IsOk());
  const auto file = ReadReadbackExr(RepositoryPath("examples/yard_180/0001.exr"), *lights);
  ASSERT_THAT(file, IsOk());
  PlanOptions options;
  options.max_maps = 2;
  options.texels = 40000;
  options.guard_texels = 1.0;
  for (const bool use_outlines : {false, true}) {
    options.fit.samples.use_outlines = use_outlines;
    const absl::StatusOr<Surfaces> surfaces =
        FindSurfaces(file->View(), LightMask(*lights), options.fit.samples);
    ASSERT_THAT(surfaces, IsOk());
    const FitComparison compared = ComparePlan(*surfaces, lights->front(), options);
    ASSERT_TRUE(compared.ok()) << compared.status();
    const JudgedPlan& judged = **compared.plan;
    const auto own = OwnFiguresOf(judged.plan, *surfaces, lights->front(), options, true);
    ASSERT_THAT(own, IsOk());
    EXPECT_EQ(own->energy, judged.own_figures.energy);
    EXPECT_EQ(own->wrong_share, judged.own_figures.wrong_share);
    EXPECT_EQ(own->samples.used, judged.own_figures.samples.used);
  }
}

// The number that the error says is the least that has a plan.
TEST(PlanComparison, SaysHowManyMapsALampAmongItsReceiversTakes) {
  const auto lights = ReadLightsFile(RepositoryPath("examples/room_180/scene.json"));
  ASSERT_THAT(lights, IsOk());
  const auto file = ReadReadbackExr(RepositoryPath("examples/room_180/0001.exr"), *lights);
  ASSERT_THAT(file, IsOk());
  FitOptions options;
  options.cover = Cover::kReceivers;
  const absl::StatusOr<Surfaces> surfaces =
      FindSurfaces(file->View(), LightMask(*lights), options.samples);
  ASSERT_THAT(surfaces, IsOk());
  int num_lamps = 0;
  for (Light light : *lights) {
    if (light.kind != Light::Kind::kPoint) continue;
    const FitComparison single = CompareFit(*surfaces, light, {512, 512}, options);
    if (single.ok()) continue;
    ++num_lamps;
    PlanOptions plan;
    plan.fit = options;
    plan.texels = 512 * 512;
    for (plan.max_maps = 2; !ComparePlan(*surfaces, light, plan).ok(); ++plan.max_maps) {
      ASSERT_LE(plan.max_maps, 6);
    }
    EXPECT_THAT(
        std::string(single.status().message()),
        EndsWith(absl::StrFormat(
            "A plan of %d maps (options.max_maps = %d) would do", plan.max_maps, plan.max_maps)));
    const FitComparison several = ComparePlan(*surfaces, light, plan);
    EXPECT_FALSE(several.final.ok());
    EXPECT_GT((*several.plan)->figures.energy, 0.0);
  }
  EXPECT_GE(num_lamps, 1);
}

}  // namespace
}  // namespace lightfit
