#include "optimizer/tracking/tracker.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "optimizer/evaluate.h"
#include "optimizer/fit.h"
#include "tests/testing/matchers.h"
#include "tests/testing/metric_of.h"
#include "tests/testing/random_cases.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::Random;
using testing::RelativeError;
using testing::StatusIs;

constexpr MapSize kMap = {1024, 1024};

// A camera that walks past a scene and turns a little.
struct Walk {
  std::vector<Light> lights;
  std::vector<SyntheticReadback> frames;

  explicit Walk(uint64_t seed, int num_frames = 12, double step = 0.15, int num_lights = 3) {
    const BoxScene scene = MakeBoxScene(seed);
    lights = RandomLights(scene, seed, num_lights);
    const Camera first = RandomCamera(scene, seed, 80, 60);
    for (int i = 0; i < num_frames; ++i) {
      Camera camera = first;
      Eigen::Matrix4d step_from_first = Eigen::Matrix4d::Identity();
      step_from_first.topLeftCorner<3, 3>() =
          Eigen::AngleAxisd(0.004 * step / 0.15 * i, Eigen::Vector3d::UnitY()).matrix();
      step_from_first(0, 3) = step * i;
      camera.camera_from_world = step_from_first * first.camera_from_world;
      frames.push_back(Render(scene, camera, lights));
    }
  }
};

// Runs a tracker over the walk; [frame][light].
std::vector<TrackedMatrices> Track(const Walk& walk, const TrackerOptions& options) {
  Tracker tracker(options);
  std::vector<TrackedMatrices> results;
  for (const SyntheticReadback& frame : walk.frames) {
    results.push_back(tracker.Update(frame.View(), walk.lights, kMap));
  }
  return results;
}

TEST(Tracker, AtStabilityZeroIsEveryFramesOwnFit) {
  const Walk walk(1, 6);
  const TrackerOptions options = TrackerOptions::ForStability(0.0);
  const auto tracked = Track(walk, options);
  int num_fitted = 0;
  for (size_t frame = 0; frame < walk.frames.size(); ++frame) {
    const auto fitted = FitLights(walk.frames[frame].View(), walk.lights, kMap, options.fit);
    for (size_t light = 0; light < walk.lights.size(); ++light) {
      if (!fitted[light].ok()) continue;
      ASSERT_THAT(tracked[frame][light], IsOk());
      EXPECT_EQ(tracked[frame][light]->matrix.map_from_world, fitted[light]->map_from_world);
      EXPECT_EQ(tracked[frame][light]->matrix.figures.energy, fitted[light]->figures.energy);
      EXPECT_EQ(tracked[frame][light]->frames_kept, 0);
      ++num_fitted;
    }
  }
  EXPECT_GE(num_fitted, 12);
}

TEST(Tracker, KeepsAMatrixToTheLastBitWhileNothingMoves) {
  const Walk walk(2, 9, /*step=*/0.0);
  for (const double stability : {0.2, 0.5, 1.0}) {
    const auto tracked = Track(walk, TrackerOptions::ForStability(stability));
    for (size_t light = 0; light < walk.lights.size(); ++light) {
      if (!tracked[0][light].ok()) continue;
      EXPECT_EQ(tracked[0][light]->action, TrackerAction::kFirst);
      for (size_t frame = 1; frame < tracked.size(); ++frame) {
        ASSERT_THAT(tracked[frame][light], IsOk());
        EXPECT_EQ(tracked[frame][light]->action, TrackerAction::kKept);
        EXPECT_EQ(tracked[frame][light]->frames_kept, static_cast<int64_t>(frame));
        EXPECT_EQ(tracked[frame][light]->matrix.map_from_world,
                  tracked[0][light]->matrix.map_from_world);
      }
    }
  }
}

