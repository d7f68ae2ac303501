#include "partition/published/lloyd_error.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/partition/published/lloyd_view.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::LloydFigures;
using testing::Random;

constexpr double kNoWarp = std::numeric_limits<double>::infinity();

// Of formulas of a few operations each, in doubles.
constexpr double kRounding = 1e-12;

// Central differences of a step of 1e-6 keep nine digits or so.
constexpr double kDifferences = 1e-7;

// Half of the last of three or four digits.
constexpr double kDigits = 2e-3;

LloydView RandomView(Random& random) {
  LloydView view;
  view.near = random.LogUniform(0.01, 10.0);
  view.far = view.near * random.LogUniform(1.1, 1e4);
  view.half_angle_rad = random.Uniform(0.1, 1.3);
  return view;
}

double RandomWarp(const LloydView& view, Random& random) {
  return view.near * random.LogUniform(1.0, 1e2 * view.far / view.near);
}

// (5), (6) Place in the map, 0 ... 1 each, of what lies x aside at depth z. Finite warps only.
Eigen::Vector2d WarpedPlace(const LloydView& view, double warp, double x, double z) {
  const double far = warp + view.far - view.near, depth = warp + z - view.near;
  // The warp's own half angle: it is as wide as the view at the far plane.
  const double two_tan = view.far / far * 2.0 * std::tan(view.half_angle_rad);
  const double length = far - warp;
  return {x / (depth * two_tan) + 0.5,
          (far + warp) / (2.0 * length) - far * warp / (depth * length) + 0.5};
}

// (7), (8) from the derivatives of (5), (6).
TEST(LloydError, IsTexelWidthOverPixelWidth) {
  Random random(2);
  for (int i = 0; i < 300; ++i) {
    const LloydView view = RandomView(random);
    const double warp = view.near * random.LogUniform(1.0, 10.0 * view.far / view.near);
    const double z = random.LogUniform(view.near, view.far), step = 1e-6 * z;
    const double ds = WarpedPlace(view, warp, step, z).x() - WarpedPlace(view, warp, -step, z).x();
    const double dt =
        WarpedPlace(view, warp, 0.0, z + step).y() - WarpedPlace(view, warp, 0.0, z - step).y();
    const double pixel = ImageBeamWidth(view, z);
    EXPECT_NEAR(pixel, 2.0 * z * std::tan(view.half_angle_rad), kRounding * pixel);
    const double x_error = XError(view, warp, z), z_error = ZError(view, warp, z);
    // What differences of places lose, which are sums of terms of up to f' / (f - n).
    const double lost = 1e-15 * (warp + view.far) / (view.far - view.near);
    EXPECT_NEAR(2.0 * step / ds / pixel / x_error, 1.0, kDifferences + lost / std::abs(ds));
    EXPECT_NEAR(2.0 * step / dt / pixel / z_error, 1.0, kDifferences + lost / std::abs(dt));
  }
}

TEST(LloydError, IsLargestWhereTheFormulasSay) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const LloydView view = RandomView(random);
    const double warp = random.Int(0, 4) == 0 ? kNoWarp : RandomWarp(view, random);
    double m_x = 0.0, m_z = 0.0;
    for (int k = 0; k <= 1000; ++k) {
      const double z = view.near * std::pow(view.far / view.near, k / 1000.0);
      m_x = std::max(m_x, XError(view, warp, z));
      m_z = std::max(m_z, ZError(view, warp, z));
    }
    EXPECT_NEAR(m_x / MaxXError(view, warp), 1.0, 1e-9);
    EXPECT_NEAR(m_z / MaxZError(view, warp), 1.0, 1e-9);
    const double storage = MaxXError(view, warp) * MaxZError(view, warp);
    EXPECT_NEAR(WarpStorage(view, warp) / storage, 1.0, 1e-9);
  }
}

TEST(LloydError, OfNoWarpIsTheLimitOfWeakOnes) {
  const LloydView view = {1.0, 20.0, 0.5};
  for (const double z : {1.0, 3.0, 20.0}) {
    EXPECT_NEAR(XError(view, kNoWarp, z) / XError(view, 1e12, z), 1.0, 1e-9);
    EXPECT_NEAR(ZError(view, kNoWarp, z) / ZError(view, 1e12, z), 1.0, 1e-9);
  }
  EXPECT_NEAR(WarpStorage(view, kNoWarp) / WarpStorage(view, 1e12), 1.0, 1e-9);
}

TEST(LloydError, EtaRunsFromNoWarpToThatOfPerspectiveMaps) {
  Random random(4);
  for (int i = 0; i < 200; ++i) {
    const LloydView view = RandomView(random);
    EXPECT_EQ(WarpOfEta(view, -1.0), kNoWarp);
    EXPECT_NEAR(WarpOfEta(view, 0.0) / LispsmWarp(view), 1.0, kRounding);
    EXPECT_NEAR(WarpOfEta(view, 1.0) / view.near, 1.0, kRounding);
  }
}

