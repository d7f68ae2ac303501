// What a tracker of plans does when something changes between frames: options, the light, what is
// in shadow, its state; and when it is stopped or refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

#include "base/stop.h"
#include "optimizer/sizing/map_sizes.h"
#include "partition/tracking/plan_tracker.h"
#include "tests/partition/tracking/plan_walk.h"
#include "tests/partition/tracking/tracked_plan.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using testing::ExpectActions;
using testing::ExpectHeld;
using testing::ExpectSameState;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::kStep;
using testing::OptionsOf;
using testing::PlanWalk;
using testing::StatusIs;

TEST(PlanTracker, TakesANewPlanForAnotherBorder) {
  const PlanWalk walk(1, 2, kStep);
  const Light& light = walk.lights[0];
  PlanTrackerOptions options = OptionsOf(3, 0.5);
  PlanTracker tracker(light, options);
  ASSERT_THAT(tracker.Update(walk.frames[0]), IsOk());
  options.plan.fit.border = BorderChoice::kDark;
  tracker.set_options(options);
  const auto flipped = tracker.Update(walk.frames[1]);
  ASSERT_THAT(flipped, IsOk());
  EXPECT_EQ(flipped->plan.border, Border::kDark);
  EXPECT_TRUE(flipped->is_new);
  EXPECT_EQ(flipped->actions[0], TrackerAction::kReplaced);
  ExpectHeld(*flipped, walk.frames[1], light, options);
}

// A camera that stands still while all but a spot falls dark: few lit pixels are cheaper to hold.
TEST(PlanTracker, ChoosesTheBorderByForecastAtUpdates) {
  const PlanWalk walk(1, 1, 0.0);
  const Light& light = walk.lights[0];
  const SyntheticReadback& image = walk.images[0];
  const auto spot = [&](bool is_dark) {
    SyntheticReadback result = image;
    for (int i = 0; i < image.camera.width * image.camera.height; ++i) {
      const int column = i % image.camera.width, row = i / image.camera.width;
      const double x = (column + 0.5) / image.camera.width;
      const double y = (row + 0.5) / image.camera.height;
      result.shadow_bits[i] = (std::hypot(x - 0.5, y - 0.75) < 0.12) != is_dark ? ~0u : 0u;
    }
    return result;
  };
  const SyntheticReadback lit = spot(false), dark = spot(true);
  const auto lit_surfaces = FindSurfaces(lit.ViewWithFacing(), 1, {});
  const auto dark_surfaces = FindSurfaces(dark.ViewWithFacing(), 1, {});
  PlanTrackerOptions options = OptionsOf(2, 0.5);
  options.plan.fit.border = BorderChoice::kAutomatic;
  options.plan.choose_by_forecast = true;
  PlanTracker tracker(light, options);
  std::vector<Border> borders;
  for (int frame = 0; frame < 8; ++frame) {
    SCOPED_TRACE(frame);
    const Surfaces& surfaces = frame < 4 ? *lit_surfaces : *dark_surfaces;
    const auto tracked = tracker.Update(surfaces);
    ASSERT_THAT(tracked, IsOk());
    ExpectHeld(*tracked, surfaces, light, options);
    const bool flips = !borders.empty() && borders.back() != tracked->plan.border;
    EXPECT_TRUE(!flips || tracked->is_new);
    EXPECT_TRUE(!flips || tracked->is_updated);
    borders.push_back(tracked->plan.border);
  }
  EXPECT_EQ(borders[3], Border::kLit);
  EXPECT_EQ(borders[7], Border::kDark);
}

TEST(PlanTracker, GoesOnWithOtherNumbersAndSizesOfMaps) {
  const PlanWalk walk(1, 8, 0.05);
  const Light& light = walk.lights[0];
  PlanTrackerOptions options = OptionsOf(4, 1.0);
  PlanTracker tracker(light, options);
  const auto track = [&](int frame) {
    tracker.set_options(options);
    const TrackedPlanState before = tracker.state();
    auto tracked = tracker.Update(walk.frames[frame]);
    EXPECT_THAT(tracked, IsOk());
    ExpectHeld(*tracked, walk.frames[frame], light, options);
    ExpectActions(before, *tracked);
    return *std::move(tracked);
  };
  EXPECT_EQ(track(0).plan.maps.size(), 4u);
  options.plan.max_maps = 2;
  const TrackedPlan two = track(1);
  EXPECT_EQ(two.plan.maps.size(), 2u);
  EXPECT_TRUE(two.is_new);
  // More may be, but need not.
  options.plan.max_maps = 4;
  options.tolerance = 1e9;
  EXPECT_EQ(track(2).plan.maps.size(), 2u);
  options.tolerance = 0.01;
  options.update_every_frames = 1;
  EXPECT_EQ(track(3).plan.maps.size(), 4u);
  options.plan.texels /= 2;
  EXPECT_TRUE(track(4).is_new);
  options.plan.each = MapSize{96, 64};
  const TrackedPlan equal = track(5);
  EXPECT_TRUE(equal.is_new);
  for (const LightMatrix& map : equal.plan.maps) EXPECT_EQ(map.map.width, 96);
}

