// Lloyd 2006, 4: how many texels per pixel a map needs so that perspective aliasing vanishes, for a
// sun straight above a level view. Measured from the matrices, held against his closed forms.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "methods/lispsm.h"
#include "methods/method.h"
#include "tests/methods/random_input.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using testing::LevelView;
using testing::Texel;

// M_x and M_z are the largest ratios of a texel's extent, along x and along the view, to a pixel's,
// 2 z tan(theta) over the image's width; the storage factor is their product when map and image
// have one texel and one pixel.
double StorageFactor(const MethodInput& input, const MethodMap& map) {
  const double tan_theta = std::tan(0.5);
  double m_x = 0.0, m_z = 0.0;
  for (int i = 0; i <= 2000; ++i) {
    const double z = input.camera.near * std::pow(input.camera.far / input.camera.near, i / 2000.0);
    const double step = 1e-6 * z;
    const Eigen::Vector3d middle(0.0, 0.0, -z);
    const Eigen::Vector3d dx(step, 0.0, 0.0), dz(0.0, 0.0, step);
    const Eigen::Vector2d size(input.map.width, input.map.height);
    const Eigen::Vector2d along_x =
        (Texel(map, middle + dx) - Texel(map, middle - dx)).cwiseQuotient(size) / (2.0 * step);
    const Eigen::Vector2d along_z =
        (Texel(map, middle + dz) - Texel(map, middle - dz)).cwiseQuotient(size) / (2.0 * step);
    m_x = std::max(m_x, 1.0 / (along_x.norm() * 2.0 * z * tan_theta));
    m_z = std::max(m_z, 1.0 / (along_z.norm() * 2.0 * z * tan_theta));
  }
  return m_x * m_z;
}

// Differences of places at 1e-6 of the depth keep nine digits or so.
constexpr double kDifferences = 1e-5;

constexpr double kRatio = 20.0;  // far over near of LevelView()

TEST(StorageFactor, UnwarpedIsLloydsForInfiniteN) {
  const MethodInput input = LevelView({0.0, -1.0, 0.0});
  const double expected = kRatio * (kRatio - 1.0) / (2.0 * std::tan(0.5));
  const double measured = StorageFactor(input, *SetUpMap(Method::kFocused, input));
  EXPECT_NEAR(measured / expected, 1.0, kDifferences);
}

TEST(StorageFactor, WarpsUpToLispsmReachTheLeast) {
  const MethodInput input = LevelView({0.0, -1.0, 0.0});
  const double expected = (kRatio - 1.0) / (2.0 * std::tan(0.5));
  for (const Method method :
       {Method::kLispsm, Method::kLispsmSimple, Method::kPerspective, Method::kTrapezoidal}) {
    const double measured = StorageFactor(input, *SetUpMap(method, input));
    EXPECT_NEAR(measured / expected, 1.0, kDifferences) << MethodName(method);
  }
}

// Lloyd (12): beyond n' of LiSPSM it grows.
TEST(StorageFactor, FollowsLloydForWeakerWarps) {
  const MethodInput input = LevelView({0.0, -1.0, 0.0});
  const double n = input.camera.near, f = input.camera.far;
  for (const double warp : {7.0, 20.0, 100.0}) {
    LispsmOptions options;
    options.n = warp;
    const double expected = (f / n - 1.0) / (2.0 * std::tan(0.5)) * warp * warp * f /
                            (n * (warp + f - n) * (warp + f - n));
    const double measured = StorageFactor(input, *LispsmMap(input, options));
    EXPECT_NEAR(measured / expected, 1.0, kDifferences) << warp;
  }
}

}  // namespace
}  // namespace lightfit
