// Work that is asked to stop at a random moment says so, or is done all the same.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "base/stop.h"
#include "optimizer/evaluate.h"
#include "optimizer/fit.h"
#include "optimizer/search/refine_ceres.h"
#include "optimizer/sizing/allocation.h"
#include "optimizer/sizing/map_shapes.h"
#include "optimizer/sizing/tolerance.h"
#include "optimizer/tracking/tracker.h"
#include "tests/optimizer/tracking/hanging_lamp.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::Random;
using testing::StatusIs;
using testing::TestScene;

using Clock = std::chrono::steady_clock;

constexpr auto kCancelled = absl::StatusCode::kCancelled;
constexpr MapSize kMap = {512, 256};

// Every bit of a result, or its error.
std::string TextOf(const LightMatrix& matrix) {
  std::string text = absl::StrFormat("%s evaluations %d, energy %a, %a, footprint %a %a %a %a",
                                     std::string(matrix.light_name),
                                     matrix.search.evaluations,
                                     matrix.figures.energy,
                                     matrix.search.energy_start,
                                     matrix.figures.footprint.rms,
                                     matrix.figures.footprint.median,
                                     matrix.figures.footprint.p99,
                                     matrix.figures.footprint.worst);
  for (const double entry : matrix.map_from_world.reshaped())
    absl::StrAppendFormat(&text, " %a", entry);
  return text;
}
std::string TextOf(const TrackedMatrix& tracked) {
  return absl::StrFormat(
      "%s %d %s", TrackerActionName(tracked.action), tracked.frames_kept, TextOf(tracked.matrix));
}
std::string TextOf(const ToleranceMap& map) {
  return absl::StrFormat("%d %a %s", map.is_met, map.reached_px, TextOf(map.matrix));
}
std::string TextOf(const Figures& figures) {
  return absl::StrFormat("%a %a %a %a %d",
                         figures.energy,
                         figures.wrong_share.value_or(-1.0),
                         figures.footprint.median,
                         figures.footprint.p99,
                         figures.samples.used);
}
std::string TextOf(const Summary& summary) {
  std::string text = absl::StrFormat("%a %a", summary.total_weight, summary.footprint_sum);
  for (const double entry : summary.tensor.entries().reshaped())
    absl::StrAppendFormat(&text, " %a", entry);
  for (const Eigen::Vector2d& ray : summary.cover.hull)
    absl::StrAppendFormat(&text, " %a %a", ray.x(), ray.y());
  return text;
}
template <typename Results>
absl::StatusOr<std::string> TextOfAll(const Results& results) {
  std::string text;
  for (const auto& result : results) {
    if (absl::IsCancelled(result.status())) return result.status();
    text += (result.ok() ? TextOf(*result) : result.status().ToString()) + "\n";
  }
  return text;
}
template <typename T>
absl::StatusOr<std::string> TextOfResult(const absl::StatusOr<T>& result) {
  if (!result.ok()) return result.status();
  return TextOf(*result);
}

using Call = std::function<absl::StatusOr<std::string>()>;

// One call, asked to stop after a random share of `whole`.
absl::StatusOr<std::string> StopOnce(const Call& call, Clock::duration whole, Random* random) {
  const auto delay = std::chrono::duration_cast<Clock::duration>(random->Uniform(0.0, 1.0) * whole);
  std::stop_source source;
  std::thread stopper([&source, delay] {
    std::this_thread::sleep_for(delay);
    source.request_stop();
  });
  const StopScope stop_scope(source.get_token());
  absl::StatusOr<std::string> result = call();
  stopper.join();
  return result;
}

// Runs the call through once, then stops it at `num_stops` random moments: it may say so, or be
// done all the same, with the same result.
void ExpectCancelledOrTheSame(int num_stops, Random* random, const Call& call) {
  const Clock::time_point begin = Clock::now();
  const absl::StatusOr<std::string> expected = call();
  const Clock::duration whole = Clock::now() - begin;
  ASSERT_THAT(expected, IsOk());
  for (int i = 0; i < num_stops; ++i) {
    const absl::StatusOr<std::string> result = StopOnce(call, whole, random);
    if (result.ok()) {
      EXPECT_EQ(*result, *expected);
    } else {
      EXPECT_THAT(result, StatusIs(kCancelled, HasSubstr("stopped")));
    }
  }
}

Call FittingAll(const TestScene& scene, const FitOptions& options) {
  return [&scene, options]() {
    return TextOfAll(FitLights(scene.View(), scene.lights, kMap, options));
  };
}

TEST(StopMoments, FitsAreCancelledOrTheSameWheneverItIsAskedFor) {
  Random random(31);
  const TestScene small(/*seed=*/3, /*num_lights=*/3);
  const TestScene large(/*seed=*/3, /*num_lights=*/1, 640, 360);
  ExpectCancelledOrTheSame(30, &random, FittingAll(small, {}));
  ExpectCancelledOrTheSame(10, &random, FittingAll(large, {}));
  ExpectCancelledOrTheSame(6, &random, FittingAll(large, FitOptions::AsPublished()));
  for (const Metric metric : {Metric::kL2, Metric::kL1}) {
    for (const Search search : {Search::kFocused, Search::kRotationLineSearchRefined}) {
      FitOptions options;
      options.metric = metric;
      options.search = search;
      if (HasCeres()) options.refiner = Refiner::kCeres;
      ExpectCancelledOrTheSame(10, &random, FittingAll(small, options));
    }
  }
}