// Under a camera that stands still a plan is kept until a map's size is none of those that may be.
TEST(PlanTracker, KeepsAPlanAsLongAsItsSizesKeepTheRules) {
  const PlanWalk walk(1, 1, 0.0);
  for (const Light& light : walk.lights) {
    PlanTrackerOptions options = OptionsOf(3, 0.5);
    PlanTracker tracker(light, options);
    const auto track = [&](const std::optional<MapSizeRules>& sizes) {
      options.plan.sizes = sizes;
      tracker.set_options(options);
      auto tracked = tracker.Update(walk.frames[0]);
      EXPECT_THAT(tracked, IsOk());
      for (const LightMatrix& map : tracked->plan.maps) {
        EXPECT_TRUE(!sizes.has_value() || KeepsRules(map.map, *sizes));
      }
      return *std::move(tracked);
    };
    const auto rules = [](int multiple, int min_side, int max_side) {
      MapSizeRules sizes;
      sizes.multiple = multiple;
      sizes.min_side = min_side;
      sizes.max_side = max_side;
      return sizes;
    };
    track(std::nullopt);
    EXPECT_TRUE(track(rules(32, 32, 16384)).is_new);  // they were of any size
    EXPECT_FALSE(track(rules(32, 32, 16384)).is_new);
    EXPECT_FALSE(track(rules(16, 16, 4096)).is_new);
    const TrackedPlan any = track(std::nullopt);
    EXPECT_FALSE(any.is_new);
    int longest = 0, shortest = kMaxMapSide;
    for (const LightMatrix& map : any.plan.maps) {
      longest = std::max({longest, map.map.width, map.map.height});
      shortest = std::min({shortest, map.map.width, map.map.height});
    }
    EXPECT_FALSE(track(rules(32, shortest, longest)).is_new);
    EXPECT_TRUE(track(rules(32, 32, longest - 32)).is_new);
    EXPECT_TRUE(track(rules(28, 28, 16384)).is_new);
    MapSizeRules powers;
    powers.powers_of_two = true;
    powers.min_side = 32;
    EXPECT_TRUE(track(powers).is_new);
    EXPECT_FALSE(track(powers).is_new);
    EXPECT_TRUE(track(rules(32, 96, 16384)).is_new);
  }
}

TEST(PlanTracker, StartsAnewWhenTheLightMoves) {
  const PlanWalk walk(1, 2, 0.0);
  Light light = walk.lights[0];
  PlanTracker tracker(light, OptionsOf(3, 0.5));
  ASSERT_THAT(tracker.Update(walk.frames[0]), IsOk());
  light.name = "another name";
  tracker.set_light(light);
  const auto same = tracker.Update(walk.frames[0]);
  ASSERT_THAT(same, IsOk());
  EXPECT_EQ(same->NumRedrawn(), 0);
  EXPECT_EQ(same->plan.light_name, "another name");
  light.direction += Eigen::Vector3d(0.05, 0.0, 0.0);
  tracker.set_light(light);
  const auto moved = tracker.Update(walk.frames[1]);
  ASSERT_THAT(moved, IsOk());
  EXPECT_TRUE(moved->is_new);
  EXPECT_EQ(moved->actions[0], TrackerAction::kFirst);
}

TEST(PlanTracker, KeepsThePlanWhereNothingIsShadowed) {
  const PlanWalk walk(1, 1, 0.0);
  const Light& light = walk.lights[0];
  SyntheticReadback bright = walk.images[0];
  bright.shadow_bits.assign(bright.shadow_bits.size(), 0);
  const auto surfaces = FindSurfaces(bright.ViewWithFacing(), 1, {});
  ASSERT_THAT(surfaces, IsOk());
  for (const int max_maps : {1, 3}) {
    PlanTracker tracker(light, OptionsOf(max_maps, 0.5));
    const auto before = tracker.Update(walk.frames[0]);
    ASSERT_THAT(before, IsOk());
    const auto kept = tracker.Update(*surfaces);
    ASSERT_THAT(kept, IsOk());
    EXPECT_EQ(kept->NumRedrawn(), 0);
    EXPECT_EQ(kept->plan.energy, 0.0);
    for (size_t k = 0; k < before->plan.maps.size(); ++k) {
      EXPECT_EQ(kept->plan.maps[k].map_from_world, before->plan.maps[k].map_from_world);
    }
  }
}

