#include "partition/evaluate_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "geometry/homography.h"
#include "optimizer/evaluate.h"
#include "optimizer/fit.h"
#include "partition/fit_plan.h"
#include "tests/testing/matchers.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;
using testing::TestScene;

// Sums of the same numbers in another order, in rays of another frame.
constexpr double kRelativeTolerance = 1e-9;

void ExpectNear(double value, double expected) {
  EXPECT_NEAR(value, expected, kRelativeTolerance * std::abs(expected));
}

FitOptions Automatic() {
  FitOptions options;
  options.border = BorderChoice::kAutomatic;
  return options;
}

// A light of a random scene with a view for a border, and what they refer to.
struct Seen {
  TestScene scene;
  Surfaces surfaces;

  explicit Seen(uint64_t seed)
      : scene(seed, 3, 120, 90),
        surfaces(*FindSurfaces(scene.readback.ViewWithFacing(), 0x7, SampleOptions())) {}
  Seen(const Seen&) = delete;

  LightView View(const Light& light, Border border) const {
    return *ViewLight(surfaces, light, border, Automatic());
  }
};

absl::StatusOr<LightPlan> FourMaps(const Seen& seen, const Light& light) {
  PlanOptions options;
  options.fit = Automatic();
  options.texels = 160000;
  options.choose_by_forecast = false;
  return FitPlan(seen.surfaces, light, options);
}

TEST(EvaluatePlan, OfOneMapThatHoldsEverythingIsThatOfTheMatrix) {
  int num_cases = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(seed);
    const Seen seen(seed);
    const Light& sun = seen.scene.lights[0];
    const LightView view = seen.View(sun, Border::kLit);
    if (view.samples.size() == 0) continue;
    ++num_cases;
    FitOptions all = Automatic();
    all.cover = Cover::kReceivers;
    const absl::StatusOr<LightMatrix> matrix =
        FitLight(*ViewLight(seen.surfaces, sun, Border::kLit, all), {300, 200}, all);
    ASSERT_THAT(matrix, IsOk());
    const Plan plan = {
        matrix->light_name, Border::kLit, {{matrix->map_from_world, {300, 200}, {}}}};
    const absl::StatusOr<Figures> figures = EvaluatePlan(view, plan, Automatic());
    const absl::StatusOr<Figures> expected =
        EvaluateMatrix(view, matrix->map_from_world, {300, 200}, Automatic());
    ASSERT_THAT(figures, IsOk());
    ASSERT_THAT(expected, IsOk());
    EXPECT_EQ(figures->footprint.num_behind, 0);
    EXPECT_EQ(figures->samples.used, expected->samples.used);
    EXPECT_EQ(*figures->wrong_share, *expected->wrong_share);
    ExpectNear(figures->energy, expected->energy);
    ExpectNear(figures->footprint.rms, expected->footprint.rms);
    ExpectNear(figures->footprint.median, expected->footprint.median);
    ExpectNear(figures->footprint.p99, expected->footprint.p99);
    ExpectNear(figures->footprint.worst, expected->footprint.worst);
  }
  EXPECT_GE(num_cases, 3);
}

TEST(EvaluatePlan, HasTheEnergyThatTheFitSays) {
  int num_cases = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(seed);
    const Seen seen(seed);
    for (const Light& light : seen.scene.lights) {
      const absl::StatusOr<LightPlan> plan = FourMaps(seen, light);
      if (!plan.ok() || plan->energy == 0.0) continue;
      ++num_cases;
      const absl::StatusOr<Figures> figures =
          EvaluatePlan(seen.View(light, plan->border), PlanOf(*plan), Automatic());
      ASSERT_THAT(figures, IsOk());
      ExpectNear(figures->energy, plan->energy);
    }
  }
  EXPECT_GE(num_cases, 9);
}

