// Summaries for a dark border: they add as others do, not with others, and a fit of one is that of
// its frame.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <string>
#include <utility>
#include <vector>

#include "optimizer/energy/summary_total.h"
#include "optimizer/fit.h"
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

constexpr MapSize kMap = {512, 512};

FitOptions Dark() {
  FitOptions options;
  options.border = BorderChoice::kDark;
  return options;
}

std::vector<SyntheticReadback> WalkPast(const BoxScene& scene,
                                        absl::Span<const Light> lights,
                                        uint64_t seed,
                                        int num_frames) {
  const Camera first = RandomCamera(scene, seed, 64, 48);
  std::vector<SyntheticReadback> frames;
  for (int i = 0; i < num_frames; ++i) {
    Camera camera = first;
    camera.camera_from_world(0, 3) += 0.3 * i;
    frames.push_back(Render(scene, camera, lights));
  }
  return frames;
}

// In any order, by twos and threes.
SummaryTotal AddedInRandomGroups(Random& random, std::vector<SummaryTotal> totals) {
  while (totals.size() > 1) {
    const int last = static_cast<int>(totals.size()) - 1;
    std::swap(totals[random.Int(0, last)], totals.back());
    const SummaryTotal taken = totals.back();
    totals.pop_back();
    EXPECT_THAT(AddToTotal(taken, &totals[random.Int(0, last - 1)]), IsOk());
  }
  return totals.front();
}

// Whether a world point is in the map.
bool IsInside(const LightMatrix& matrix, const Eigen::Vector3d& position) {
  constexpr double kTexels = 1e-6;
  const Eigen::Vector4d map = matrix.map_from_world * position.homogeneous();
  const Eigen::Vector2d texel = map.head<2>() / map.w();
  return map.w() > 0.0 && texel.minCoeff() >= -kTexels && texel.x() <= matrix.map.width + kTexels &&
         texel.y() <= matrix.map.height + kTexels;
}

// And the map of the sum has room for all that is lit in any of the frames.
TEST(SummaryBorder, DarkOnesAddToTheLastBitInAnyOrderAndGrouping) {
  Random random(801);
  int num_fitted = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const BoxScene scene = MakeBoxScene(seed);
    const std::vector<Light> lights = RandomLights(scene, seed, 3);
    const std::vector<SyntheticReadback> frames = WalkPast(scene, lights, seed, 8);
    for (const Light& light : lights) {
      SCOPED_TRACE(light.name + ", seed " + std::to_string(seed));
      std::vector<SummaryTotal> totals;
      int64_t num_beyond = 0;
      for (const SyntheticReadback& frame : frames) {
        const auto summary = Summarize(frame.ViewWithFacing(), light, Dark());
        ASSERT_THAT(summary, IsOk());
        EXPECT_EQ(summary->cover.border, Border::kDark);
        totals.push_back(TotalOf(*summary, light));
        EXPECT_EQ(totals.back().border, Border::kDark);
        EXPECT_EQ(totals.back().facing, FacingSource::kGiven);
        num_beyond += summary->counts.beyond_map;
      }
      const auto first = SummaryOfTotal(AddedInRandomGroups(random, totals));
      ASSERT_THAT(first, IsOk());
      EXPECT_EQ(first->counts.beyond_map, num_beyond);
      for (int k = 0; k < 4; ++k) {
        const auto other = SummaryOfTotal(AddedInRandomGroups(random, totals));
        ASSERT_THAT(other, IsOk());
        EXPECT_EQ(other->tensor.entries(), first->tensor.entries());
        EXPECT_EQ(other->cover.hull, first->cover.hull);
        EXPECT_EQ(other->cover.depth.near, first->cover.depth.near);
        EXPECT_EQ(other->cover.depth.far, first->cover.depth.far);
        EXPECT_EQ(other->cover.border, Border::kDark);
        EXPECT_EQ(other->footprint_sum, first->footprint_sum);
        EXPECT_EQ(other->facing, FacingSource::kGiven);
      }
      const auto matrix = Fit(*first, light, kMap, Dark());
      if (!matrix.ok()) continue;
      EXPECT_EQ(matrix->border, Border::kDark);
      EXPECT_EQ(matrix->facing, FacingSource::kGiven);
      ++num_fitted;
      int num_outside = 0;
      for (const SyntheticReadback& frame : frames) {
        const AffineDepth affine_depth(frame.camera, DepthKind::kCameraZ);
        const Eigen::Matrix4d world_from_screen = frame.camera.WorldFromScreen();
        for (size_t i = 0; i < frame.depth.size(); ++i) {
          const uint32_t lit = frame.facing_bits[i] & ~frame.shadow_bits[i];
          if ((lit >> light.shadow_bit & 1u) == 0) continue;
          const int x = static_cast<int>(i) % frame.camera.width;
          const int y = static_cast<int>(i) / frame.camera.width;
          const double d = affine_depth.At(x, y, frame.depth[i]);
          const Eigen::Vector4d screen(x + 0.5, y + 0.5, d, 1.0);
          num_outside += IsInside(*matrix, (world_from_screen * screen).hnormalized()) ? 0 : 1;
        }
      }
      EXPECT_EQ(num_outside, 0);
    }
  }
  EXPECT_GE(num_fitted, 10);
}