// What is kept or shifted leaves every world point's place in its texel.
TEST(Tracker, KeptAndShiftedTexelsStayOnTheirSurfaces) {
  Random random(201);
  int num_kept = 0, num_shifted = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const Walk walk(seed, 16);
    const auto tracked = Track(walk, TrackerOptions::ForStability(0.5));
    for (size_t light = 0; light < walk.lights.size(); ++light) {
      for (size_t frame = 1; frame < tracked.size(); ++frame) {
        if (!tracked[frame][light].ok() || !tracked[frame - 1][light].ok()) continue;
        const TrackerAction action = tracked[frame][light]->action;
        if (action != TrackerAction::kKept && action != TrackerAction::kShifted) continue;
        (action == TrackerAction::kKept ? num_kept : num_shifted) += 1;
        const Eigen::Matrix4d& before = tracked[frame - 1][light]->matrix.map_from_world;
        const Eigen::Matrix4d& after = tracked[frame][light]->matrix.map_from_world;
        EXPECT_EQ(after.row(3), before.row(3));
        for (int k = 0; k < 20; ++k) {
          const Eigen::Vector4d point = random.InCube(5.0).homogeneous();
          if (!((before * point).w() > 0.0)) continue;
          const Eigen::Vector2d moved =
              (after * point).hnormalized().head<2>() - (before * point).hnormalized().head<2>();
          for (const double texels : {moved.x(), moved.y()}) {
            EXPECT_NEAR(texels, std::round(texels), 1e-6);
            if (action == TrackerAction::kKept) {
              EXPECT_EQ(texels, 0.0);
            }
          }
        }
      }
    }
  }
  std::printf("%d kept, %d shifted\n", num_kept, num_shifted);
  EXPECT_GE(num_kept, 50);
  EXPECT_GE(num_shifted, 5);
}

TEST(Tracker, WithHardValidityCoversEveryFrame) {
  for (const Cover cover : {Cover::kShadowed, Cover::kReceivers}) {
    for (const double stability : {0.0, 0.3, 0.7, 1.0}) {
      TrackerOptions options = TrackerOptions::ForStability(stability);
      options.fit.cover = cover;
      const Walk walk(3, 12, 0.3);
      const auto tracked = Track(walk, options);
      for (size_t frame = 0; frame < tracked.size(); ++frame) {
        SCOPED_TRACE(frame);
        for (size_t light = 0; light < walk.lights.size(); ++light) {
          if (!tracked[frame][light].ok()) continue;
          testing::ExpectAllFinite(tracked[frame][light]->matrix);
          testing::ExpectCovers(
              tracked[frame][light]->matrix, walk.frames[frame].View(), walk.lights[light], cover);
        }
      }
    }
  }
}

TEST(Tracker, FiguresAreThoseOfThisFrame) {
  const Walk walk(4);
  const TrackerOptions options = TrackerOptions::ForStability(0.5);
  const auto tracked = Track(walk, options);
  int num_kept = 0;
  for (size_t frame = 0; frame < tracked.size(); ++frame) {
    for (size_t light = 0; light < walk.lights.size(); ++light) {
      if (!tracked[frame][light].ok()) continue;
      const LightMatrix& matrix = tracked[frame][light]->matrix;
      const auto figures = EvaluateMatrix(
          walk.frames[frame].View(), walk.lights[light], matrix.map_from_world, kMap, options.fit);
      ASSERT_THAT(figures, IsOk());
      EXPECT_LE(RelativeError(matrix.figures.energy, figures->energy), 1e-5);
      EXPECT_LE(RelativeError(matrix.figures.footprint.median, figures->footprint.median), 1e-5);
      num_kept += tracked[frame][light]->action == TrackerAction::kKept;
    }
  }
  EXPECT_GE(num_kept, 5);
}

TEST(Tracker, LooksForABetterMapEveryNthFrameOnly) {
  const Walk walk(2, 10, /*step=*/0.0, 1);
  for (const int every : {1, 3, 4}) {
    TrackerOptions options;
    options.replace_below = 1.0;
    options.update_every_frames = every;
    const auto tracked = Track(walk, options);
    for (size_t frame = 1; frame < tracked.size(); ++frame) {
      ASSERT_THAT(tracked[frame][0], IsOk());
      EXPECT_EQ(tracked[frame][0]->action,
                frame % every == 0 ? TrackerAction::kReplaced : TrackerAction::kKept)
          << "frame " << frame << ", every " << every;
    }
  }
}

