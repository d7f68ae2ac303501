#include "base/stop.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "optimizer/evaluate.h"
#include "optimizer/figures/foretell.h"
#include "optimizer/fit.h"
#include "optimizer/fit_matrix.h"
#include "optimizer/light_view.h"
#include "optimizer/search/global_search.h"
#include "optimizer/search/polish.h"
#include "optimizer/search/refine.h"
#include "optimizer/sizing/allocation.h"
#include "optimizer/sizing/map_shapes.h"
#include "optimizer/sizing/tolerance.h"
#include "optimizer/tracking/tracker.h"
#include "tests/testing/fit_station.h"
#include "tests/testing/matchers.h"
#include "tests/testing/refiners.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;
using testing::TestScene;

constexpr auto kCancelled = absl::StatusCode::kCancelled;
constexpr MapSize kMap = {512, 256};

std::stop_token Stopped() {
  std::stop_source source;
  source.request_stop();
  return source.get_token();
}

TEST(Stop, AskedForBeforehandEndsEveryCallOnAReadback) {
  const TestScene scene(/*seed=*/1, /*num_lights=*/2);
  const Light& light = scene.lights[0];
  const Readback readback = scene.View();
  const FitOptions options;
  const absl::StatusOr<LightMatrix> fit = FitLight(readback, light, kMap);
  ASSERT_THAT(fit, IsOk());
  const absl::StatusOr<Surfaces> surfaces = FindSurfaces(readback, ~0u, options.samples);
  ASSERT_THAT(surfaces, IsOk());
  const absl::StatusOr<LightView> prepared = ViewLight(*surfaces, light, {});
  ASSERT_THAT(prepared, IsOk());
  ASSERT_THAT(prepared->cover, IsOk());
  const Summary summary = SummaryOfView(*prepared, options);
  const auto is_stopped = StatusIs(kCancelled, HasSubstr("stopped"));
  const StopScope stopped(Stopped());

  const LightMatrices fits = FitLights(readback, scene.lights, kMap, options);
  ASSERT_EQ(fits.size(), 2u);
  for (const auto& each : fits) EXPECT_THAT(each, is_stopped);
  EXPECT_THAT(FitLight(readback, light, kMap, options), is_stopped);
  EXPECT_THAT(Summarize(readback, light, options), is_stopped);
  EXPECT_THAT(SummarizeInMap(readback, light, fit->map_from_world, options), is_stopped);
  EXPECT_THAT(SummarizeForAnyAspect(readback, light, options), is_stopped);
  EXPECT_THAT(EvaluateMatrix(readback, light, fit->map_from_world, kMap, options), is_stopped);
  EXPECT_THAT(ForetellWrongShare(readback, light, fit->map_from_world, kMap, options.samples),
              is_stopped);
  for (const auto kind : {Tolerance::Kind::kRms, Tolerance::Kind::kP99, Tolerance::Kind::kWorst}) {
    EXPECT_THAT(MeetTolerance(readback, light, {kind, 1.0, 1.0}, {}, options), is_stopped);
  }

  EXPECT_THAT(FindSurfaces(readback, ~0u, options.samples), is_stopped);
  const auto names_light = StatusIs(kCancelled, HasSubstr("light \"" + light.name + "\""));
  for (const Cover cover : {Cover::kReceivers, Cover::kShadowed}) {
    EXPECT_THAT(CoverReceivers(*surfaces, light, cover), names_light);
  }
  EXPECT_THAT(ViewLight(*surfaces, light, options), names_light);
  const SearchInputs inputs = {light, summary, &prepared->samples, &*surfaces};
  EXPECT_THAT(FitMatrix(inputs, kMap, options), names_light);
  EXPECT_THAT(MatrixOfMap(inputs, Eigen::Matrix3d::Identity(), kMap, options), names_light);
  for (const Search search : {Search::kFocused,
                              Search::kRotationLineSearch,
                              Search::kRotationLineSearchRefined,
                              Search::kGlobal}) {
    FitOptions searching = options;
    searching.search = search;
    EXPECT_THAT(SearchAxis(inputs, kMap, searching), names_light);
    EXPECT_THAT(FitLight(readback, light, kMap, searching), is_stopped);
  }
}

TEST(Stop, AskedForBeforehandEndsEveryCallOnASummary) {
  const TestScene scene(/*seed=*/1, /*num_lights=*/1);
  const Light& light = scene.lights[0];
  for (const Metric metric : {Metric::kL2, Metric::kL1AcrossEdge}) {
    FitOptions options;
    options.metric = metric;
    const absl::StatusOr<Summary> summary = Summarize(scene.View(), light, options);
    ASSERT_THAT(summary, IsOk());
    const StopScope stopped(Stopped());
    const auto names_light = StatusIs(kCancelled, HasSubstr("light \"" + light.name + "\""));
    EXPECT_THAT(Fit(*summary, light, kMap, options), names_light);
    EXPECT_THAT(FindMapShapes(*summary, light, options), names_light);
    EXPECT_THAT(AllocateBudget({{light, *summary, 1.0}}, 1 << 20, {}, options),
                StatusIs(kCancelled, HasSubstr("allocation")));
    if (metric == Metric::kL2) {
      EXPECT_THAT(MeetTolerance(*summary, light, {}, {}, options), names_light);
    }
  }
}

