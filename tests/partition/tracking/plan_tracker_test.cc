#include "partition/tracking/plan_tracker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/stop.h"
#include "optimizer/readback/needed_surfaces.h"
#include "optimizer/tracking/tracker.h"
#include "partition/tracking/kept_map.h"
#include "tests/partition/tracking/plan_walk.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using testing::ForEachReceiver;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::PlanWalk;
using testing::StatusIs;

constexpr int64_t kTexels = int64_t{200} * 200;
constexpr double kStep = 0.2;  // metres a frame: some pixels of the images here

PlanTrackerOptions OptionsOf(int max_maps, double stability) {
  PlanTrackerOptions options = PlanTrackerOptions::ForStability(stability);
  options.plan.max_maps = max_maps;
  options.plan.texels = kTexels;
  options.plan.choose_by_forecast = false;
  return options;
}

std::string Where(uint64_t seed, const Light& light, size_t frame) {
  return "seed " + std::to_string(seed) + ", " + light.name + ", frame " + std::to_string(frame);
}

// That a tracked plan says of itself what is so.
void ExpectConsistent(const TrackedPlan& tracked, const PlanTrackerOptions& options) {
  const size_t num_maps = tracked.plan.maps.size();
  ASSERT_EQ(tracked.actions.size(), num_maps);
  ASSERT_EQ(tracked.frames_kept.size(), num_maps);
  EXPECT_GE(num_maps, 1u);
  EXPECT_LE(num_maps, static_cast<size_t>(options.plan.max_maps));
  EXPECT_LE(NumTexels(PlanOf(tracked.plan)), options.plan.texels);
  double energy = 0.0;
  int num_redrawn = 0;
  for (size_t k = 0; k < num_maps; ++k) {
    energy += tracked.plan.maps[k].figures.energy;
    EXPECT_TRUE(tracked.plan.maps[k].map_from_world.allFinite());
    EXPECT_EQ(tracked.frames_kept[k] == 0, IsRedrawn(tracked.actions[k]));
    num_redrawn += IsRedrawn(tracked.actions[k]) ? 1 : 0;
  }
  EXPECT_EQ(tracked.NumRedrawn(), num_redrawn);
  EXPECT_NEAR(tracked.plan.energy, energy, 1e-9 * energy);
  EXPECT_TRUE(std::isfinite(tracked.best_energy));
}

// Receivers that the border would answer wrongly and no map holds; and those of them whose depth is
// out of range in the map that they ask.
void ExpectHeld(const TrackedPlan& tracked,
                const Surfaces& surfaces,
                const Light& light,
                const PlanTrackerOptions& options) {
  constexpr double kTexelTolerance = 1e-6, kDepthTolerance = 1e-7;  // rounding
  const Plan plan = PlanOf(tracked.plan);
  const double guard = std::max(0.0, options.plan.guard_texels - kTexelTolerance);
  const auto look_up = PlanLookUp::Create(plan, light, guard);
  ASSERT_THAT(look_up, IsOk());
  const NeededSurfaces needed(surfaces, light, tracked.plan.border);
  const bool all = options.plan.fit.cover == Cover::kReceivers;
  int num_outside = 0, num_out_of_depth = 0;
  ForEachReceiver(surfaces,
                  all ? absl::Span<const uint32_t>() : needed.words(),
                  uint32_t{1} << light.shadow_bit,
                  [&](const Eigen::Vector3d& world) {
                    const PlanPlace place = look_up->At(world);
                    num_outside += place.map < 0 ? 1 : 0;
                    if (place.map < 0) return;
                    const Eigen::Vector4d at =
                        plan.maps[place.map].map_from_world * world.homogeneous();
                    const double z = at.z() / at.w();
                    num_out_of_depth += z < -kDepthTolerance || z > 1.0 + kDepthTolerance ? 1 : 0;
                  });
  EXPECT_EQ(num_outside, 0);
  EXPECT_EQ(num_out_of_depth, 0);
}