TEST(LloydError, IsLinearInEta) {
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const LloydView view = RandomView(random);
    const auto x_error = [&](double eta) { return MaxXError(view, WarpOfEta(view, eta)); };
    const auto z_error = [&](double eta) { return MaxZError(view, WarpOfEta(view, eta)); };
    for (const double sign : {-1.0, 1.0}) {
      const double share = random.Uniform(0.0, 1.0), eta = sign * share;
      const double between = z_error(0.0) + share * (z_error(sign) - z_error(0.0));
      EXPECT_NEAR(z_error(eta) / between, 1.0, 1e-9);
    }
    const double share = random.Uniform(0.0, 1.0);
    EXPECT_NEAR(
        x_error(-share) / (x_error(0.0) + share * (x_error(-1.0) - x_error(0.0))), 1.0, 1e-9);
  }
}

// All warps from that of perspective maps to that of light-space ones need as many texels; beyond
// they need more.
TEST(LloydError, StorageIsLeastUpToLispsm) {
  Random random(6);
  for (int i = 0; i < 100; ++i) {
    const LloydView view = RandomView(random);
    const double least = WarpStorage(view, view.near);
    double before = least;
    for (const double eta : {0.7, 0.2, 1e-9, -0.1, -0.4, -0.9, -1.0}) {
      const double storage = WarpStorage(view, WarpOfEta(view, eta));
      if (eta > 0.0) {
        EXPECT_EQ(storage, least) << eta;
      } else {
        EXPECT_GT(storage, before) << eta;
      }
      before = storage;
    }
  }
}

// (17), (18) are (12) of parts that are alike, and C is where (18) leads.
TEST(LloydError, PartsAddUp) {
  Random random(7);
  for (int i = 0; i < 100; ++i) {
    const LloydView view = RandomView(random);
    double before = std::numeric_limits<double>::infinity();
    for (int parts = 1; parts <= 16; ++parts) {
      LloydView part = view;
      part.far = part.near * std::pow(view.far / view.near, 1.0 / parts);
      EXPECT_NEAR(OverheadStorage(view, parts) / (parts * WarpStorage(part, kNoWarp)), 1.0, 1e-9);
      const double warped = OverheadWarpStorage(view, parts);
      EXPECT_NEAR(warped / (parts * WarpStorage(part, LispsmWarp(part))), 1.0, 1e-9);
      const double across = part.far / part.near;  // the part's far plane over its near plane
      EXPECT_NEAR(BehindStorage(view, parts) / (parts * across * across), 1.0, 1e-9);
      EXPECT_LT(warped, before);
      EXPECT_GT(warped, LogarithmicZError(view));
      before = warped;
    }
    EXPECT_NEAR(OverheadWarpStorage(view, 1e7) / LogarithmicZError(view), 1.0, 1e-5);
  }
}

// Appendix C: t = ln(z/n) / ln(f/n).
TEST(LloydError, LogarithmicTexelsAreAsWideAsDepthDemands) {
  Random random(8);
  for (int i = 0; i < 100; ++i) {
    const LloydView view = RandomView(random);
    const double z = random.LogUniform(view.near, view.far), step = 1e-5 * z;
    const auto place = [&](double depth) {
      return std::log(depth / view.near) / std::log(view.far / view.near);
    };
    const double width = 2.0 * step / (place(z + step) - place(z - step));
    EXPECT_NEAR(width / ImageBeamWidth(view, z) / LogarithmicZError(view), 1.0, 1e-6);
  }
}

TEST(LloydError, BehindIsLeastAtTwiceTheLogarithm) {
  Random random(9);
  for (int i = 0; i < 100; ++i) {
    const LloydView view = RandomView(random);
    const double best = BestPartsBehind(view), least = BehindStorage(view, best);
    const double log_alpha = std::log(view.far / view.near);
    EXPECT_NEAR(best / (2.0 * log_alpha), 1.0, kRounding);
    EXPECT_NEAR(least / (2.0 * std::exp(1.0) * log_alpha), 1.0, kRounding);
    for (int k = 0; k < 20; ++k) {
      EXPECT_GE(BehindStorage(view, best * random.LogUniform(0.01, 100.0)), least * (1.0 - 1e-9));
    }
  }
}

// (22), (23) leave out 1 / (2 tan theta) and, of the second, 1/4: a fourth of the maps are parts.
TEST(LloydError, GrowsAsTheRatesForDeepViews) {
  const double theta = M_PI / 6.0, two_tan = 2.0 * std::tan(theta);
  for (const int maps : {4, 8}) {
    const LloydView view = {1.0, 1e40, theta};
    EXPECT_NEAR(
        OverheadStorage(view, maps) * two_tan / (maps * std::pow(1e40, 2.0 / maps)), 1.0, 1e-4);
    EXPECT_NEAR(OverheadWarpStorage(view, 0.25 * maps) * two_tan /
                    (0.25 * maps * std::pow(1e40, 4.0 / maps)),
                1.0,
                1e-4);
  }
}

