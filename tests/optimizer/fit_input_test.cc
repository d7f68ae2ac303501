// Bad and strange input to FitLight: each has a defined answer that names what to change.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "optimizer/figures/footprint_image.h"
#include "optimizer/fit.h"
#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"
#include "tests/testing/refiners.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using testing::ExpectAllFinite;
using testing::ExpectCovers;
using testing::FloorReadback;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::PlaneReadback;
using testing::StatusIs;
using testing::TestScene;

constexpr MapSize kMap = {256, 256};
constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
constexpr auto kPrecondition = absl::StatusCode::kFailedPrecondition;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

const Light kSun = Light::Directional("sun", {0.3, 0.2, -1.0});
const Light kLamp = Light::Point("lamp", {0.5, -0.5, 2.0});

// A floor with a disc of shadow on it.
PlaneReadback Disc() {
  PlaneReadback readback = FloorReadback();
  readback.Cast(0, [](int x, int y) { return std::hypot(x - 20.2, y - 15.3) < 8.0; });
  return readback;
}

TEST(FitLight, FitsTheDisc) {
  for (const Light& light : {kSun, kLamp}) {
    const PlaneReadback readback = Disc();
    const auto matrix = FitLight(readback.View(), light, kMap);
    ASSERT_THAT(matrix, IsOk());
    ExpectAllFinite(*matrix);
    ExpectCovers(*matrix, readback.View(), light);
  }
}

TEST(FitLight, IgnoresAndCountsSinglePixelsOfInvalidDepth) {
  for (const float bad : {kNaN, kInfinity, -kInfinity, -2.0f, 0.0f}) {
    for (const Light& light : {kSun, kLamp}) {
      PlaneReadback readback = Disc();
      for (const int x : {3, 12, 20, 39}) readback.depth[readback.Index(x, 15)] = bad;
      const auto matrix = FitLight(readback.View(), light, kMap);
      ASSERT_THAT(matrix, IsOk()) << bad;
      EXPECT_EQ(matrix->figures.samples.receivers, 40 * 30 - 4);
      EXPECT_EQ(matrix->figures.samples.invalid_depth, bad == kInfinity ? 0 : 4) << bad;
      ExpectAllFinite(*matrix);
      ExpectCovers(*matrix, readback.View(), light);
    }
  }
}

TEST(FitLight, RejectsDepthWithoutAnySurface) {
  PlaneReadback readback = Disc();
  for (const float bad : {kNaN, -2.0f, 0.0f, -kInfinity}) {
    readback.depth.assign(readback.depth.size(), bad);
    EXPECT_THAT(FitLight(readback.View(), kSun, kMap),
                StatusIs(kInvalid, AllOf(HasSubstr("readback.depth"), HasSubstr("1200 of 1200"))));
  }
}

TEST(FitLight, RejectsAllBackground) {
  PlaneReadback readback = Disc();
  for (const float background : {kInfinity, 1e10f}) {
    readback.depth.assign(readback.depth.size(), background);
    EXPECT_THAT(FitLight(readback.View(), kSun, kMap),
                StatusIs(kInvalid, HasSubstr("readback.depth: all 1200 pixels are background")));
  }
}

TEST(FitLight, WithoutShadowBoundaryTheMapIsTheFocusedOne) {
  for (const bool all_shadowed : {false, true}) {
    PlaneReadback readback = FloorReadback();
    readback.Cast(0, [&](int, int) { return all_shadowed; });
    FitOptions focused;
    focused.search = Search::kFocused;
    focused.affine = Affine::kMinAreaRectangle;
    const auto asked_for = FitLight(readback.View(), kSun, kMap, focused);
    ASSERT_THAT(asked_for, IsOk());
    EXPECT_EQ(asked_for->search.stop_reason, StopReason::kNoSearch);
    const auto matrix = FitLight(readback.View(), kSun, kMap);
    ASSERT_THAT(matrix, IsOk());
    EXPECT_EQ(matrix->map_from_world, asked_for->map_from_world);
    EXPECT_EQ(matrix->search.stop_reason, StopReason::kTooFewSamples);
    EXPECT_EQ(matrix->figures.energy, 0.0);
    ExpectAllFinite(*matrix);
    ExpectCovers(*matrix, readback.View(), kSun);
  }
}

