// The border of a map that is tracked: chosen by forecast, kept between updates, and with another
// one a new map.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "optimizer/choose_fit.h"
#include "optimizer/fit.h"
#include "optimizer/tracking/async_optimizer.h"
#include "optimizer/tracking/tracker.h"
#include "tests/testing/frame_loop.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using testing::Fill;
using testing::IsOk;
using testing::PollLast;
using testing::Random;
using testing::StartOptimizer;
using testing::TestScene;

constexpr MapSize kMap = {256, 256};

// A camera that stands still while a spot of light on all that is dark, or of shadow on all that is
// lit, wanders about.
struct Spots {
  std::vector<Light> lights;
  std::vector<SyntheticReadback> frames;

  // `dark`: frame by frame, whether most is dark.
  Spots(uint64_t seed, const std::vector<bool>& dark) {
    const TestScene scene(seed, 3);
    Random random(700 + seed);
    lights = scene.lights;
    double x = random.Uniform(0.4, 0.6), y = random.Uniform(0.7, 0.8);
    for (const bool is_dark : dark) {
      SyntheticReadback frame = scene.readback;
      const int width = frame.camera.width, height = frame.camera.height;
      for (int i = 0; i < width * height; ++i) {
        const int column = i % width, row = i / width;
        const double x_share = (column + 0.5) / width, y_share = (row + 0.5) / height;
        const bool is_spot = std::hypot(x_share - x, y_share - y) < 0.12;
        frame.shadow_bits[i] = is_spot != is_dark ? ~uint32_t{0} : 0u;
      }
      frames.push_back(std::move(frame));
      x += random.Uniform(-0.01, 0.01);
      y += random.Uniform(-0.01, 0.01);
    }
  }
};

// Long enough for updates in both, every third frame.
const std::vector<bool> kThereAndBack = {true,
                                         true,
                                         true,
                                         true,
                                         true,
                                         false,
                                         false,
                                         false,
                                         false,
                                         false,
                                         false,
                                         true,
                                         true,
                                         true,
                                         true,
                                         true};

TrackerOptions Automatic(double stability) {
  TrackerOptions options = TrackerOptions::ForStability(stability);
  options.fit.border = BorderChoice::kAutomatic;
  return options;
}

FitOptions Roomy(const TrackerOptions& options, Border border) {
  FitOptions roomy = options.fit;
  roomy.compute_statistics = true;
  roomy.margin_percent += options.cover_margin_percent;
  roomy.border = border == Border::kDark ? BorderChoice::kDark : BorderChoice::kLit;
  return roomy;
}

