#include "partition/tracking/async_planner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "optimizer/fit.h"
#include "partition/plan_uniforms.h"
#include "tests/testing/frame_loop.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using testing::BoxWalk;
using testing::Fill;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::PollLast;
using testing::StatusIs;

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

PlanTrackerOptions OptionsOf(int max_maps, double stability) {
  PlanTrackerOptions options = PlanTrackerOptions::ForStability(stability);
  options.plan.max_maps = max_maps;
  options.plan.each = MapSize{128, 128};
  options.plan.choose_by_forecast = false;
  return options;
}

AsyncPlanner StartPlanner(const PlanTrackerOptions& options) {
  return std::move(AsyncPlanner::Start(options).value());
}

const FramePlans& RunFrame(AsyncPlanner& planner,
                           const SyntheticReadback& view,
                           absl::Span<const Light> lights,
                           int64_t frame) {
  Fill(view, lights, frame, &planner.Lend());
  planner.Submit();
  return PollLast(planner, frame);
}

void ExpectSame(const FramePlan& plan, const absl::StatusOr<TrackedPlan>& expected) {
  ASSERT_EQ(plan.status, expected.status()) << plan.name;
  if (!expected.ok()) return;
  EXPECT_EQ(plan.border, expected->plan.border);
  EXPECT_EQ(plan.energy, expected->plan.energy);
  ASSERT_EQ(plan.num_maps, static_cast<int>(expected->plan.maps.size()));
  for (int k = 0; k < plan.num_maps; ++k) {
    EXPECT_EQ(plan.maps[k].map_from_world, expected->plan.maps[k].map_from_world);
    EXPECT_EQ(plan.maps[k].size.width, expected->plan.maps[k].map.width);
    EXPECT_EQ(plan.maps[k].size.height, expected->plan.maps[k].map.height);
    EXPECT_EQ(plan.maps[k].action, expected->actions[k]);
  }
}

TEST(AsyncPlanner, PlansAreThoseOfTheTrackersWhateverChangesBetweenFrames) {
  constexpr uint64_t kSeed = 3;
  SCOPED_TRACE(kSeed);
  const BoxWalk walk(kSeed, /*num_lights=*/3, /*num_views=*/6, 64, 48);
  AsyncPlanner planner = StartPlanner(OptionsOf(4, 0.5));
  std::vector<PlanTracker> trackers;
  for (const Light& light : walk.lights) trackers.emplace_back(light, OptionsOf(4, 0.5));
  int num_kept = 0;
  for (int64_t frame = 0; frame < 6; ++frame) {
    SCOPED_TRACE(frame);
    const PlanTrackerOptions options = OptionsOf(frame < 4 ? 4 : 2, 0.5);
    ASSERT_THAT(planner.SetOptions(options), IsOk());
    const FramePlans& plans = RunFrame(planner, walk.views[frame], walk.lights, frame);
    ASSERT_EQ(plans.num_lights, 3);
    const auto surfaces = FindSurfaces(walk.views[frame].View(), LightMask(walk.lights), {});
    ASSERT_THAT(surfaces, IsOk());
    for (size_t i = 0; i < walk.lights.size(); ++i) {
      EXPECT_EQ(plans.Find(walk.lights[i].name), &plans.lights[i]);
      trackers[i].set_options(options);
      ExpectSame(plans.lights[i], trackers[i].Update(*surfaces));
      for (int k = 0; k < plans.lights[i].num_maps; ++k) {
        num_kept += plans.lights[i].maps[k].action == TrackerAction::kKept ? 1 : 0;
      }
    }
    EXPECT_EQ(plans.Find("nobody"), nullptr);
  }
  EXPECT_GT(num_kept, 0);
}

TEST(AsyncPlanner, PlansAreReadyForTheShader) {
  const BoxWalk walk(/*seed=*/5, /*num_lights=*/1, /*num_views=*/1, 64, 48);
  AsyncPlanner planner = StartPlanner(OptionsOf(3, 0.5));
  const FramePlan& plan = RunFrame(planner, walk.views[0], walk.lights, 1).lights[0];
  ASSERT_THAT(plan.status, IsOk());
  const Plan maps = plan.ToPlan();
  EXPECT_EQ(maps.maps.size(), 3u);
  EXPECT_EQ(NumTexels(maps), 3 * 128 * 128);
  const std::vector<Eigen::Vector2i> offsets = {{0, 0}, {128, 0}, {256, 0}};
  EXPECT_THAT(MakePlanUniforms(maps, walk.lights[0], 0.0, offsets), IsOk());
}

