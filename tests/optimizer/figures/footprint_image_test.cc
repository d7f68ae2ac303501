#include "optimizer/figures/footprint_image.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "optimizer/fit.h"
#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::RelativeError;
using testing::StatusIs;
using testing::TestScene;

constexpr MapSize kMap = {512, 512};

// At the samples the picture shows the same footprints as the statistics sum up.
TEST(FootprintImage, AgreesWithTheStatisticsAtTheSamples) {
  int num_compared = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const TestScene scene(seed, 3);
    for (const Light& light : scene.lights) {
      const auto matrix = FitLight(scene.View(), light, kMap);
      if (!matrix.ok()) continue;
      const auto image = FootprintImage(scene.View(), light, matrix->map_from_world);
      const auto surfaces = FindSurfaces(scene.View(), ~0u, {});
      ASSERT_THAT(surfaces, IsOk());
      const auto samples = SampleImage(*surfaces, light, {});
      ASSERT_THAT(image, IsOk());
      ASSERT_THAT(samples, IsOk());
      double sum = 0.0, worst = 0.0;
      int64_t count = 0;
      for (size_t i = 0; i < image->size(); ++i) {
        EXPECT_TRUE(std::isfinite((*image)[i]));
        EXPECT_GE((*image)[i], 0.0f);
        if ((*samples)[i] == 0) continue;
        EXPECT_GT((*image)[i], 0.0f);
        sum += (*image)[i] * (*image)[i];
        worst = std::max<double>(worst, (*image)[i]);
        ++count;
      }
      EXPECT_EQ(count, matrix->figures.samples.used);
      EXPECT_LE(RelativeError(std::sqrt(sum / count), matrix->figures.footprint.rms), 1e-5);
      EXPECT_LE(RelativeError(worst, matrix->figures.footprint.worst), 1e-5);
      ++num_compared;
    }
  }
  EXPECT_GE(num_compared, 10);
}

TEST(FootprintImage, IsZeroWhereNoTexelIsSeen) {
  testing::PlaneReadback readback = testing::FloorReadback();
  readback.Cast(0, [](int x, int y) { return std::hypot(x - 20.2, y - 15.3) < 8.0; });
  readback.depth[readback.Index(10, 10)] = 1e10f;
  const Light sun = Light::Directional("sun", {0.3, 0.2, -1.0});
  const Light below = Light::Directional("below", {0.3, 0.2, 1.0});
  const auto matrix = FitLight(readback.View(), sun, kMap);
  ASSERT_THAT(matrix, IsOk());
  const auto image = FootprintImage(readback.View(), sun, matrix->map_from_world);
  ASSERT_THAT(image, IsOk());
  EXPECT_EQ((*image)[readback.Index(10, 10)], 0.0f);
  EXPECT_GT((*image)[readback.Index(11, 10)], 0.0f);  // beside the background, an outline
  SampleOptions no_outlines;
  no_outlines.use_outlines = false;
  const auto inner = FootprintImage(readback.View(), sun, matrix->map_from_world, no_outlines);
  ASSERT_THAT(inner, IsOk());
  EXPECT_EQ((*inner)[readback.Index(11, 10)], 0.0f);
  EXPECT_EQ((*inner)[readback.Index(20, 15)], (*image)[readback.Index(20, 15)]);
  EXPECT_EQ((*image)[readback.Index(0, 5)], 0.0f);  // the border has no derivatives
  EXPECT_GT((*image)[readback.Index(20, 15)], 0.0f);
  const auto from_below = FootprintImage(readback.View(), below, matrix->map_from_world);
  ASSERT_THAT(from_below, IsOk());
  for (const float footprint : *from_below) EXPECT_EQ(footprint, 0.0f);
}

TEST(FootprintImage, RejectsMatricesThatAreNotFinite) {
  const testing::PlaneReadback readback = testing::FloorReadback();
  const Light sun = Light::Directional("sun", {0.3, 0.2, -1.0});
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix(1, 2) = std::nan("");
  EXPECT_THAT(FootprintImage(readback.View(), sun, matrix),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("map_from_world")));
}

TEST(ReceiverPositions, LieOnTheFloor) {
  const testing::PlaneReadback readback = testing::FloorReadback();
  const auto positions = ReceiverPositions(readback.View());
  ASSERT_THAT(positions, IsOk());
  EXPECT_EQ(positions->size(), 1200u);
  for (const Eigen::Vector3d& position : *positions) EXPECT_NEAR(position.z(), 0.0, 1e-6);
}

}  // namespace
}  // namespace lightfit
