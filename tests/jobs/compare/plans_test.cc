// Comparisons of several maps for one light: their rows, figures, crawl and messages.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "jobs/compare/camera_step.h"
#include "jobs/compare/json.h"
#include "jobs/compare/rows.h"
#include "jobs/compare/totals.h"
#include "jobs/fit_comparison.h"
#include "partition/evaluate_plan.h"
#include "partition/fit_plan.h"
#include "partition/tracking/plan_crawl.h"
#include "render/judge_plan.h"
#include "render/readback_image.h"
#include "tests/jobs/compare/compare_scene.h"
#include "tests/jobs/compare/compared_lights.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::IsOk;
using ::testing::Not;
using testing::StatusIs;

const Light kSun = Light::Directional("sun", {-1, -1.3, 0.4}, 5);
const Light kLamp = Light::Point("lamp", {0.5, 3.5, 1.0});  // among the boxes

// Rows for lamps alone: of a sun they say so, and all others have maps.
bool IsForLampsOnly(const std::string& row) {
  return absl::StartsWith(row, "cube") || absl::StartsWith(row, "paraboloids");
}

// Empty, and a failure, where no row has that name.
v1::MethodMaps MapsOf(const v1::LightComparison& light, const std::string& row) {
  for (const v1::MethodComparison& method : light.methods()) {
    if (method.method() == row) return method.maps();
  }
  ADD_FAILURE() << "no row " << row;
  return {};
}

class ComparePlansTest : public ::testing::Test {
 protected:
  void SetUp() override {
    absl::StatusOr<RayCaster> caster = RayCaster::Build(BoxesOnFloor());
    ASSERT_THAT(caster, IsOk());
    caster_ = std::make_unique<RayCaster>(*std::move(caster));
    stage_ = StageOf({});
    plan_.max_maps = 3;
    plan_.texels = int64_t{100} * 90;
    plan_.guard_texels = 1.0;
    plan_.fit.border = BorderChoice::kAutomatic;
    SetPlan(plan_, &options_);
    options_.judge.phases = 1;
  }

  CompareStage StageOf(const CameraStep& step) const {
    absl::StatusOr<CompareStage> stage =
        MakeStage(*caster_, Stepped(BoxesCamera(100, 75), step), 80, 60);
    EXPECT_THAT(stage, IsOk());
    return stage.ok() ? *std::move(stage) : CompareStage();
  }

  std::unique_ptr<RayCaster> caster_;
  CompareStage stage_;
  PlanOptions plan_;
  CompareOptions options_;
};

TEST_F(ComparePlansTest, HasARowForEveryScheme) {
  const LightComparison comparison = CompareMaps(stage_, kSun, options_);
  std::vector<std::string> names;
  for (const ComparedRow& row : comparison.rows) names.push_back(row.name);
  EXPECT_EQ(names, RowNames(options_));
  EXPECT_THAT(names,
              ElementsAre("standard",
                          "focused",
                          "tsm",
                          "lispsm-simple",
                          "lispsm",
                          "psm",
                          "plane-optimal",
                          "as-published",
                          "line",
                          "one map",
                          "ZP3+LiSPSM",
                          "ZP3+LiSPSM, aspects",
                          "ZP3",
                          "ZP3, aspects",
                          "PSSM3",
                          "FP+ZP+W",
                          "Tang",
                          "Mikkelsen",
                          "stable3",
                          "SDSM3",
                          "pages",
                          "cube",
                          "cube, turned",
                          "paraboloids",
                          "paraboloids, drawn",
                          "lightfit"));
  EXPECT_EQ(options_.map.width, 94);  // the largest square of as many texels
  for (const ComparedRow& row : comparison.rows) {
    SCOPED_TRACE(row.name);
    ASSERT_EQ(row.status.ok(), !IsForLampsOnly(row.name)) << row.status;
    if (!row.status.ok()) continue;
    EXPECT_LE(NumTexels(row.drawn), plan_.texels);
    ASSERT_TRUE(row.wrong.has_value());
    EXPECT_GT(row.wrong->ideal, 0);
    EXPECT_EQ(row.figures.has_value(), row.name != "pages") << row.note;
    EXPECT_EQ(row.foretold.has_value(), row.name != "pages");
  }
  EXPECT_THAT(comparison.Find("cube")->status,
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("point lights")));
}

