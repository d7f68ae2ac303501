// The rows of a comparison: what they hold, and what becomes of matrices that cannot be used.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "jobs/compare/rows.h"
#include "optimizer/evaluate.h"
#include "optimizer/fit.h"
#include "optimizer/light_matrix.h"
#include "render/generator/room.h"
#include "render/readback_image.h"
#include "tests/jobs/compare/compare_scene.h"
#include "tests/jobs/compare/compared_lights.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::IsOk;
using testing::RelativeError;
using testing::StatusIs;

// Sums of the same terms in another order, in other coordinates.
constexpr double kSumTolerance = 1e-9;

const Light kSun = Light::Directional("sun", {-1, -1.3, 0.4}, 5);

GivenMaps OneMap(const Eigen::Matrix4d& map_from_world, MapSize map, Border border = Border::kLit) {
  return {PlanOfOneMap("", map_from_world, map, border)};
}

class CompareMapsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    absl::StatusOr<RayCaster> caster = RayCaster::Build(BoxesOnFloor());
    ASSERT_THAT(caster, IsOk());
    caster_ = std::make_unique<RayCaster>(*std::move(caster));
    absl::StatusOr<CompareStage> stage = MakeStage(*caster_, BoxesCamera(200, 150), 104, 78);
    ASSERT_THAT(stage, IsOk());
    stage_ = *std::move(stage);
    options_.map = {100, 80};
  }

  LightComparison Compare(const Light& light) const { return CompareMaps(stage_, light, options_); }

  std::unique_ptr<RayCaster> caster_;
  CompareStage stage_;
  CompareOptions options_;
};

TEST_F(CompareMapsTest, HasARowForEveryMethod) {
  options_.given = {{"engine", OneMap(Eigen::Matrix4d::Identity(), options_.map), {}}};
  const LightComparison comparison = Compare(kSun);
  std::vector<std::string> names;
  for (const ComparedRow& map : comparison.rows) names.push_back(map.name);
  EXPECT_THAT(names,
              ::testing::ElementsAre("standard",
                                     "focused",
                                     "tsm",
                                     "lispsm-simple",
                                     "lispsm",
                                     "psm",
                                     "plane-optimal",
                                     "as-published",
                                     "line",
                                     "engine",
                                     "lightfit"));
  EXPECT_EQ(names, RowNames(options_));
  EXPECT_EQ(&comparison.lightfit(), comparison.Find("lightfit"));
  EXPECT_EQ(comparison.Find("no such row"), nullptr);
  for (const ComparedRow& map : comparison.rows) {
    if (map.name == "engine") continue;
    SCOPED_TRACE(map.name);
    ASSERT_THAT(map.status, IsOk());
    ASSERT_TRUE(map.wrong.has_value());
    ASSERT_TRUE(map.figures.has_value()) << map.note;
    EXPECT_GT(map.wrong->ideal, 0);
    EXPECT_TRUE(std::isfinite(map.figures->energy));
    EXPECT_GE(map.figures->footprint.worst, map.figures->footprint.rms);
  }
}

// Our search for what the published algorithm minimises.
FitOptions PublishedEnergy() {
  FitOptions options = FitOptions::AsPublished();
  options.search = Search::kGlobal;
  options.affine = Affine::kMinEnergyParallelogram;
  options.sample_by_sample = false;
  options.ray_space = RaySpace::kNormalized;
  return options;
}