// That what was done to the maps is what the actions say. Rows 0, 1 and 3 are the texels.
void ExpectActions(const TrackedPlanState& before, const TrackedPlan& tracked) {
  if (tracked.is_new) {
    EXPECT_EQ(tracked.NumRedrawn(), static_cast<int>(tracked.plan.maps.size()));
    return;
  }
  ASSERT_EQ(tracked.plan.maps.size(), before.maps.size());
  EXPECT_EQ(tracked.plan.border, before.border);
  for (size_t k = 0; k < before.maps.size(); ++k) {
    const Eigen::Matrix4d& now = tracked.plan.maps[k].map_from_world;
    const Eigen::Matrix4d& then = before.maps[k].map_from_world;
    EXPECT_EQ(tracked.plan.maps[k].map.width, before.maps[k].size.width);
    EXPECT_EQ(tracked.plan.maps[k].map.height, before.maps[k].size.height);
    if (IsRedrawn(tracked.actions[k])) continue;
    EXPECT_EQ(tracked.frames_kept[k], before.maps[k].frames_kept + 1);
    EXPECT_EQ(now.row(3), then.row(3));
    for (const int row : {0, 1}) {
      if (tracked.actions[k] == TrackerAction::kKept) {
        EXPECT_EQ(now.row(row), then.row(row));
        continue;
      }
      ASSERT_EQ(tracked.actions[k], TrackerAction::kShifted);
      const Eigen::RowVector4d moved = now.row(row) - then.row(row);
      const double texels = std::round(moved.dot(then.row(3)) / then.row(3).squaredNorm());
      EXPECT_LT((moved - texels * then.row(3)).norm(), 1e-9 * now.row(row).norm());
    }
  }
}

TEST(PlanTracker, KeepsEverythingToTheLastBitUnderACameraThatStandsStill) {
  for (uint64_t seed = 1; seed <= 2; ++seed) {
    const PlanWalk walk(seed, 1, 0.0);
    for (const Light& light : walk.lights) {
      for (const int max_maps : {1, 4}) {
        for (const double stability : {0.1, 0.5}) {
          SCOPED_TRACE(Where(seed, light, 0));
          PlanTracker tracker(light, OptionsOf(max_maps, stability));
          const auto first = tracker.Update(walk.frames[0]);
          ASSERT_THAT(first, IsOk());
          EXPECT_TRUE(first->is_new);
          EXPECT_EQ(first->actions[0], TrackerAction::kFirst);
          for (int frame = 1; frame < 5; ++frame) {
            const auto tracked = tracker.Update(walk.frames[0]);
            ASSERT_THAT(tracked, IsOk());
            EXPECT_FALSE(tracked->is_new);
            ASSERT_EQ(tracked->plan.maps.size(), first->plan.maps.size());
            for (size_t k = 0; k < first->plan.maps.size(); ++k) {
              EXPECT_EQ(tracked->actions[k], TrackerAction::kKept);
              EXPECT_EQ(tracked->frames_kept[k], frame);
              EXPECT_EQ(tracked->plan.maps[k].map_from_world, first->plan.maps[k].map_from_world);
            }
            EXPECT_NEAR(tracked->plan.energy, first->plan.energy, 1e-9 * first->plan.energy);
          }
        }
      }
    }
  }
}

TEST(PlanTracker, HoldsWhatMustBeHeldAndKeepsMostMapsOnAWalk) {
  int num_kept = 0, num_shifted = 0, num_redrawn = 0, num_new = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const PlanWalk walk(seed, 7, kStep);
    for (const Light& light : walk.lights) {
      PlanTrackerOptions options = OptionsOf(4, 0.5);
      if (seed == 2) options.plan.guard_texels = 2.0;
      if (seed == 3) options.plan.fit.border = BorderChoice::kDark;
      if (seed == 4) options.plan.fit.cover = Cover::kReceivers;
      PlanTracker tracker(light, options);
      for (size_t frame = 0; frame < walk.frames.size(); ++frame) {
        SCOPED_TRACE(Where(seed, light, frame));
        const TrackedPlanState before = tracker.state();
        const auto tracked = tracker.Update(walk.frames[frame]);
        ASSERT_THAT(tracked, IsOk());
        ExpectConsistent(*tracked, options);
        ExpectHeld(*tracked, walk.frames[frame], light, options);
        ExpectActions(before, *tracked);
        num_new += tracked->is_new ? 1 : 0;
        for (const TrackerAction action : tracked->actions) {
          num_kept += action == TrackerAction::kKept ? 1 : 0;
          num_shifted += action == TrackerAction::kShifted ? 1 : 0;
          num_redrawn += IsRedrawn(action) ? 1 : 0;
        }
      }
    }
  }
  std::printf("%d kept, %d shifted, %d redrawn, %d new plans\n",
              num_kept,
              num_shifted,
              num_redrawn,
              num_new);
  EXPECT_GT(num_kept + num_shifted, num_redrawn);
  EXPECT_GT(num_shifted, 10);
  EXPECT_GT(num_redrawn, 4 * num_new);  // single maps too
}