// The rule by hand: the fresh fit's squared median against that of what is kept.
TEST(Tracker, ReplacesBelowTheThreshold) {
  int num_replaced = 0, num_kept = 0;
  for (uint64_t seed = 1; seed <= 2; ++seed) {
    const Walk walk(seed, 12, 0.5);
    for (const double threshold : {0.0, 0.8, 0.95}) {
      TrackerOptions options;
      options.replace_below = threshold;
      options.update_every_frames = 1;
      options.cover_margin_percent = 0.0;
      options.hard_validity = false;
      Tracker tracker(options);
      std::vector<Eigen::Matrix4d> before(walk.lights.size());
      for (size_t frame = 0; frame < walk.frames.size(); ++frame) {
        const Readback readback = walk.frames[frame].View();
        const auto tracked = tracker.Update(readback, walk.lights, kMap);
        const auto fresh = FitLights(readback, walk.lights, kMap, options.fit);
        for (size_t light = 0; light < walk.lights.size(); ++light) {
          if (!tracked[light].ok() || !fresh[light].ok()) continue;
          const TrackerAction action = tracked[light]->action;
          if (action == TrackerAction::kReplaced) {
            // Shifts do not change footprints, so the matrix before tells what was kept.
            const auto kept =
                EvaluateMatrix(readback, walk.lights[light], before[light], kMap, options.fit);
            ASSERT_THAT(kept, IsOk());
            EXPECT_LT(
                std::pow(fresh[light]->figures.footprint.median / kept->footprint.median, 2.0),
                threshold);
            ++num_replaced;
          } else if (action == TrackerAction::kKept || action == TrackerAction::kShifted) {
            const double median = tracked[light]->matrix.figures.footprint.median;
            EXPECT_GE(std::pow(fresh[light]->figures.footprint.median / median, 2.0),
                      threshold * 0.999999);
            ++num_kept;
          }
          before[light] = tracked[light]->matrix.map_from_world;
        }
      }
    }
  }
  std::printf("%d replaced, %d kept\n", num_replaced, num_kept);
  EXPECT_GE(num_replaced, 5);
  EXPECT_GE(num_kept, 20);
}

TEST(Tracker, AsPublishedKeepsTheAxis) {
  const Walk walk(5);
  const auto tracked = Track(walk, TrackerOptions::AsPublished());
  int num_relaid = 0;
  for (size_t frame = 1; frame < tracked.size(); ++frame) {
    for (size_t light = 0; light < walk.lights.size(); ++light) {
      if (!tracked[frame][light].ok() || !tracked[frame - 1][light].ok()) continue;
      if (tracked[frame][light]->action != TrackerAction::kRelaid) continue;
      const Eigen::RowVector4d axis = tracked[frame][light]->matrix.map_from_world.row(3);
      const Eigen::RowVector4d before = tracked[frame - 1][light]->matrix.map_from_world.row(3);
      EXPECT_LE(testing::HomogeneousError(axis, before), 1e-9);
      EXPECT_EQ(tracked[frame][light]->frames_kept, 0);
      ++num_relaid;
    }
  }
  EXPECT_GE(num_relaid, 5);
}

TEST(Tracker, BeginsAnewWhenTheLightOrTheMapIsAnother) {
  const Walk walk(2, 1, 0.0, 1);
  const Readback readback = walk.frames[0].View();
  const TrackerOptions options = TrackerOptions::ForStability(1.0);
  Tracker tracker(options);
  const auto action = [&](absl::Span<const Light> lights, MapSize map) {
    const auto tracked = tracker.Update(readback, lights, map);
    EXPECT_THAT(tracked[0], IsOk());
    return tracked[0].ok() ? tracked[0]->action : TrackerAction::kInvalid;
  };
  EXPECT_EQ(action(walk.lights, kMap), TrackerAction::kFirst);
  EXPECT_EQ(action(walk.lights, kMap), TrackerAction::kKept);
  EXPECT_EQ(action(walk.lights, {512, 1024}), TrackerAction::kFirst);
  std::vector<Light> moved = walk.lights;
  moved[0].direction += Eigen::Vector3d(0.01, 0.0, 0.0);
  moved[0].position += Eigen::Vector3d(0.01, 0.0, 0.0);
  EXPECT_EQ(action(moved, {512, 1024}), TrackerAction::kFirst);
  EXPECT_EQ(action(moved, {512, 1024}), TrackerAction::kKept);
  // A light that vanishes for a frame is forgotten.
  EXPECT_TRUE(tracker.Update(readback, {}, kMap).empty());
  EXPECT_TRUE(tracker.state().empty());
  EXPECT_EQ(action(moved, {512, 1024}), TrackerAction::kFirst);
}