TEST_F(ComparePlansTest, OursIsThePlanAndIsMeasuredAsOne) {
  const LightComparison comparison = CompareMaps(stage_, kSun, options_);
  const ComparedRow& ours = comparison.lightfit();
  ASSERT_THAT(ours.status, IsOk());
  const LitStage lit = Lit(stage_, kSun);
  const absl::StatusOr<LightPlan> fit = FitPlan(**lit.surfaces, lit.light, plan_);
  ASSERT_THAT(fit, IsOk());
  const Plan plan = PlanOf(*fit);
  ASSERT_GT(plan.maps.size(), 1u);
  ASSERT_EQ(NumMaps(ours.drawn), static_cast<int>(plan.maps.size()));
  EXPECT_EQ(PlanOf(ours.drawn)->maps[1].map_from_world, plan.maps[1].map_from_world);
  EXPECT_EQ(ours.border(), plan.border);

  const std::vector<Lighting> truth = TrueLighting(*caster_, stage_.screen, kSun);
  const absl::StatusOr<ShadowImage> judged =
      JudgePlan(*caster_, stage_.screen, truth, kSun, plan, options_.judge, plan_.guard_texels);
  ASSERT_THAT(judged, IsOk());
  EXPECT_EQ(ours.wrong->ideal, judged->wrong.ideal);
  EXPECT_EQ(ours.wrong->practical, judged->wrong.practical);

  FitOptions table = FigureOptions(plan_.fit);
  table.metric = Metric::kL2;
  const absl::StatusOr<LightView> view = ViewLight(**lit.surfaces, lit.light, plan.border, table);
  ASSERT_THAT(view, IsOk());
  const absl::StatusOr<Figures> figures = EvaluatePlan(*view, plan, table, plan_.guard_texels);
  ASSERT_THAT(figures, IsOk());
  EXPECT_EQ(ours.figures->energy, figures->energy);
  EXPECT_EQ(ours.figures->footprint.worst, figures->footprint.worst);
  EXPECT_EQ(*ours.foretold, *figures->wrong_share);
}

TEST_F(ComparePlansTest, ALampAmongItsReceiversHasCubesAndParaboloids) {
  const LightComparison comparison = CompareMaps(stage_, kLamp, options_);
  for (const char* name : {"cube", "cube, turned", "lightfit"}) {
    SCOPED_TRACE(name);
    const ComparedRow& row = *comparison.Find(name);
    ASSERT_THAT(row.status, IsOk());
    EXPECT_TRUE(row.figures.has_value()) << row.note;
    EXPECT_TRUE(row.foretold.has_value());
  }
  for (const char* name : {"paraboloids", "paraboloids, drawn"}) {
    SCOPED_TRACE(name);
    const ComparedRow& row = *comparison.Find(name);
    ASSERT_THAT(row.status, IsOk());
    EXPECT_EQ(NumMaps(row.drawn), 2);
    EXPECT_FALSE(row.figures.has_value());
    EXPECT_THAT(row.note, HasSubstr("matrices"));
    EXPECT_GT(row.wrong->ideal, comparison.lightfit().wrong->ideal);
  }
  EXPECT_FALSE(comparison.Find("pages")->status.ok());
}