// Each sample in the map of least q that holds it, found by trying all.   math.md (18), (20), (2)
TEST(EvaluatePlan, FootprintsAreThoseOfTheMapsAsked) {
  int num_cases = 0;
  for (const double guard : {0.0, 3.0}) {
    const Seen seen(2);
    for (const Light& light : seen.scene.lights) {
      SCOPED_TRACE(light.name);
      const absl::StatusOr<LightPlan> fitted = FourMaps(seen, light);
      if (!fitted.ok() || fitted->energy == 0.0) continue;
      ++num_cases;
      const LightView view = seen.View(light, fitted->border);
      double sum_squared = 0.0, sum_weight = 0.0, worst = 0.0;
      int64_t num_outside = 0;
      for (size_t i = 0; i < view.samples.size(); ++i) {
        const Sample sample = view.samples.At(i);
        double least = 1e300, footprint = -1.0;
        for (const LightMatrix& map : fitted->maps) {
          const Eigen::Matrix3d H =
              *MapFromRay(map.map_from_world, light) * view.normalized_from_ray().inverse();
          const Eigen::Vector3d at = H * sample.X;
          const double u = at.x() / at.z(), v = at.y() / at.z();
          const double q = at.z() / std::cbrt(std::abs(H.determinant()));
          const bool holds = at.z() > 0.0 && u >= guard && v >= guard &&
                             u < map.map.width - guard && v < map.map.height - guard;
          if (!holds || q >= least) continue;
          least = q;
          footprint = std::sqrt(0.5) * Footprint(H, sample).norm();
        }
        if (footprint < 0.0) {
          ++num_outside;
          continue;
        }
        sum_squared += sample.weight * footprint * footprint;
        sum_weight += sample.weight;
        worst = std::max(worst, footprint);
      }
      const absl::StatusOr<Figures> figures =
          EvaluatePlan(view, PlanOf(*fitted), Automatic(), guard);
      ASSERT_THAT(figures, IsOk());
      EXPECT_EQ(figures->footprint.num_behind, num_outside);
      ExpectNear(figures->footprint.rms, std::sqrt(sum_squared / sum_weight));
      ExpectNear(figures->footprint.worst, worst);
    }
  }
  EXPECT_GE(num_cases, 4);
}

TEST(EvaluatePlan, MeasuringIsTheSameWithoutTheForecast) {
  const Seen seen(2);
  const Light& light = seen.scene.lights[0];
  const absl::StatusOr<LightPlan> fitted = FourMaps(seen, light);
  ASSERT_THAT(fitted, IsOk());
  const LightView view = seen.View(light, fitted->border);
  const absl::StatusOr<Figures> whole = EvaluatePlan(view, PlanOf(*fitted), Automatic());
  const absl::StatusOr<Figures> measured = MeasurePlan(view, PlanOf(*fitted), Automatic());
  ASSERT_THAT(whole, IsOk());
  ASSERT_THAT(measured, IsOk());
  EXPECT_TRUE(whole->wrong_share.has_value());
  EXPECT_FALSE(measured->wrong_share.has_value());
  EXPECT_EQ(measured->energy, whole->energy);
  EXPECT_EQ(measured->footprint.p99, whole->footprint.p99);
  ScratchVector<Figures> of_maps;
  const absl::StatusOr<Figures> with_maps =
      MeasurePlan(view, PlanOf(*fitted), Automatic(), /*guard_texels=*/0.0, &of_maps);
  ASSERT_THAT(with_maps, IsOk());
  EXPECT_EQ(with_maps->energy, whole->energy);
  double energy = 0.0;
  for (const Figures& of_map : of_maps) energy += of_map.energy;
  EXPECT_EQ(energy, whole->energy);
}

TEST(EvaluatePlan, SaysWhatIsWrong) {
  const Seen seen(1);
  const Light& sun = seen.scene.lights[0];
  const LightView view = seen.View(sun, Border::kLit);
  EXPECT_THAT(EvaluatePlan(view, Plan{}, Automatic()),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("0 maps")));
  FitOptions dark = Automatic();
  dark.border = BorderChoice::kDark;
  EXPECT_THAT(EvaluatePlan(view, Plan{}, dark),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("options.border")));
}

}  // namespace
}  // namespace lightfit