TEST(LloydFigure5, ShowsErrorsAlongTheView) {
  const LloydView view = {1.0, 20.0, 0.4};
  const double lispsm = LispsmWarp(view);
  const auto z_term = [&](double warp, double z) {
    return ZError(view, warp, z) * 2.0 * std::tan(view.half_angle_rad) / (view.far - view.near);
  };
  const auto x_term = [&](double warp, double z) { return XError(view, warp, z) / view.far; };
  for (const int end : {0, 1}) {
    const double z = end == 0 ? view.near : view.far;
    EXPECT_NEAR(z_term(view.near, z), LloydFigures::kZTermPsm[end], kRounding);
    EXPECT_NEAR(z_term(lispsm, z) / LloydFigures::kZTermLispsm[end], 1.0, kDigits);
    EXPECT_NEAR(z_term(kNoWarp, z), LloydFigures::kZTermUnwarped[end], kRounding);
  }
  double least = std::numeric_limits<double>::infinity(), at = 0.0;
  for (double z = 1.0; z <= 20.0; z += 1e-3) {
    if (z_term(lispsm, z) < least) least = z_term(lispsm, z), at = z;
  }
  EXPECT_NEAR(least / LloydFigures::kZTermLispsmLeast, 1.0, kDigits);
  EXPECT_NEAR(at / LloydFigures::kDepthOfLeast, 1.0, kDigits);
  const double warps[] = {view.near, lispsm, kNoWarp};
  for (const int i : {0, 1, 2}) {
    EXPECT_NEAR(x_term(warps[i], view.near) / LloydFigures::kXTermAtNear[i], 1.0, kDigits);
    EXPECT_NEAR(x_term(warps[i], view.far), LloydFigures::kXTermAtFar, kRounding);
  }
}

TEST(LloydFigure6, ShowsTheRangeOfWarps) {
  const LloydView view = {1.0, 100.0, M_PI / 4.0};
  for (const int i : {0, 1, 2}) {
    const double warp = WarpOfEta(view, i - 1.0);
    EXPECT_NEAR(MaxXError(view, warp) / LloydFigures::kOfEta[i][0], 1.0, 1e-9);
    EXPECT_NEAR(MaxZError(view, warp) / LloydFigures::kOfEta[i][1], 1.0, 1e-9);
    EXPECT_NEAR(WarpStorage(view, warp) / LloydFigures::kOfEta[i][2], 1.0, 1e-9);
  }
}

TEST(LloydFigure10, ShowsSplitsByDepthOverhead) {
  const LloydView view = {1.0, 1000.0, M_PI / 6.0};
  for (size_t i = 0; i < std::size(LloydFigures::kParts); ++i) {
    const double storage = OverheadWarpStorage(view, LloydFigures::kParts[i]);
    EXPECT_NEAR(storage / LloydFigures::kOverheadWarp[i], 1.0, kDigits);
  }
  EXPECT_NEAR(LogarithmicZError(view) / LloydFigures::kOverheadLimit, 1.0, kDigits);
}

TEST(LloydFigure12, ShowsStorageByNumberOfMaps) {
  const LloydView view = {1.0, 1000.0, M_PI / 6.0};
  for (size_t i = 0; i < std::size(LloydFigures::kBehindMaps); ++i) {
    const double storage = BehindStorage(view, LloydFigures::kBehindMaps[i]);
    EXPECT_NEAR(storage / LloydFigures::kBehind[i], 1.0, 2.0 * kDigits);
  }
  for (size_t i = 0; i < std::size(LloydFigures::kBehindFaceMaps); ++i) {
    const double storage = BehindFaceWarpStorage(view, 0.25 * LloydFigures::kBehindFaceMaps[i]);
    EXPECT_NEAR(storage / LloydFigures::kBehindFaceWarp[i], 1.0, 3.0 * kDigits);
  }
  for (size_t i = 0; i < std::size(LloydFigures::kOverheadMaps); ++i) {
    const double storage = OverheadStorage(view, LloydFigures::kOverheadMaps[i]);
    EXPECT_NEAR(storage / LloydFigures::kOverhead[i], 1.0, kDigits);
  }
}

TEST(LloydFigure13, ShowsWhereFacesPay) {
  for (size_t i = 0; i < std::size(LloydFigures::kAlphas); ++i) {
    const LloydView view = {1.0, LloydFigures::kAlphas[i], M_PI / 6.0};
    EXPECT_EQ(testing::FirstMapsOfFaces(view), LloydFigures::kFirstMaps[i])
        << LloydFigures::kAlphas[i];
  }
}

}  // namespace
}  // namespace lightfit