TEST(Stop, ScopesNestAndEndWithTheirBlocks) {
  std::stop_source outer_source, inner_source;
  EXPECT_FALSE(StopPossible());
  {
    const StopScope outer(outer_source.get_token());
    {
      const StopScope inner(inner_source.get_token());
      EXPECT_TRUE(StopPossible());
      EXPECT_FALSE(StopRequested());
      outer_source.request_stop();
      EXPECT_TRUE(StopRequested());
    }
    EXPECT_TRUE(StopRequested());
    std::thread([] { EXPECT_FALSE(StopRequested()); }).join();
  }
  EXPECT_FALSE(StopRequested());
  const StopScope never{std::stop_token()};
  EXPECT_FALSE(StopPossible());
}

// What cannot be used is said whether or not there was time to use it.
TEST(Stop, WrongInputsAreStillCalledWrong) {
  const TestScene scene(/*seed=*/1, /*num_lights=*/1);
  const StopScope stopped(Stopped());
  FitOptions options;
  options.min_w = -1.0;
  const auto is_wrong = StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("min_w"));
  EXPECT_THAT(FitLight(scene.View(), scene.lights[0], kMap, options), is_wrong);
  TrackerOptions tracker_options;
  tracker_options.fit = options;
  Tracker tracker(tracker_options);
  EXPECT_THAT(tracker.Update(scene.View(), scene.lights, kMap).front(), is_wrong);
  tracker_options.fit = {};
  tracker.set_options(tracker_options);
  EXPECT_THAT(tracker.Update(scene.View(), scene.lights, {0, 0}).front(),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("map = 0x0")));
  EXPECT_THAT(tracker.Update(scene.View(), scene.lights, kMap).front(),
              StatusIs(kCancelled, HasSubstr("stopped")));
  EXPECT_TRUE(tracker.state().empty());
}

TEST(Stop, NoAxisIsEvaluatedOnceItIsAskedFor) {
  const auto stations = testing::FitStations(2, Affine::kMinEnergyParallelogram);
  ASSERT_FALSE(stations.empty());
  for (const testing::FitStation& station : stations) {
    const AffineFit start = station.Start();
    const AffineProblem& problem = station.problem;
    const StopScope stopped(Stopped());
    SummaryEvaluator evaluator(station.summary, problem, testing::kMinW);
    EXPECT_FALSE(evaluator.Evaluate(Eigen::Vector3d::UnitZ()).has_value());
    RotationLineSearch(evaluator, start, /*rounds=*/3);
    for (const Refiner refiner : testing::Refiners()) {
      const SearchResult result =
          GlobalSearch(station.summary, evaluator, start, 1'000'000'000, refiner);
      EXPECT_EQ(result.fit.energy, start.energy);
      const SearchResult refined =
          RefineAxis(station.summary, problem, testing::kMinW, refiner, start);
      EXPECT_EQ(refined.report.evaluations, 0);
      EXPECT_EQ(refined.fit.energy, start.energy);
    }
    EXPECT_EQ(evaluator.num_evaluations(), 0);
    for (const Polish polish : {Polish::kQuick, Polish::kThorough, Polish::kExact}) {
      const SearchResult polished =
          PolishAxis(station.summary, problem, testing::kMinW, polish, start);
      EXPECT_EQ(polished.report.evaluations, 0);
      EXPECT_EQ(polished.fit.energy, start.energy);
    }
  }
}

TEST(Stop, EndsAFitThatWouldTakeHours) {
  const TestScene scene(/*seed=*/2, /*num_lights=*/1);
  FitOptions options;
  options.grid_directions = 1'000'000'000;
  std::stop_source source;
  const StopScope stop_scope(source.get_token());
  std::thread stopper([&source] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    source.request_stop();
  });
  EXPECT_THAT(FitLight(scene.View(), scene.lights[0], kMap, options),
              StatusIs(kCancelled, HasSubstr(scene.lights[0].name)));
  stopper.join();
}

// The station that chooses sizes is valid, if not good, however early it is stopped.
TEST(Stop, SizesChosenInHasteKeepTheBudget) {
  const MapShapes shapes = {{{4.0, 1.0}}, 0.0, 0.0};
  const StopScope stopped(Stopped());
  const std::vector<RatedSize> sizes = RateSizes(shapes, 1.0, {});
  ASSERT_FALSE(sizes.empty());
  EXPECT_EQ(ChooseSizes({sizes, sizes}, 1 << 20), std::vector<size_t>({0, 0}));
}

}  // namespace
}  // namespace lightfit