// One meaning of each figure: rows of every method are over the samples that a fit takes by
// default, whatever the fit that made them took.
TEST_F(CompareMapsTest, FiguresAreThoseOfAnybodysMatrixOverTheTablesSamples) {
  options_.fit = PublishedEnergy();
  const LightComparison comparison = Compare(kSun);
  // The read-back that the comparison made for itself.
  const absl::StatusOr<ReadbackImage> readback =
      RenderReadback(*caster_, stage_.readback.camera, {kSun});
  ASSERT_THAT(readback, IsOk());
  const std::pair<const char*, FitOptions> fits[] = {{"as-published", FitOptions::AsPublished()},
                                                     {"lightfit", PublishedEnergy()}};
  for (const auto& [name, options] : fits) {
    SCOPED_TRACE(name);
    const absl::StatusOr<LightMatrix> fit = FitLight(readback->View(), kSun, options_.map, options);
    ASSERT_THAT(fit, IsOk());
    const ComparedRow& row = *comparison.Find(name);
    EXPECT_EQ(MatrixOf(row), fit->map_from_world);
    FitOptions table;  // default samples
    table.metric = Metric::kL2;
    const absl::StatusOr<Figures> figures =
        EvaluateMatrix(readback->View(), kSun, fit->map_from_world, options_.map, table);
    ASSERT_THAT(figures, IsOk());
    EXPECT_LT(RelativeError(row.figures->energy, figures->energy), kSumTolerance);
    EXPECT_LT(RelativeError(row.figures->footprint.worst, figures->footprint.worst), kSumTolerance);
    EXPECT_EQ(comparison.samples.used, figures->samples.used);
    EXPECT_GT(comparison.samples.used, fit->figures.samples.used);
  }
}

// What a map with a dark border need not hold no row is measured by: in a room that the sun shines
// into through windows, edges that lie in the dark.
TEST(CompareDarkBorder, FiguresAreOverTheEdgesThatItServes) {
  absl::StatusOr<RayCaster> caster = RayCaster::Build(MakeRoom(/*seed=*/5, 30000).scene);
  ASSERT_THAT(caster, IsOk());
  const absl::StatusOr<Camera> camera =
      LookAtCamera({2.3, 1.6, 3.3}, {-2, 0.8, -1}, {0, 1, 0}, 1.2, 200, 150);
  ASSERT_THAT(camera, IsOk());
  const absl::StatusOr<CompareStage> stage = MakeStage(*caster, *camera, 160, 120);
  ASSERT_THAT(stage, IsOk());
  const Light sun = Light::Directional("sun", {1, -0.9, 0.3});
  CompareOptions options;
  options.fit.border = BorderChoice::kDark;
  const LightComparison comparison = CompareMaps(*stage, sun, options);
  EXPECT_EQ(comparison.lightfit().border(), Border::kDark);

  const absl::StatusOr<ReadbackImage> readback =
      RenderReadback(*caster, stage->readback.camera, {sun});
  ASSERT_THAT(readback, IsOk());
  FitOptions table = options.fit;
  table.metric = Metric::kL2;
  for (const char* name : {"focused", "lightfit"}) {
    SCOPED_TRACE(name);
    const ComparedRow& row = *comparison.Find(name);
    ASSERT_TRUE(row.figures.has_value()) << row.note;
    const absl::StatusOr<Figures> figures =
        EvaluateMatrix(readback->View(), sun, MatrixOf(row), options.map, table);
    ASSERT_THAT(figures, IsOk());
    EXPECT_LT(RelativeError(row.figures->energy, figures->energy), kSumTolerance);
    EXPECT_EQ(comparison.samples.used, figures->samples.used);
  }
  table.border = BorderChoice::kLit;
  const absl::StatusOr<Figures> of_every_edge = EvaluateMatrix(
      readback->View(), sun, MatrixOf(*comparison.Find("focused")), options.map, table);
  ASSERT_THAT(of_every_edge, IsOk());
  EXPECT_LT(comparison.samples.used, of_every_edge->samples.used);
}

// Whatever is minimised, all rows are measured by the same energy: nothing beats its own search.
TEST_F(CompareMapsTest, MeasuresEveryMetricByTheSquaredFootprint) {
  options_.fit = PublishedEnergy();
  const LightComparison l2 = Compare(kSun);
  options_.fit.metric = Metric::kL1;
  const LightComparison l1 = Compare(kSun);
  EXPECT_GE(l1.lightfit().figures->energy, l2.lightfit().figures->energy * (1 - 1e-6));
  EXPECT_LT(l1.lightfit().figures->energy, 3 * l2.lightfit().figures->energy);
  EXPECT_EQ(l1.Find("line")->figures->energy, l2.Find("line")->figures->energy);
  EXPECT_EQ(l1.samples.used, l2.samples.used);
}