TEST(StopMoments, SummariesAndFiguresAreCancelledOrTheSameWheneverItIsAskedFor) {
  Random random(32);
  const TestScene scene(/*seed=*/3, /*num_lights=*/1, 160, 120);
  const Light& light = scene.lights[0];
  const Readback readback = scene.View();
  const Eigen::Matrix4d map_from_world = FitLight(readback, light, kMap)->map_from_world;
  const Summary summary = *Summarize(readback, light);
  FitOptions options;
  const auto expect = [&](const std::function<absl::StatusOr<std::string>()>& call) {
    ExpectCancelledOrTheSame(6, &random, [&]() { return call(); });
  };
  expect([&] { return TextOfResult(Summarize(readback, light, options)); });
  expect([&] { return TextOfResult(SummarizeInMap(readback, light, map_from_world, options)); });
  expect([&] { return TextOfResult(SummarizeForAnyAspect(readback, light, options)); });
  expect([&] { return TextOfResult(Fit(summary, light, kMap, options)); });
  expect(
      [&] { return TextOfResult(EvaluateMatrix(readback, light, map_from_world, kMap, options)); });
}

TEST(StopMoments, CoversOfCloseLampsAreCancelledOrTheSameWheneverItIsAskedFor) {
  Random random(36);
  const testing::HangingLamp lamp(640, 360);
  FitOptions options;
  options.search = Search::kFocused;
  ExpectCancelledOrTheSame(20, &random, [&]() {
    return TextOfResult(FitLight(lamp.readback.View(), lamp.light, kMap, options));
  });
}

TEST(StopMoments, TolerancesAreCancelledOrTheSameWheneverItIsAskedFor) {
  Random random(33);
  const TestScene scene(/*seed=*/3, /*num_lights=*/1);
  for (const auto kind : {Tolerance::Kind::kRms, Tolerance::Kind::kP99}) {
    ExpectCancelledOrTheSame(5, &random, [&]() {
      FitOptions options;
      return TextOfResult(
          MeetTolerance(scene.View(), scene.lights[0], {kind, 1.0, 1.0}, {}, options));
    });
  }
}

TEST(StopMoments, AllocationsAreCancelledOrTheSameWheneverItIsAskedFor) {
  Random random(34);
  const TestScene scene(/*seed=*/4, /*num_lights=*/32);
  FitOptions options;
  options.metric = Metric::kL2;
  options.search = Search::kRotationLineSearch;
  std::vector<AllocationLight> lights;
  for (const Light& light : scene.lights) {
    lights.push_back({light, Summarize(scene.View(), light, options), 1.0});
  }
  ExpectCancelledOrTheSame(4, &random, [&]() -> absl::StatusOr<std::string> {
    const absl::StatusOr<Allocation> allocation =
        AllocateBudget(lights, int64_t{2048} * 2048, {}, options);
    if (!allocation.ok()) return allocation.status();
    std::string text = absl::StrFormat("%d %a ", allocation->texels, allocation->energy);
    for (const AllocatedMap& map : allocation->maps) {
      EXPECT_FALSE(absl::IsCancelled(map.matrix.status()));
      text += map.matrix.ok() ? TextOf(*map.matrix) : map.matrix.status().ToString();
    }
    return text;
  });
}

// A camera that walks sideways past three lights.
class Walk {
 public:
  explicit Walk(uint64_t seed) {
    const BoxScene scene = MakeBoxScene(seed);
    lights_ = RandomLights(scene, seed, 3);
    Camera camera = RandomCamera(scene, seed, 96, 64);
    for (int i = 0; i < kNumFrames; ++i) {
      views_.push_back(Render(scene, camera, lights_));
      camera.camera_from_world(0, 3) += 0.2;  // metres
    }
  }

  // Every other frame brings the lights in another order, and one of them only comes and goes.
  absl::StatusOr<std::string> Update(int frame, Tracker* tracker) const {
    std::vector<Light> lights(lights_.begin(), lights_.end() - (frame % 3 == 2 ? 1 : 0));
    if (frame % 2 == 1) std::swap(lights.front(), lights.back());
    return TextOfAll(tracker->Update(views_[frame].View(), lights, kMap));
  }

  static constexpr int kNumFrames = 8;

 private:
  std::vector<Light> lights_;
  std::vector<SyntheticReadback> views_;
};

TEST(StopMoments, TrackerGoesOnAsIfTheStoppedFrameHadNotBeen) {
  Random random(35);
  std::stop_source beforehand;
  beforehand.request_stop();
  const Walk walk(/*seed=*/5);
  for (const TrackerOptions& options : {TrackerOptions::ForStability(0.0),
                                        TrackerOptions::ForStability(0.5),
                                        TrackerOptions::AsPublished()}) {
    Tracker steady(options), stopped(options);
    int num_cancelled = 0;
    for (int frame = 0; frame < Walk::kNumFrames; ++frame) {
      const Clock::time_point begin = Clock::now();
      const absl::StatusOr<std::string> expected = walk.Update(frame, &steady);
      const Clock::duration whole = Clock::now() - begin;
      ASSERT_THAT(expected, IsOk());
      {
        const StopScope stop_scope(beforehand.get_token());
        EXPECT_THAT(walk.Update(frame, &stopped), StatusIs(kCancelled, HasSubstr("light")));
      }
      // In the middle of it; a frame that comes through all the same is the frame.
      const auto update = [&]() { return walk.Update(frame, &stopped); };
      absl::StatusOr<std::string> result = StopOnce(update, whole, &random);
      if (absl::IsCancelled(result.status())) {
        ++num_cancelled;
        result = walk.Update(frame, &stopped);
      }
      ASSERT_THAT(result, IsOk());
      EXPECT_EQ(*result, *expected) << "frame " << frame;
    }
    std::printf("%d of %d frames were stopped in the middle\n", num_cancelled, Walk::kNumFrames);
  }
}

}  // namespace
}  // namespace lightfit