TEST(PlanTracker, AtStabilityZeroIsTheFitOfEachFrame) {
  const PlanWalk walk(1, 2, kStep);
  for (const bool choose : {false, true}) {
    for (const Light& light : walk.lights) {
      PlanTrackerOptions options = OptionsOf(2, 0.0);
      options.plan.choose_by_forecast = choose;
      options.plan.fit.border = choose ? BorderChoice::kAutomatic : BorderChoice::kLit;
      PlanTracker tracker(light, options);
      for (const Surfaces& surfaces : walk.frames) {
        const auto tracked = tracker.Update(surfaces);
        const auto own = FitPlan(surfaces, light, options.plan);
        ASSERT_THAT(tracked, IsOk());
        ASSERT_EQ(tracked->plan.maps.size(), own->maps.size());
        EXPECT_EQ(tracked->plan.energy, own->energy);
        EXPECT_EQ(tracked->plan.border, own->border);
        for (size_t k = 0; k < own->maps.size(); ++k) {
          EXPECT_EQ(tracked->plan.maps[k].map_from_world, own->maps[k].map_from_world);
        }
      }
    }
  }
}

TEST(PlanTracker, NeverCostsMoreThanTheToleranceAllows) {
  struct Choice {
    double stability;
    int update_every_frames;
  };
  for (uint64_t seed = 1; seed <= 2; ++seed) {
    const PlanWalk walk(seed, 6, kStep);
    for (const Light& light : walk.lights) {
      for (const Choice& choice : {Choice{0.2, 1}, Choice{0.5, 3}}) {
        PlanTrackerOptions options = OptionsOf(3, choice.stability);
        options.update_every_frames = choice.update_every_frames;
        PlanTracker tracker(light, options);
        int since_update = 0;
        for (size_t frame = 0; frame < walk.frames.size(); ++frame) {
          SCOPED_TRACE(Where(seed, light, frame));
          const auto tracked = tracker.Update(walk.frames[frame]);
          ASSERT_THAT(tracked, IsOk());
          constexpr double kRounding = 1e-12;
          EXPECT_LE(tracked->plan.energy,
                    (1.0 + choice.stability) * tracked->best_energy * (1.0 + kRounding));
          since_update = tracked->is_updated ? 0 : since_update + 1;
          EXPECT_LT(since_update, choice.update_every_frames);
          if (!tracked->is_updated) continue;
          const auto own = FitPlan(walk.frames[frame], light, options.plan);
          EXPECT_EQ(tracked->best_energy, own->energy);
        }
      }
    }
  }
}

// As long as nothing but validity counts, to the last bit.
TEST(PlanTracker, OfOneMapDoesAsTheTrackerOfOneMap) {
  int num_shifted = 0, num_invalid = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const PlanWalk walk(seed, 10, kStep);
    for (const Light& light : walk.lights) {
      PlanTrackerOptions options = OptionsOf(1, 0.5);
      options.tolerance = 1e9;
      TrackerOptions of_one;
      of_one.replace_below = 0.0;
      of_one.cover_margin_percent = options.cover_margin_percent;
      PlanTracker tracker(light, options);
      Tracker tracker_of_one(of_one);
      for (size_t frame = 0; frame < walk.frames.size(); ++frame) {
        SCOPED_TRACE(Where(seed, light, frame));
        const auto plan = tracker.Update(walk.frames[frame]);
        const auto one = tracker_of_one.Update(walk.frames[frame], {&light, 1}, {200, 200});
        ASSERT_THAT(plan, IsOk());
        ASSERT_THAT(one[0], IsOk());
        ASSERT_EQ(plan->plan.maps.size(), 1u);
        EXPECT_EQ(plan->actions[0], one[0]->action);
        for (const int row : {0, 1, 3}) {
          EXPECT_LT(
              (plan->plan.maps[0].map_from_world.row(row) - one[0]->matrix.map_from_world.row(row))
                  .norm(),
              1e-9 * one[0]->matrix.map_from_world.row(row).norm());
        }
        // A fresh fit says what its search found, whose weights have a floor.
        constexpr double kFloor = 1e-3;
        EXPECT_NEAR(plan->plan.energy, one[0]->matrix.figures.energy, kFloor * plan->plan.energy);
        num_shifted += plan->actions[0] == TrackerAction::kShifted ? 1 : 0;
        num_invalid += plan->actions[0] == TrackerAction::kInvalid ? 1 : 0;
      }
    }
  }
  std::printf("%d shifted, %d invalid\n", num_shifted, num_invalid);
  EXPECT_GT(num_shifted, 3);
  EXPECT_GT(num_invalid, 3);
}

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
      const double x = (i % image.camera.width + 0.5) / image.camera.width;
      const double y = (i / image.camera.width + 0.5) / image.camera.height;
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