// One sample, alone and with the others rejected; then samples on one line of the screen.
TEST(FitLight, FewSamplesAreSearchedForOnlyWhenAskedFor) {
  PlaneReadback readback = FloorReadback();
  readback.Cast(0, [](int x, int y) { return x == 0 && y == 10; });  // boundary of pixel (1, 10)
  const auto few = FitLight(readback.View(), kSun, kMap);
  ASSERT_THAT(few, IsOk());
  EXPECT_EQ(few->search.stop_reason, StopReason::kTooFewSamples);
  EXPECT_EQ(few->figures.samples.used, 1);
  ExpectCovers(*few, readback.View(), kSun);
  FitOptions options;
  options.samples.min_samples = 1;
  for (const Light& light : {kSun, kLamp}) {
    for (const Search search :
         {Search::kRotationLineSearch, Search::kRotationLineSearchRefined, Search::kGlobal}) {
      options.search = search;
      const auto matrix = FitLight(readback.View(), light, kMap, options);
      ASSERT_THAT(matrix, IsOk());
      ExpectAllFinite(*matrix);
      ExpectCovers(*matrix, readback.View(), light);
    }
  }
}

TEST(FitLight, SamplesOnALineAreFitted) {
  for (const bool vertical : {false, true}) {
    PlaneReadback readback = FloorReadback();
    readback.Cast(0, [&](int x, int y) { return vertical ? x >= 20 : y >= 15; });
    for (const Light& light : {kSun, kLamp}) {
      for (const Refiner refiner : testing::Refiners()) {
        FitOptions options;
        options.refiner = refiner;
        const auto matrix = FitLight(readback.View(), light, kMap, options);
        ASSERT_THAT(matrix, IsOk());
        ExpectAllFinite(*matrix);
        ExpectCovers(*matrix, readback.View(), light);
      }
    }
  }
}

TEST(FitLight, ReceiversOnALineHaveNoMap) {
  PlaneReadback readback = Disc();
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) {
      if (y != 15) readback.depth[readback.Index(x, y)] = kInfinity;
    }
  }
  // Depth is float: a line of receivers is straight to seven digits only, and a map without area
  // is refused only where it has none to double precision. Either way nothing is infinite.
  for (const Light& light : {kSun, kLamp}) {
    FitOptions focused;
    focused.search = Search::kFocused;
    for (const FitOptions& options : {FitOptions(), focused}) {
      const auto matrix = FitLight(readback.View(), light, kMap, options);
      if (!matrix.ok()) {
        EXPECT_THAT(matrix, StatusIs(kPrecondition, HasSubstr("light \"" + light.name + "\"")));
        continue;
      }
      ExpectAllFinite(*matrix);
    }
  }
}

TEST(FitLight, RejectsBuffersOfTheWrongSize) {
  const PlaneReadback readback = Disc();
  Readback view = readback.View();
  view.depth = view.depth.subspan(1);
  EXPECT_THAT(FitLight(view, kSun, kMap),
              StatusIs(kInvalid, HasSubstr("readback.depth: 1199 values, want 40 x 30 = 1200")));
  view = readback.View();
  view.shadow_bits = {};
  EXPECT_THAT(FitLight(view, kSun, kMap),
              StatusIs(kInvalid, HasSubstr("readback.shadow_bits: 0 words, want 40 x 30 = 1200")));
}

TEST(FitLight, RejectsSingularCamera) {
  PlaneReadback readback = Disc();
  readback.camera.camera_from_world.row(0).setZero();
  EXPECT_THAT(FitLight(readback.View(), kSun, kMap),
              StatusIs(kInvalid, HasSubstr("camera.camera_from_world")));
  readback = Disc();
  readback.camera.screen_from_camera(1, 1) = std::nan("");
  EXPECT_THAT(FitLight(readback.View(), kSun, kMap),
              StatusIs(kInvalid, HasSubstr("camera.screen_from_camera")));
}

// Above the floor, in the picture: the receivers are all below it, and one map does.
TEST(FitLight, LightInsideTheViewFrustumIsFitted) {
  const PlaneReadback readback = Disc();
  const Light lamp = Light::Point("lamp", {0.0, -0.3, 0.4});
  const auto matrix = FitLight(readback.View(), lamp, kMap);
  ASSERT_THAT(matrix, IsOk());
  ExpectAllFinite(*matrix);
  ExpectCovers(*matrix, readback.View(), lamp);
}