TEST(AsyncPlanner, ALightThatVanishedComesBackAsNew) {
  const BoxWalk walk(/*seed=*/5, /*num_lights=*/2, /*num_views=*/1, 64, 64);
  AsyncPlanner planner = StartPlanner(OptionsOf(2, 1.0));
  const absl::Span<const Light> both = walk.lights, lamp = both.subspan(1);
  const auto action = [&](const FramePlans& plans) {
    const FramePlan* plan = plans.Find(walk.lights[0].name);
    return plan->maps[0].action;
  };
  EXPECT_EQ(action(RunFrame(planner, walk.views[0], both, 1)), TrackerAction::kFirst);
  EXPECT_EQ(action(RunFrame(planner, walk.views[0], both, 2)), TrackerAction::kKept);
  EXPECT_EQ(RunFrame(planner, walk.views[0], lamp, 3).Find(walk.lights[0].name), nullptr);
  EXPECT_EQ(action(RunFrame(planner, walk.views[0], both, 4)), TrackerAction::kFirst);
}

TEST(AsyncPlanner, SaysWhatIsWrong) {
  EXPECT_THAT(AsyncPlanner::Start(OptionsOf(33, 0.5)).status(),
              StatusIs(kInvalid, HasSubstr("max_maps = 33")));
  const BoxWalk walk(/*seed=*/5, /*num_lights=*/1, /*num_views=*/1, 48, 32);
  AsyncPlanner planner = StartPlanner(OptionsOf(2, 0.5));
  EXPECT_THAT(planner.SetOptions(OptionsOf(0, 0.5)), StatusIs(kInvalid, HasSubstr("max_maps = 0")));
  Fill(walk.views[0], walk.lights, 1, &planner.Lend());
  planner.Lend().depth.pop_back();
  planner.Submit();
  EXPECT_THAT(PollLast(planner, 1).lights[0].status,
              StatusIs(kInvalid, HasSubstr("readback.depth")));
  const std::vector<Light> many(kMaxLights + 1, walk.lights[0]);
  const FramePlans& plans = RunFrame(planner, walk.views[0], many, 2);
  EXPECT_EQ(plans.num_lights, kMaxLights);
  EXPECT_THAT(plans.lights[0].status, StatusIs(kInvalid, HasSubstr("lights: 33 of them")));
  EXPECT_THAT(RunFrame(planner, walk.views[0], walk.lights, 3).lights[0].status, IsOk());
}

// What comes of a planner that took another's place is of its own frames and options alone.
TEST(AsyncPlanner, MayBeReplacedWithAFrameInWork) {
  const BoxWalk walk(/*seed=*/7, /*num_lights=*/3, /*num_views=*/2, 64, 48);
  AsyncPlanner planner = StartPlanner(OptionsOf(32, 0.5));
  Fill(walk.views[0], walk.lights, 1, &planner.Lend());
  planner.Submit();
  planner = StartPlanner(OptionsOf(2, 0.5));
  EXPECT_EQ(planner.counts().submitted, 0);
  EXPECT_EQ(planner.Poll(), nullptr);
  const FramePlans& plans = RunFrame(planner, walk.views[1], walk.lights, 2);
  const auto surfaces = FindSurfaces(walk.views[1].View(), LightMask(walk.lights), {});
  ASSERT_THAT(surfaces, IsOk());
  ASSERT_EQ(plans.num_lights, 3);
  for (size_t i = 0; i < walk.lights.size(); ++i) {
    PlanTracker alone(walk.lights[i], OptionsOf(2, 0.5));
    ExpectSame(plans.lights[i], alone.Update(*surfaces));
  }
  EXPECT_EQ(planner.counts().submitted, 1);
}

}  // namespace
}  // namespace lightfit