TEST_F(ComparePlansTest, NothingCrawlsWhereTheCameraStands) {
  const absl::StatusOr<NextFrame> next = MakeNextFrame(stage_, StageOf({}));
  ASSERT_THAT(next, IsOk());
  options_.next = &*next;
  for (const ComparedRow& row : CompareMaps(stage_, kSun, options_).rows) {
    SCOPED_TRACE(row.name);
    ASSERT_EQ(row.status.ok(), !IsForLampsOnly(row.name)) << row.status;
    if (!row.status.ok()) continue;
    ASSERT_TRUE(row.crawl.has_value()) << row.note;
    EXPECT_EQ(row.crawl->points.num_points > 0, row.name != "pages");
    EXPECT_EQ(row.crawl->points.phase_drift_texels, 0.0);
    EXPECT_GT(row.crawl->flicker->judged, 1000);
    EXPECT_EQ(row.crawl->flicker->flips_ideal, 0);
  }
}

TEST_F(ComparePlansTest, CrawlIsThatOfThePlansOfBothFrames) {
  const absl::StatusOr<NextFrame> next = MakeNextFrame(stage_, StageOf({0.1, 0.02, 0, 0.5, 0.1}));
  ASSERT_THAT(next, IsOk());
  options_.next = &*next;
  const LightComparison present = CompareMaps(stage_, kSun, options_);
  options_.next = nullptr;
  const LightComparison there = CompareMaps(next->stage, kSun, options_);
  const LitStage from = Lit(stage_, kSun), to = Lit(next->stage, kSun);
  for (const char* name : {"ZP3", "lightfit"}) {
    SCOPED_TRACE(name);
    const ComparedRow& row = *present.Find(name);
    ASSERT_TRUE(row.crawl.has_value()) << row.note;
    const absl::StatusOr<Crawl> crawl =
        MeasurePlanCrawl({from.readback, *PlanOf(row.drawn)},
                         {to.readback, *PlanOf(there.Find(name)->drawn)},
                         from.light,
                         plan_.guard_texels);
    ASSERT_THAT(crawl, IsOk());
    EXPECT_EQ(row.crawl->points.num_points, crawl->num_points);
    EXPECT_EQ(row.crawl->points.phase_drift_texels, crawl->phase_drift_texels);
    EXPECT_GT(crawl->phase_drift_texels, 0.2);
  }
  // Cascades that move by whole texels, though they grow with what the camera sees; and pages that
  // lie still.
  EXPECT_LT(present.Find("stable3")->crawl->points.phase_drift_texels,
            0.6 * present.Find("ZP3")->crawl->points.phase_drift_texels);
  EXPECT_EQ(present.Find("pages")->crawl->points.num_points, 0);
  EXPECT_LT(*IdealFlipShare(*present.Find("pages")->crawl),
            *IdealFlipShare(*present.Find("ZP3")->crawl));
}

TEST_F(ComparePlansTest, AReadbackAloneGivesEnergiesOfPlans) {
  const absl::StatusOr<ReadbackImage> readback =
      RenderReadback(*caster_, stage_.readback.camera, {kSun});
  ASSERT_THAT(readback, IsOk());
  const absl::StatusOr<CompareStage> stage = MakeStage(readback->View());
  ASSERT_THAT(stage, IsOk());
  const LightComparison alone = CompareMaps(*stage, kSun, options_);
  const LightComparison with_scene = CompareMaps(stage_, kSun, options_);
  EXPECT_EQ(alone.lightfit().figures->energy, with_scene.lightfit().figures->energy);
  EXPECT_EQ(*alone.lightfit().foretold, *with_scene.lightfit().foretold);
  EXPECT_TRUE(alone.Find("pages")->status.ok());
  for (const ComparedRow& row : alone.rows) EXPECT_FALSE(row.wrong.has_value()) << row.name;
}