TEST(PlanTracker, GoesOnFromItsStateAndIsTheSameEachTime) {
  const PlanWalk walk(2, 6, kStep);
  const Light& light = walk.lights[1];
  const PlanTrackerOptions options = OptionsOf(3, 0.5);
  PlanTracker one(light, options), other(light, options);
  for (size_t frame = 0; frame < walk.frames.size(); ++frame) {
    const auto tracked = one.Update(walk.frames[frame]);
    PlanTracker resumed(light, options);
    resumed.set_state(other.state());
    const auto again = resumed.Update(walk.frames[frame]);
    other.set_state(resumed.state());
    ASSERT_THAT(tracked, IsOk());
    ASSERT_THAT(again, IsOk());
    ASSERT_EQ(tracked->plan.maps.size(), again->plan.maps.size());
    EXPECT_EQ(tracked->actions, again->actions);
    for (size_t k = 0; k < again->plan.maps.size(); ++k) {
      EXPECT_EQ(tracked->plan.maps[k].map_from_world, again->plan.maps[k].map_from_world);
    }
  }
}

// Before it begins, and whenever another thread says so. What comes is the whole frame, or nothing.
TEST(PlanTracker, StopsAtAnyMomentWithoutATrace) {
  const PlanWalk walk(1, 2, 2.0);
  const Light& light = walk.lights[1];
  PlanTracker undisturbed(light, OptionsOf(4, 0.5));
  ASSERT_THAT(undisturbed.Update(walk.frames[0]), IsOk());
  const TrackedPlanState before = undisturbed.state();
  ASSERT_THAT(undisturbed.Update(walk.frames[1]), IsOk());
  int num_stopped = 0;
  for (int microseconds = 0; microseconds < 40000; microseconds = 2 * microseconds + 1) {
    PlanTracker tracker(light, OptionsOf(4, 0.5));
    tracker.set_state(before);
    std::stop_source source;
    if (microseconds == 0) source.request_stop();
    const std::jthread stopper([&source, microseconds] {
      std::this_thread::sleep_for(std::chrono::microseconds(microseconds));
      source.request_stop();
    });
    const StopScope scope(source.get_token());
    const auto tracked = tracker.Update(walk.frames[1]);
    if (!tracked.ok()) {
      EXPECT_THAT(tracked, StatusIs(absl::StatusCode::kCancelled, HasSubstr("")));
      ++num_stopped;
    }
    ExpectSameState(tracker.state(), tracked.ok() ? undisturbed.state() : before);
  }
  EXPECT_GT(num_stopped, 0);  // the first at least
}

TEST(PlanTracker, AnErrorLeavesItAsItWas) {
  constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
  const PlanWalk walk(1, 2, 2.0);  // far enough for something to be done
  const Light& light = walk.lights[0];
  const PlanTrackerOptions good = OptionsOf(3, 0.5);
  PlanTracker tracker(light, good);
  ASSERT_THAT(tracker.Update(walk.frames[0]), IsOk());
  const TrackedPlanState before = tracker.state();

  PlanTrackerOptions options = good;
  options.tolerance = -0.5;
  tracker.set_options(options);
  EXPECT_THAT(tracker.Update(walk.frames[1]),
              StatusIs(kInvalid, HasSubstr("options.tolerance = -0.5")));
  options = good;
  options.update_every_frames = 0;
  tracker.set_options(options);
  EXPECT_THAT(tracker.Update(walk.frames[1]),
              StatusIs(kInvalid, HasSubstr("update_every_frames = 0")));
  options = good;
  options.cover_margin_percent = NAN;
  tracker.set_options(options);
  EXPECT_THAT(tracker.Update(walk.frames[1]), StatusIs(kInvalid, HasSubstr("cover_margin")));
  options = good;
  options.plan.max_maps = 0;
  tracker.set_options(options);
  EXPECT_THAT(tracker.Update(walk.frames[1]), StatusIs(kInvalid, HasSubstr("max_maps = 0")));
  options = good;
  options.plan.fit.samples.depth_noise = 0.5;  // not what the surfaces were found with
  tracker.set_options(options);
  EXPECT_THAT(tracker.Update(walk.frames[1]), StatusIs(kInvalid, HasSubstr("depth_noise")));
  tracker.set_options(good);
  {
    std::stop_source source;
    source.request_stop();
    const StopScope scope(source.get_token());
    EXPECT_THAT(tracker.Update(walk.frames[1]),
                StatusIs(absl::StatusCode::kCancelled, HasSubstr("")));
  }
  ExpectSameState(tracker.state(), before);
  EXPECT_THAT(tracker.Update(walk.frames[1]), IsOk());

  PlanTracker no_light(Light::Directional("sun", {0.0, 0.0, 0.0}), good);
  EXPECT_THAT(no_light.Update(walk.frames[0]), StatusIs(kInvalid, HasSubstr("direction")));
}

}  // namespace
}  // namespace lightfit