TEST(Tracker, KeepsWhatIsValidWhereNothingCanBeFitted) {
  Walk walk(2, 2, 0.0, 1);
  TrackerOptions options = TrackerOptions::ForStability(0.5);
  options.update_every_frames = 1;
  Tracker tracker(options);
  const auto first = tracker.Update(walk.frames[0].View(), walk.lights, kMap);
  ASSERT_THAT(first[0], IsOk());
  for (uint32_t& bits : walk.frames[1].shadow_bits) bits = 0;
  const auto second = tracker.Update(walk.frames[1].View(), walk.lights, kMap);
  ASSERT_THAT(second[0], IsOk());
  EXPECT_EQ(second[0]->action, TrackerAction::kKept);
  EXPECT_EQ(second[0]->matrix.map_from_world, first[0]->matrix.map_from_world);
  testing::ExpectAllFinite(second[0]->matrix);
  // Without anything to keep it is the focused map.
  Tracker fresh(options);
  const auto alone = fresh.Update(walk.frames[1].View(), walk.lights, kMap);
  ASSERT_THAT(alone[0], IsOk());
  EXPECT_EQ(alone[0]->action, TrackerAction::kFirst);
  EXPECT_EQ(alone[0]->matrix.search.stop_reason, StopReason::kTooFewSamples);
}

TEST(Tracker, GoesOnFromItsStateAsIfItHadNeverStopped) {
  const Walk walk(6, 12);
  const TrackerOptions options = TrackerOptions::ForStability(0.5);
  const auto whole = Track(walk, options);
  std::vector<TrackedState> state;
  for (size_t frame = 0; frame < walk.frames.size(); ++frame) {
    Tracker tracker(options);
    tracker.set_state(state);
    const auto tracked = tracker.Update(walk.frames[frame].View(), walk.lights, kMap);
    for (size_t light = 0; light < walk.lights.size(); ++light) {
      ASSERT_EQ(tracked[light].ok(), whole[frame][light].ok());
      if (!tracked[light].ok()) continue;
      EXPECT_EQ(tracked[light]->matrix.map_from_world, whole[frame][light]->matrix.map_from_world);
      EXPECT_EQ(tracked[light]->action, whole[frame][light]->action);
    }
    state = tracker.state();
  }
}

// What the dial promises: the more stable, the fewer changes, and the larger the texels.
TEST(Tracker, StabilityTradesUpdatesForEnergy) {
  std::vector<int> updates;
  std::vector<double> log_ratio;
  for (const double stability : {0.0, 0.25, 0.5, 1.0}) {
    updates.push_back(0);
    log_ratio.push_back(0.0);
    for (uint64_t seed = 1; seed <= 2; ++seed) {
      const Walk walk(seed, 16);
      const auto tracked = Track(walk, TrackerOptions::ForStability(stability));
      const auto tightest = Track(walk, TrackerOptions::ForStability(0.0));
      for (size_t frame = 0; frame < tracked.size(); ++frame) {
        for (size_t light = 0; light < walk.lights.size(); ++light) {
          if (!tracked[frame][light].ok() || !tightest[frame][light].ok()) continue;
          updates.back() += tracked[frame][light]->frames_kept == 0;
          log_ratio.back() += std::log(tracked[frame][light]->matrix.figures.energy /
                                       tightest[frame][light]->matrix.figures.energy);
        }
      }
    }
    std::printf("stability %.2f: %d updates, sum of log ratios %.3f\n",
                stability,
                updates.back(),
                log_ratio.back());
  }
  for (size_t i = 1; i < updates.size(); ++i) {
    EXPECT_LT(updates[i], updates[i - 1]);
    EXPECT_GT(log_ratio[i], log_ratio[i - 1]);
  }
}

TEST(Tracker, RefusesOptionsThatMakeNoSense) {
  const Walk walk(1, 1, 0.0, 1);
  TrackerOptions options;
  options.update_every_frames = 0;
  EXPECT_THAT(Tracker(options).Update(walk.frames[0].View(), walk.lights, kMap)[0],
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("update_every_frames = 0")));
  options = {};
  options.replace_below = -0.1;
  EXPECT_THAT(ValidateTrackerOptions(options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("replace_below = -0.1")));
  options = {};
  options.cover_margin_percent = NAN;
  EXPECT_THAT(ValidateTrackerOptions(options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("cover_margin_percent")));
}

}  // namespace
}  // namespace lightfit