TEST_F(ComparePlansTest, TheMessageHoldsTheMaps) {
  const std::vector<LightComparison> lights = {CompareMaps(stage_, kSun, options_),
                                               CompareMaps(stage_, kLamp, options_)};
  const v1::Comparison message = ComparisonToProto("boxes", stage_, options_, lights);
  EXPECT_EQ(message.plan_options().max_maps(), 3);
  EXPECT_EQ(message.plan_options().guard_texels(), 1.0);
  int num_with_maps = 0;
  for (size_t l = 0; l < lights.size(); ++l) {
    for (size_t i = 0; i < lights[l].rows.size(); ++i) {
      const ComparedRow& row = lights[l].rows[i];
      SCOPED_TRACE(lights[l].light.name + ", " + row.name);
      const v1::MethodComparison& method =
          message.lights(static_cast<int>(l)).methods(static_cast<int>(i));
      EXPECT_EQ(method.method(), row.name);
      EXPECT_EQ(method.has_maps(), row.status.ok());
      if (!row.status.ok()) continue;
      ++num_with_maps;
      const v1::MethodMaps& maps = method.maps();
      EXPECT_EQ(maps.texels(), NumTexels(row.drawn));
      EXPECT_EQ(method.has_map_from_world(), OnlyMap(row.drawn) != nullptr);
      const Plan* plan = PlanOf(row.drawn);
      EXPECT_EQ(maps.has_paraboloids(), row.name.rfind("paraboloids", 0) == 0);
      EXPECT_EQ(maps.has_pages(), row.name == "pages");
      ASSERT_EQ(maps.plan_size(), plan == nullptr ? 0 : NumMaps(row.drawn));
      for (int k = 0; k < maps.plan_size(); ++k) {
        EXPECT_EQ(maps.plan(k).map().width(), plan->maps[k].size.width);
        EXPECT_EQ(maps.plan(k).map_from_world().m(7), plan->maps[k].map_from_world(1, 3));
        ASSERT_EQ(maps.plan(k).half_spaces_size(),
                  static_cast<int>(plan->maps[k].half_spaces.size()));
        for (int n = 0; n < maps.plan(k).half_spaces_size(); ++n) {
          EXPECT_EQ(maps.plan(k).half_spaces(n).n(3), plan->maps[k].half_spaces[n](3));
        }
      }
    }
  }
  EXPECT_GT(num_with_maps, 22);  // all but four of the sun's, and some of the lamp's
  const v1::MethodMaps paged = MapsOf(message.lights(0), "pages");
  const v1::MapPages& pages = paged.pages();
  EXPECT_EQ(pages.pages_size() * pages.page_side() * pages.page_side(), paged.texels());
  EXPECT_EQ(pages.plane_from_world_size(), 8);
  const v1::MethodMaps pair = MapsOf(message.lights(1), "paraboloids");
  ASSERT_EQ(pair.paraboloids().centre_size(), 3);
  EXPECT_EQ(pair.paraboloids().centre(1), kLamp.position.y());
  EXPECT_FALSE(pair.paraboloids().is_rasterised());
  EXPECT_TRUE(MapsOf(message.lights(1), "paraboloids, drawn").paraboloids().is_rasterised());
}

// Drawn, judged, foretold, measured and followed as ours, whether ours is a plan or a single map.
TEST_F(ComparePlansTest, AGivenPlanIsJudgedAsOurs) {
  const absl::StatusOr<NextFrame> next = MakeNextFrame(stage_, StageOf({0.1, 0.02, 0, 0.5, 0.1}));
  ASSERT_THAT(next, IsOk());
  options_.next = &*next;
  const LightComparison alone = CompareMaps(stage_, kLamp, options_);
  const ComparedRow& ours = alone.lightfit();
  const Plan& plan = *PlanOf(ours.drawn);
  ASSERT_GT(plan.maps.size(), 1u);
  options_.given = {{"copy", std::nullopt, {{"lamp", {plan, ours.drawn.guard_texels}}}}};
  EXPECT_TRUE(HasPlans(options_));
  const auto expect_as_ours = [&](const ComparedRow& copy) {
    ASSERT_THAT(copy.status, IsOk());
    EXPECT_EQ(NumMaps(copy.drawn), NumMaps(ours.drawn));
    EXPECT_EQ(copy.drawn.guard_texels, ours.drawn.guard_texels);
    EXPECT_EQ(copy.border(), ours.border());
    EXPECT_EQ(copy.wrong->ideal, ours.wrong->ideal);
    EXPECT_EQ(copy.wrong->practical, ours.wrong->practical);
    EXPECT_EQ(copy.wrong->outside, ours.wrong->outside);
    EXPECT_EQ(copy.foretold, ours.foretold);
    // The plan is kept, where ours is fitted anew.
    ASSERT_TRUE(copy.crawl.has_value()) << copy.note;
    EXPECT_GT(copy.crawl->points.num_points, 0);
  };
  const LightComparison beside = CompareMaps(stage_, kLamp, options_);
  expect_as_ours(*beside.Find("copy"));
  EXPECT_EQ(beside.Find("copy")->figures->energy, ours.figures->energy);
  options_.plan.reset();
  EXPECT_TRUE(HasPlans(options_));
  expect_as_ours(*CompareMaps(stage_, kLamp, options_).Find("copy"));
  EXPECT_FALSE(HasPlans(CompareOptions()));
}