// The rule by hand, frame by frame.
TEST(TrackerBorder, IsThatOfTheForecastAtUpdatesAndStaysBetweenThem) {
  int num_to_dark = 0, num_to_lit = 0, num_waited = 0;
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    const Spots spots(seed, kThereAndBack);
    for (const double stability : {0.0, 0.5}) {
      const TrackerOptions options = Automatic(stability);
      Tracker tracker(options);
      for (size_t frame = 0; frame < spots.frames.size(); ++frame) {
        const Readback readback = spots.frames[frame].ViewWithFacing();
        const std::vector<TrackedState> before = tracker.state();
        const auto tracked = tracker.Update(readback, spots.lights, kMap);
        for (size_t i = 0; i < spots.lights.size(); ++i) {
          const Light& light = spots.lights[i];
          SCOPED_TRACE(light.name + ", seed " + std::to_string(seed) + ", frame " +
                       std::to_string(frame));
          ASSERT_THAT(tracked[i], IsOk());
          const Surfaces surfaces =
              *FindSurfaces(readback, uint32_t{1} << light.shadow_bit, options.fit.samples);
          FitOptions either = Roomy(options, Border::kLit);
          either.border = BorderChoice::kAutomatic;
          const Border last = before.empty() ? Border::kLit : before[i].border;
          const Border best = BorderByForecast(surfaces, light, kMap, either, last);
          const bool is_update =
              before.empty() || before[i].frames_since_update + 1 >= options.update_every_frames;
          const Border expected = is_update ? best : last;
          num_waited += best != expected ? 1 : 0;
          EXPECT_EQ(tracker.state()[i].border, expected);
          EXPECT_EQ(tracked[i]->matrix.border, expected);
          EXPECT_EQ(tracked[i]->matrix.facing, FacingSource::kGiven);
          if (before.empty()) {
            EXPECT_EQ(tracked[i]->action, TrackerAction::kFirst);
            continue;
          }
          if (expected == last) continue;
          (expected == Border::kDark ? num_to_dark : num_to_lit) += 1;
          EXPECT_EQ(tracked[i]->action, TrackerAction::kReplaced);
          EXPECT_EQ(tracked[i]->frames_kept, 0);
          EXPECT_NE(tracked[i]->matrix.map_from_world, before[i].map_from_world);
          // The map of this frame alone.
          const auto fresh = FitLight(readback, light, kMap, Roomy(options, expected));
          ASSERT_THAT(fresh, IsOk());
          EXPECT_EQ(tracked[i]->matrix.map_from_world, fresh->map_from_world);
          EXPECT_EQ(tracked[i]->matrix.figures.energy, fresh->figures.energy);
        }
      }
    }
  }
  std::printf(
      "%d times to dark, %d to lit, %d frames waited\n", num_to_dark, num_to_lit, num_waited);
  EXPECT_GE(num_to_dark, 5);
  EXPECT_GE(num_to_lit, 5);
  EXPECT_GE(num_waited, 1);
}

TEST(TrackerBorder, IsLitWithoutTheThirdStateAndWhatIsAskedForElse) {
  const Spots spots(2, {true, true, false, false});
  for (const BorderChoice choice :
       {BorderChoice::kLit, BorderChoice::kDark, BorderChoice::kAutomatic}) {
    TrackerOptions options = Automatic(0.0);
    options.fit.border = choice;
    Tracker tracker(options);
    for (const SyntheticReadback& frame : spots.frames) {
      const auto tracked = tracker.Update(frame.View(), spots.lights, kMap);
      for (size_t i = 0; i < spots.lights.size(); ++i) {
        if (!tracked[i].ok()) continue;
        EXPECT_EQ(tracked[i]->matrix.border,
                  choice == BorderChoice::kDark ? Border::kDark : Border::kLit);
        EXPECT_EQ(tracker.state()[i].border, tracked[i]->matrix.border);
        EXPECT_EQ(tracked[i]->matrix.facing, FacingSource::kGuessed);
      }
    }
  }
}

// Options that change under way change the border in the next frame, update or not.
TEST(TrackerBorder, AnotherOneAskedForIsANewMap) {
  const Spots spots(3, {true, true, true});
  TrackerOptions options = Automatic(1.0);
  options.fit.border = BorderChoice::kLit;
  Tracker tracker(options);
  const auto first = tracker.Update(spots.frames[0].ViewWithFacing(), spots.lights, kMap);
  options.fit.border = BorderChoice::kDark;
  tracker.set_options(options);
  const auto second = tracker.Update(spots.frames[1].ViewWithFacing(), spots.lights, kMap);
  const auto third = tracker.Update(spots.frames[2].ViewWithFacing(), spots.lights, kMap);
  for (size_t i = 0; i < spots.lights.size(); ++i) {
    ASSERT_THAT(first[i], IsOk());
    ASSERT_THAT(second[i], IsOk());
    ASSERT_THAT(third[i], IsOk());
    EXPECT_EQ(first[i]->matrix.border, Border::kLit);
    EXPECT_EQ(second[i]->matrix.border, Border::kDark);
    EXPECT_EQ(second[i]->action, TrackerAction::kReplaced);
    EXPECT_NE(third[i]->action, TrackerAction::kFirst);
  }
}