TEST(SummaryBorder, LitAndDarkOnesDoNotAdd) {
  const TestScene scene(1, 1);
  const Light& sun = scene.lights[0];
  const auto lit = Summarize(scene.readback.ViewWithFacing(), sun);
  const auto dark = Summarize(scene.readback.ViewWithFacing(), sun, Dark());
  ASSERT_THAT(lit, IsOk());
  ASSERT_THAT(dark, IsOk());
  const auto refused =
      StatusIs(absl::StatusCode::kInvalidArgument,
               HasSubstr("light \"sun0\": summaries for a lit and for a dark border do not add"));
  SummaryTotal total = TotalOf(*lit, sun);
  EXPECT_THAT(AddToTotal(TotalOf(*dark, sun), &total), refused);
  EXPECT_EQ(total.num_frames, 1);
  EXPECT_EQ(total.border, Border::kLit);
  EXPECT_EQ(total.counts.used, lit->counts.used);
  EXPECT_THAT(MergeSummaries({*dark, *lit}, sun), refused);
  EXPECT_THAT(MergeSummaries({*dark, *dark}, sun), IsOk());
}

TEST(SummaryBorder, FacingIsGivenOnlyIfItIsInEveryFrame) {
  const TestScene scene(2, 1);
  const Light& sun = scene.lights[0];
  for (const FitOptions& options : {FitOptions(), Dark()}) {
    const auto given = Summarize(scene.readback.ViewWithFacing(), sun, options);
    const auto guessed = Summarize(scene.View(), sun, options);
    ASSERT_THAT(given, IsOk());
    ASSERT_THAT(guessed, IsOk());
    const auto facing_of = [&](const std::vector<Summary>& summaries) {
      const auto merged = MergeSummaries(summaries, sun);
      EXPECT_THAT(merged, IsOk());
      const auto matrix = Fit(*merged, sun, kMap, options);
      EXPECT_THAT(matrix, IsOk());
      EXPECT_EQ(matrix->facing, merged->facing);
      return merged->facing;
    };
    EXPECT_EQ(facing_of({*given}), FacingSource::kGiven);
    EXPECT_EQ(facing_of({*given, *given, *given}), FacingSource::kGiven);
    EXPECT_EQ(facing_of({*guessed}), FacingSource::kGuessed);
    EXPECT_EQ(facing_of({*given, *guessed}), FacingSource::kGuessed);
    EXPECT_EQ(facing_of({*guessed, *given}), FacingSource::kGuessed);
    EXPECT_EQ(facing_of({*given, *given, *guessed, *given}), FacingSource::kGuessed);
  }
}

// As with a lit border: the focused map to the last bit, a search within that of Polish::kThorough.
TEST(SummaryBorder, AFitOfADarkOneEqualsFitLight) {
  int num_fitted = 0;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const TestScene scene(seed, 6);
    const Readback readback = scene.readback.ViewWithFacing();
    for (const Light& light : scene.lights) {
      SCOPED_TRACE(light.name + ", seed " + std::to_string(seed));
      FitOptions options = testing::SquaredFootprints();
      options.cover = Cover::kShadowed;
      options.border = BorderChoice::kDark;
      const auto summary = Summarize(readback, light, options);
      for (const Search search : {Search::kFocused, Search::kGlobal}) {
        options.search = search;
        const auto whole = FitLight(readback, light, kMap, options);
        ASSERT_EQ(whole.ok(), summary.ok());
        if (!whole.ok()) continue;
        const auto from_summary = Fit(*summary, light, kMap, options);
        ASSERT_THAT(from_summary, IsOk());
        EXPECT_EQ(from_summary->border, Border::kDark);
        EXPECT_EQ(from_summary->facing, FacingSource::kGiven);
        EXPECT_EQ(from_summary->figures.samples.used, whole->figures.samples.used);
        EXPECT_EQ(from_summary->figures.samples.beyond_map, whole->figures.samples.beyond_map);
        if (search == Search::kFocused) {
          EXPECT_EQ(from_summary->map_from_world, whole->map_from_world);
          EXPECT_EQ(from_summary->figures.energy, whole->figures.energy);
        } else {
          EXPECT_LE(from_summary->figures.energy, whole->figures.energy);
          EXPECT_GE(from_summary->figures.energy, whole->figures.energy * (1.0 - 1e-3));
        }
        ++num_fitted;
      }
    }
  }
  EXPECT_GE(num_fitted, 50);
}

}  // namespace
}  // namespace lightfit