TEST_F(ComparePlansTest, AGivenPlanOfOtherTexelsSaysSo) {
  const LightComparison alone = CompareMaps(stage_, kLamp, options_);
  const Plan plan = *PlanOf(alone.lightfit().drawn);
  const std::string texels = absl::StrCat(NumTexels(plan), " texels in all");
  options_.given = {{"mine", std::nullopt, {{"lamp", {plan, 1.0}}}}};
  options_.map = {200, 100};
  options_.plan->texels = 20000;
  const LightComparison comparison = CompareMaps(stage_, kLamp, options_);
  const ComparedRow& mine = *comparison.Find("mine");
  EXPECT_TRUE(mine.drawn.has_other_texels);
  EXPECT_THAT(mine.note, HasSubstr(texels + ", and not the 20000 of one map here"));
  EXPECT_FALSE(comparison.lightfit().drawn.has_other_texels);
  // None of it is said of a plan that has what others have.
  options_.given = {{"mine", std::nullopt, {{"lamp", {plan, 1.0}}}}};
  Plan& given = options_.given[0].by_light["lamp"].plan;
  given.maps.resize(1);
  given.maps[0].size = {100, 200};
  EXPECT_THAT(CompareMaps(stage_, kLamp, options_).Find("mine")->note,
              Not(HasSubstr("the file's own sizes")));
}

TEST_F(ComparePlansTest, TotalsCountMaps) {
  const std::vector<LightComparison> lights = {CompareMaps(stage_, kSun, options_),
                                               CompareMaps(stage_, kLamp, options_)};
  for (const MethodTotals& totals : TotalsOf(lights)) {
    SCOPED_TRACE(totals.name);
    double num_maps = 0.0, num_texels = 0.0;
    for (const LightComparison& light : lights) {
      const ComparedRow& row = *light.Find(totals.name);
      if (!row.status.ok()) continue;
      num_maps += NumMaps(row.drawn);
      num_texels += static_cast<double>(NumTexels(row.drawn));
    }
    ASSERT_GT(totals.num_lights, 0);
    EXPECT_DOUBLE_EQ(totals.mean_maps, num_maps / totals.num_lights);
    EXPECT_DOUBLE_EQ(totals.mean_texels, num_texels / totals.num_lights);
    EXPECT_EQ(totals.num_lights + totals.num_failed, 2);
  }
}

TEST_F(ComparePlansTest, AllMapsMayHaveOneSize) {
  plan_.each = MapSize{50, 40};
  SetPlan(plan_, &options_);
  EXPECT_EQ(options_.map.width, 77);  // of 6000 texels
  const LightComparison comparison = CompareMaps(stage_, kSun, options_);
  for (const PlanMap& map : PlanOf(comparison.lightfit().drawn)->maps) {
    EXPECT_EQ(map.size.width, 50);
    EXPECT_EQ(map.size.height, 40);
  }
  for (const ComparedRow& row : comparison.rows) EXPECT_LE(NumTexels(row.drawn), 6000) << row.name;
}

}  // namespace
}  // namespace lightfit