TEST_F(CompareMapsTest, FinerMapsHaveFewerWrongPixels) {
  options_.map = {30, 30};
  const LightComparison coarse = Compare(kSun);
  options_.map = {1000, 1000};
  const LightComparison fine = Compare(kSun);
  for (size_t row = 0; row < fine.rows.size(); ++row) {
    SCOPED_TRACE(fine.rows[row].name);
    ASSERT_TRUE(fine.rows[row].wrong.has_value()) << fine.rows[row].status;
    // What lies outside the map stays outside: a coarse read-back does not show all that is dark.
    const WrongPixels& wrong = *fine.rows[row].wrong;
    EXPECT_LT(5 * (wrong.ideal - wrong.outside), coarse.rows[row].wrong->ideal);
  }
}

TEST_F(CompareMapsTest, ImagesHoldTheWrongPixels) {
  options_.keep_images = true;
  options_.judge.phases = 1;
  const LightComparison comparison = Compare(kSun);
  ASSERT_EQ(comparison.truth.size(), 200u * 150u);
  EXPECT_GT(comparison.lighting.shadowed, 100);
  for (const ComparedRow& map : comparison.rows) {
    SCOPED_TRACE(map.name);
    int64_t ideal = 0, practical = 0;
    for (size_t i = 0; i < comparison.truth.size(); ++i) {
      ideal += map.image.ideal[i] != comparison.truth[i];
      practical += map.image.practical[i] != comparison.truth[i];
    }
    EXPECT_EQ(ideal, map.wrong->ideal);
    EXPECT_EQ(practical, map.wrong->practical);
  }
}

TEST_F(CompareMapsTest, AGivenMatrixIsJudgedAsOurs) {
  const Eigen::Matrix4d ours = MatrixOf(Compare(kSun).lightfit());
  options_.given = {{"copy", OneMap(ours, options_.map), {}},
                    {"by name", std::nullopt, {{"sun", OneMap(ours, options_.map)}}}};
  const LightComparison comparison = Compare(kSun);
  for (const char* name : {"copy", "by name"}) {
    const ComparedRow& copy = *comparison.Find(name);
    ASSERT_THAT(copy.status, IsOk());
    EXPECT_EQ(copy.wrong->ideal, comparison.lightfit().wrong->ideal);
    EXPECT_EQ(copy.wrong->practical, comparison.lightfit().wrong->practical);
    EXPECT_DOUBLE_EQ(copy.figures->energy, comparison.lightfit().figures->energy);
  }
}

// Each row is judged with the border of its own map, over all phases.
TEST_F(CompareMapsTest, RowsAreJudgedWithTheirBorder) {
  const Eigen::Matrix4d ours = MatrixOf(Compare(kSun).lightfit());
  Eigen::Matrix4d aside = ours;  // half of it outside
  aside.row(0) += 0.5 * options_.map.width * aside.row(3);
  options_.given = {
      {"lit", OneMap(aside, options_.map), {}},
      {"dark", OneMap(aside, options_.map, Border::kDark), {}},
      {"dark by name", std::nullopt, {{"sun", OneMap(aside, options_.map, Border::kDark)}}}};
  const LightComparison comparison = Compare(kSun);
  const std::vector<Lighting> truth = TrueLighting(*caster_, stage_.screen, kSun);
  for (const ComparedRow& row : comparison.rows) {
    SCOPED_TRACE(row.name);
    const bool is_dark = row.name.rfind("dark", 0) == 0;
    EXPECT_EQ(row.border(), is_dark ? Border::kDark : Border::kLit);
    const absl::StatusOr<ShadowImage> judged =
        JudgeMatrix(*caster_,
                    stage_.screen,
                    truth,
                    kSun,
                    {MatrixOf(row), options_.map, row.border()},
                    {.phases = 4});
    ASSERT_THAT(judged, IsOk());
    EXPECT_EQ(row.wrong->ideal, judged->wrong.ideal);
    EXPECT_EQ(row.wrong->practical, judged->wrong.practical);
    EXPECT_EQ(row.wrong->outside, judged->wrong.outside);
  }
  EXPECT_GT(comparison.Find("dark")->wrong->outside, 0);
  EXPECT_NE(comparison.Find("dark")->wrong->outside, comparison.Find("lit")->wrong->outside);
}

