// How far off forecasts may be.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "optimizer/figures/foretell.h"

namespace lightfit {
namespace {

double FactorOf(int width, int height, bool knows_facing) {
  const Light sun = Light::Directional("sun", {0.0, 0.0, -1.0}, 3);
  const std::vector<uint32_t> bits(static_cast<size_t>(width) * height);
  Readback readback;
  readback.camera.width = width;
  readback.camera.height = height;
  if (knows_facing) readback.facing_bits = bits;
  return ForecastFactor(readback, sun);
}

TEST(ForecastFactor, IsSmallerWithTheThirdStateWhateverTheSize) {
  for (const int side : {20, 180, 360, 900}) {
    EXPECT_DOUBLE_EQ(FactorOf(side, side, true), 1.8);
    EXPECT_DOUBLE_EQ(FactorOf(side, 2 * side, false), 2.3);
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
  EXPECT_DOUBLE_EQ(ForecastFactor(readback, Light::Directional("sun", down, 0)), 2.3);
  EXPECT_DOUBLE_EQ(ForecastFactor(readback, Light::Directional("rim", down, 1)), 1.8);
}

}  // namespace
}  // namespace lightfit