TEST(TrackerBorder, GoesOnFromItsStateAsIfItHadNeverStopped) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    const Spots spots(seed, kThereAndBack);
    const TrackerOptions options = Automatic(0.5);
    Tracker whole(options);
    std::vector<TrackedState> state;
    int num_dark = 0;
    for (const SyntheticReadback& frame : spots.frames) {
      const auto expected = whole.Update(frame.ViewWithFacing(), spots.lights, kMap);
      Tracker tracker(options);
      tracker.set_state(state);
      const auto tracked = tracker.Update(frame.ViewWithFacing(), spots.lights, kMap);
      for (size_t i = 0; i < spots.lights.size(); ++i) {
        ASSERT_THAT(tracked[i], IsOk());
        ASSERT_THAT(expected[i], IsOk());
        EXPECT_EQ(tracked[i]->matrix.map_from_world, expected[i]->matrix.map_from_world);
        EXPECT_EQ(tracked[i]->matrix.border, expected[i]->matrix.border);
        EXPECT_EQ(tracked[i]->action, expected[i]->action);
        EXPECT_EQ(tracked[i]->frames_kept, expected[i]->frames_kept);
        num_dark += tracked[i]->matrix.border == Border::kDark ? 1 : 0;
      }
      state = tracker.state();
    }
    EXPECT_GE(num_dark, 3);
  }
}

TEST(AsyncOptimizerBorder, IsThatOfTheTrackerWithTheSameBits) {
  const Spots spots(1, kThereAndBack);
  const TrackerOptions options = Automatic(0.5);
  AsyncOptimizer optimizer = StartOptimizer(options);
  Tracker tracker(options);
  int num_dark = 0, num_lit = 0;
  for (size_t frame = 0; frame < spots.frames.size(); ++frame) {
    SCOPED_TRACE(frame);
    const SyntheticReadback& view = spots.frames[frame];
    const bool has_facing = frame != 9;  // in one frame the renderer does not say
    FrameReadback& readback = optimizer.Lend();
    Fill(view, spots.lights, static_cast<int64_t>(frame), &readback);
    readback.map = kMap;
    readback.facing_bits.clear();
    if (has_facing) readback.facing_bits = view.facing_bits;
    EXPECT_EQ(readback.View().KnowsFacing(0), has_facing);
    optimizer.Submit();
    const FrameMatrices& matrices = PollLast(optimizer, static_cast<int64_t>(frame));
    const auto expected =
        tracker.Update(has_facing ? view.ViewWithFacing() : view.View(), spots.lights, kMap);
    ASSERT_EQ(matrices.num_lights, static_cast<int>(spots.lights.size()));
    for (size_t i = 0; i < spots.lights.size(); ++i) {
      ASSERT_EQ(matrices.lights[i].status, expected[i].status());
      if (!expected[i].ok()) continue;
      EXPECT_EQ(matrices.lights[i].border, expected[i]->matrix.border);
      EXPECT_EQ(matrices.lights[i].map_from_world, expected[i]->matrix.map_from_world);
      EXPECT_EQ(matrices.lights[i].action, expected[i]->action);
      (matrices.lights[i].border == Border::kDark ? num_dark : num_lit) += 1;
    }
  }
  EXPECT_GE(num_dark, 10);
  EXPECT_GE(num_lit, 6);
}

// Of the wrong size they are refused as the other buffers are.
TEST(AsyncOptimizerBorder, FacingBitsOfAnotherSizeAreTheStatusOfTheLights) {
  const Spots spots(1, {true});
  AsyncOptimizer optimizer = StartOptimizer(Automatic(0.5));
  FrameReadback& readback = optimizer.Lend();
  Fill(spots.frames[0], spots.lights, 1, &readback);
  readback.facing_bits.assign(7, 0);
  optimizer.Submit();
  const FrameMatrices& matrices = PollLast(optimizer, 1);
  for (size_t i = 0; i < spots.lights.size(); ++i) {
    EXPECT_THAT(matrices.lights[i].status,
                testing::StatusIs(absl::StatusCode::kInvalidArgument,
                                  ::testing::HasSubstr("readback.facing_bits: 7 words")));
  }
}

}  // namespace
}  // namespace lightfit