TEST_F(CompareMapsTest, UnusableMatricesHaveARowThatSaysWhy) {
  const Eigen::Matrix4d of_sun = MatrixOf(Compare(kSun).lightfit());
  Eigen::Matrix4d not_finite = of_sun;
  not_finite(0, 0) = NAN;
  options_.given = {{"other sun", OneMap(of_sun, options_.map), {}},
                    {"not finite", OneMap(not_finite, options_.map), {}},
                    {"none", std::nullopt, {{"moon", OneMap(of_sun, options_.map)}}}};
  const LightComparison comparison = Compare(Light::Directional("lamp", {1, -1, 0.3}));
  EXPECT_THAT(comparison.Find("other sun")->status,
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("do not leave the light")));
  EXPECT_THAT(comparison.Find("not finite")->status,
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("not finite")));
  EXPECT_THAT(comparison.Find("none")->status,
              StatusIs(absl::StatusCode::kNotFound, HasSubstr("\"moon\"")));
  EXPECT_FALSE(comparison.Find("none")->wrong.has_value());
  EXPECT_THAT(comparison.lightfit().status, IsOk());
}

// A warp whose horizon cuts through the visible floor: no energy, but pixels to count.
TEST_F(CompareMapsTest, AMatrixThatTurnsOverHasNoEnergy) {
  Eigen::Matrix4d turned = MatrixOf(Compare(kSun).lightfit());
  // w = 0 along a line of the floor: w becomes the map's own u, less than a quarter of its width.
  turned.row(3) = turned.row(0) - 0.5 * options_.map.width * turned.row(3);
  turned.row(0) = MatrixOf(Compare(kSun).lightfit()).row(3);
  options_.given = {{"turned", OneMap(turned, options_.map), {}}};
  const LightComparison comparison = Compare(kSun);
  const ComparedRow& map = *comparison.Find("turned");
  ASSERT_THAT(map.status, IsOk());
  EXPECT_FALSE(map.figures.has_value());
  EXPECT_THAT(map.note, HasSubstr("w <= 0 at "));
  EXPECT_GT(map.wrong->ideal, comparison.lightfit().wrong->ideal);
}

TEST_F(CompareMapsTest, WithoutAShadowLightfitIsTheFocusedMap) {
  const LightComparison comparison = Compare(Light::Directional("noon", {0, -1, 0}));
  EXPECT_THAT(comparison.lightfit().status, IsOk());
  EXPECT_LT(comparison.lightfit().wrong->ideal, stage_.screen.num_surface / 1000);
  const ComparedRow& focused = *comparison.Find("focused");
  EXPECT_THAT(focused.status, IsOk());
  // Beside a box the centre of the floor's texel may lie on the box.
  EXPECT_LT(focused.wrong->ideal, stage_.screen.num_surface / 1000);
}

TEST_F(CompareMapsTest, ALampAmongItsReceiversIsNamed) {
  const LightComparison comparison = Compare(Light::Point("lamp", {0, 1, 0}));
  for (const ComparedRow& map : comparison.rows) {
    SCOPED_TRACE(map.name);
    if (map.status.ok()) continue;
    EXPECT_FALSE(map.wrong.has_value());
    EXPECT_FALSE(map.figures.has_value());
    EXPECT_GT(map.status.message().size(), 20u);
  }
}

