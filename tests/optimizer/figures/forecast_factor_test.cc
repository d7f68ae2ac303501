// How far off forecasts may be: as measured at two sizes, between them by the logarithm.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "optimizer/figures/foretell.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::Random;

double FactorOf(int width, int height, bool knows_facing) {
  const Light sun = Light::Directional("sun", {0.0, 0.0, -1.0}, 3);
  const std::vector<uint32_t> bits(static_cast<size_t>(width) * height);
  Readback readback;
  readback.camera.width = width;
  readback.camera.height = height;
  if (knows_facing) readback.facing_bits = bits;
  return ForecastFactor(readback, sun);
}

TEST(ForecastFactor, IsAsMeasuredAt180AndAt360) {
  EXPECT_DOUBLE_EQ(FactorOf(180, 180, true), 1.6);
  EXPECT_DOUBLE_EQ(FactorOf(360, 360, true), 1.5);
  EXPECT_DOUBLE_EQ(FactorOf(180, 180, false), 2.5);
  EXPECT_DOUBLE_EQ(FactorOf(360, 360, false), 1.7);
}

TEST(ForecastFactor, IsHalfWayAtTheGeometricMeanOfTheTwo) {
  // 180 x 360 pixels have the area of a square in the middle of the octave.
  EXPECT_NEAR(FactorOf(180, 360, true), 1.55, 1e-12);
  EXPECT_NEAR(FactorOf(360, 180, false), 2.1, 1e-12);
}

TEST(ForecastFactor, GoesByTheNumberOfPixelsAndNeverUpWithIt) {
  Random random(901);
  for (int i = 0; i < 100; ++i) {
    const int width = random.Int(20, 900), height = random.Int(20, 900);
    for (const bool knows_facing : {false, true}) {
      const double factor = FactorOf(width, height, knows_facing);
      EXPECT_EQ(factor, FactorOf(height, width, knows_facing));
      EXPECT_GE(factor, FactorOf(width + 10, height + 10, knows_facing));
      // Beyond what was measured it stays.
      if (width * height <= 180 * 180) {
        EXPECT_EQ(factor, FactorOf(180, 180, knows_facing));
      }
      if (width * height >= 360 * 360) {
        EXPECT_EQ(factor, FactorOf(360, 360, knows_facing));
      }
    }
    EXPECT_LT(FactorOf(width, height, true), FactorOf(width, height, false));
  }
}

// Of each light by itself.
TEST(ForecastFactor, IsThatWithoutFacingForALightOfWhichItIsNotKnown) {
  const std::vector<uint32_t> bits(180 * 180);
  Readback readback;
  readback.camera.width = readback.camera.height = 180;
  readback.facing_bits = bits;
  readback.facing_lights = 2u;
  const Eigen::Vector3d down(0.0, 0.0, -1.0);
  EXPECT_DOUBLE_EQ(ForecastFactor(readback, Light::Directional("sun", down, 0)), 2.5);
  EXPECT_DOUBLE_EQ(ForecastFactor(readback, Light::Directional("rim", down, 1)), 1.6);
}

}  // namespace
}  // namespace lightfit