// A lamp between the boxes, of which no single map exists.
TEST(PlanTracker, FollowsALampAmongItsReceivers) {
  int num_lamps = 0, num_kept = 0;
  for (uint64_t seed = 1; seed <= 12 && num_lamps < 2; ++seed) {
    const BoxScene scene = MakeBoxScene(seed);
    const Camera camera = RandomCamera(scene, seed, 96, 72);
    const Eigen::Vector3d eye = camera.camera_from_world.inverse().col(3).head<3>();
    const Eigen::Vector3d forward = camera.camera_from_world.row(2).head<3>();
    const Light light = Light::Point("lamp", eye + 6.0 * forward + Eigen::Vector3d(0.0, 0.0, 0.3));
    PlanTrackerOptions options = OptionsOf(6, 0.5);
    options.plan.fit.cover = Cover::kReceivers;
    PlanTracker tracker(light, options);
    for (int frame = 0; frame < 5; ++frame) {
      Camera moved = camera;
      moved.camera_from_world(0, 3) += 0.1 * frame;
      const SyntheticReadback image = Render(scene, moved, {light});
      const auto surfaces = FindSurfaces(image.ViewWithFacing(), 1, {});
      if (!surfaces.ok()) break;
      PlanOptions one = options.plan;
      one.max_maps = 1;
      if (!absl::IsFailedPrecondition(FitPlan(*surfaces, light, one).status())) break;
      SCOPED_TRACE(Where(seed, light, frame));
      const auto tracked = tracker.Update(*surfaces);
      ASSERT_THAT(tracked, IsOk());
      ExpectHeld(*tracked, *surfaces, light, options);
      num_lamps += frame == 0 ? 1 : 0;
      num_kept += static_cast<int>(tracked->actions.size()) - tracked->NumRedrawn();
    }
  }
  EXPECT_EQ(num_lamps, 2);
  EXPECT_GT(num_kept, 10);
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

void ExpectSameState(const TrackedPlanState& a, const TrackedPlanState& b) {
  EXPECT_EQ(a.frames_since_update, b.frames_since_update);
  EXPECT_EQ(a.border, b.border);
  ASSERT_EQ(a.maps.size(), b.maps.size());
  for (size_t k = 0; k < a.maps.size(); ++k) {
    EXPECT_EQ(a.maps[k].map_from_world, b.maps[k].map_from_world);
    EXPECT_EQ(a.maps[k].frames_kept, b.maps[k].frames_kept);
  }
}

// Whenever another thread says so. What comes is the whole frame, or nothing.
TEST(PlanTracker, StopsAtAnyMomentWithoutATrace) {
  const PlanWalk walk(1, 2, 2.0);
  const Light& light = walk.lights[1];
  PlanTracker undisturbed(light, OptionsOf(4, 0.5));
  ASSERT_THAT(undisturbed.Update(walk.frames[0]), IsOk());
  const TrackedPlanState before = undisturbed.state();
  ASSERT_THAT(undisturbed.Update(walk.frames[1]), IsOk());
  int num_stopped = 0;
  for (int microseconds = 1; microseconds < 40000; microseconds *= 2) {
    PlanTracker tracker(light, OptionsOf(4, 0.5));
    tracker.set_state(before);
    std::stop_source source;
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
  std::printf("%d stopped\n", num_stopped);
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