TEST_F(CompareMapsTest, AnInvalidLightFailsInEveryRow) {
  const LightComparison comparison = Compare(Light::Directional("sun", {0, 0, 0}));
  EXPECT_EQ(comparison.rows.size(), RowNames({}).size());
  for (const ComparedRow& map : comparison.rows) {
    EXPECT_THAT(map.status, StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("direction")));
  }
}

TEST_F(CompareMapsTest, AReadbackGivesTheSameEnergiesWithoutPixels) {
  const absl::StatusOr<ReadbackImage> readback =
      RenderReadback(*caster_, stage_.readback.camera, {kSun});
  ASSERT_THAT(readback, IsOk());
  const Readback view = readback->View();
  const absl::StatusOr<CompareStage> stage = MakeStage(view);
  ASSERT_THAT(stage, IsOk());
  const LightComparison alone = CompareMaps(*stage, kSun, options_);
  const LightComparison with_scene = Compare(kSun);
  // The published set-ups take the scene's box, which a read-back does not know.
  for (const char* name : {"as-published", "line", "lightfit"}) {
    SCOPED_TRACE(name);
    EXPECT_EQ(alone.Find(name)->figures->energy, with_scene.Find(name)->figures->energy);
  }
  for (const ComparedRow& map : alone.rows) {
    SCOPED_TRACE(map.name);
    EXPECT_THAT(map.status, IsOk());
    EXPECT_TRUE(map.figures.has_value()) << map.note;
    EXPECT_FALSE(map.wrong.has_value());
  }
}

TEST_F(CompareMapsTest, ShadowBitsDoNotMatter) {
  Light other = kSun;
  other.shadow_bit = 31;
  const LightComparison a = Compare(kSun), b = Compare(other);
  EXPECT_EQ(b.light.shadow_bit, 31);
  for (size_t row = 0; row < a.rows.size(); ++row) {
    EXPECT_EQ(MatrixOf(a.rows[row]), MatrixOf(b.rows[row]));
    EXPECT_EQ(a.rows[row].wrong->practical, b.rows[row].wrong->practical);
  }
}

TEST_F(CompareMapsTest, CallsBeforeEachRow) {
  std::vector<std::string> begun;
  options_.before_row = [&begun](const std::string& name) { begun.push_back(name); };
  Compare(kSun);
  EXPECT_EQ(begun, RowNames({}));
}

TEST(CompareStage, EncloseWhatIsVisible) {
  const absl::StatusOr<RayCaster> caster = RayCaster::Build(BoxesOnFloor());
  ASSERT_THAT(caster, IsOk());
  const absl::StatusOr<CompareStage> stage = MakeStage(*caster, BoxesCamera(64, 64), 32, 32);
  ASSERT_THAT(stage, IsOk());
  EXPECT_EQ(stage->readback.width(), 32);
  EXPECT_GT(stage->view.camera.near, 0);
  EXPECT_TRUE(std::isfinite(stage->view.camera.far));
  for (const SurfacePoint& pixel : stage->screen.pixels) {
    if (!pixel.is_surface()) continue;
    EXPECT_GT(pixel.camera_z, stage->view.camera.near);
    EXPECT_LT(pixel.camera_z, stage->view.camera.far);
  }
  // Most of what is seen is the floor.
  ASSERT_TRUE(stage->view.plane.has_value());
  EXPECT_GT(std::abs(stage->view.plane->normal().y()), 0.999);
  EXPECT_NEAR(stage->view.plane->absDistance(Eigen::Vector3d(3, 0, 5)), 0, 1e-3);
}

TEST(CompareStage, RefusesACameraThatSeesNothing) {
  const absl::StatusOr<RayCaster> caster = RayCaster::Build(BoxesOnFloor());
  ASSERT_THAT(caster, IsOk());
  const Camera away = *LookAtCamera({0, 2, 11}, {0, 30, 11.1}, {0, 0, 1}, 0.5, 16, 16);
  EXPECT_THAT(MakeStage(*caster, away, 8, 8),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("sees no surface")));
}

}  // namespace
}  // namespace lightfit