// In the middle of what must be covered and at its far corner there are receivers all around; at
// the near corner the shadow lies to one side, and float depths leave it some area.
TEST(FitLight, LightExactlyAtAReceiverIsRefusedUnlessTheShadowIsToOneSide) {
  const PlaneReadback readback = Disc();
  const auto positions = *ReceiverPositions(readback.View());
  for (const size_t pixel : {555ul, 1199ul}) {
    const auto matrix = FitLight(readback.View(), Light::Point("lamp", positions[pixel]), kMap);
    EXPECT_THAT(matrix, StatusIs(kPrecondition, HasSubstr("light \"lamp\"")));
  }
  const Light beside = Light::Point("lamp", positions[0]);
  const auto matrix = FitLight(readback.View(), beside, kMap);
  ASSERT_THAT(matrix, IsOk());
  EXPECT_EQ(matrix->search.stop_reason, StopReason::kTooFewSamples);
  ExpectAllFinite(*matrix);
  ExpectCovers(*matrix, readback.View(), beside);
}

TEST(FitLight, LightAmongItsReceiversPointsToAPartition) {
  const BoxScene scene = MakeBoxScene(3);
  const Camera camera =
      *LookAtCamera({0.0, -30.0, 20.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.9, 160, 100);
  const Light lamp = Light::Point("lamp", {0.0, 0.0, 0.01});
  const SyntheticReadback readback = Render(scene, camera, {lamp});
  EXPECT_THAT(
      FitLight(readback.View(), lamp, kMap),
      StatusIs(kPrecondition, AllOf(HasSubstr("light \"lamp\""), HasSubstr("dual paraboloid"))));
}

TEST(FitLight, RejectsBadMapSizes) {
  const PlaneReadback readback = Disc();
  for (const MapSize& map :
       {MapSize{0, 256}, MapSize{256, 0}, MapSize{-1, 5}, MapSize{1 << 21, 4}}) {
    EXPECT_THAT(FitLight(readback.View(), kSun, map), StatusIs(kInvalid, HasSubstr("map = ")));
  }
  FitOptions options;
  options.margin_texels = 128.0;
  EXPECT_THAT(FitLight(readback.View(), kSun, kMap, options),
              StatusIs(kInvalid, HasSubstr("options.margin_texels = 128")));
}

TEST(FitLight, FitsTheSmallestMap) {
  const PlaneReadback readback = Disc();
  const auto matrix = FitLight(readback.View(), kSun, {1, 1});
  ASSERT_THAT(matrix, IsOk());
  ExpectCovers(*matrix, readback.View(), kSun);
}

TEST(FitLight, RejectsBadLights) {
  const PlaneReadback readback = Disc();
  EXPECT_THAT(
      FitLight(readback.View(), Light::Directional("sun", {0, 0, 0}), kMap),
      StatusIs(kInvalid, AllOf(HasSubstr("light \"sun\""), HasSubstr("direction = (0, 0, 0)"))));
  EXPECT_THAT(FitLight(readback.View(), Light::Directional("sun", {0, kNaN, 1}), kMap),
              StatusIs(kInvalid, HasSubstr("light \"sun\": direction")));
  EXPECT_THAT(FitLight(readback.View(), Light::Point("lamp", {0, 0, kInfinity}), kMap),
              StatusIs(kInvalid, HasSubstr("light \"lamp\": position")));
  EXPECT_THAT(FitLight(readback.View(), Light::Directional("sun", {0, 0, -1}, 32), kMap),
              StatusIs(kInvalid, HasSubstr("shadow_bit = 32")));
}

TEST(FitLights, ABadLightDoesNotStopTheOthers) {
  const PlaneReadback readback = Disc();
  const auto matrices =
      FitLights(readback.View(), {Light::Directional("broken", {0, 0, 0}), kSun, kLamp}, kMap);
  EXPECT_THAT(matrices[0], StatusIs(kInvalid, HasSubstr("light \"broken\"")));
  EXPECT_THAT(matrices[1], IsOk());
  EXPECT_THAT(matrices[2], IsOk());
}

TEST(Fit, RefusesWhatNeedsTheSamples) {
  const PlaneReadback readback = Disc();
  const auto summary = Summarize(readback.View(), kSun, FitOptions::AsPublished());
  ASSERT_THAT(summary, IsOk());
  EXPECT_THAT(Fit(*summary, kSun, kMap, FitOptions::AsPublished()),
              StatusIs(kInvalid, HasSubstr("options.sample_by_sample")));
}

}  // namespace
}  // namespace lightfit
