// DepthGradientAt where the surface does not continue: with SampleOptions::use_outlines the
// derivative is that of the side that does, without it there is none.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <optional>

#include "geometry/affine_depth.h"
#include "optimizer/readback/surfaces.h"
#include "tests/testing/plane_readback.h"

namespace lightfit {
namespace {

using testing::PlaneReadback;

constexpr int kWidth = 24, kHeight = 18;

// Affine depth given as a function of the pixel, 0 for the background.
class DepthImage {
 public:
  explicit DepthImage(const std::function<double(int, int)>& affine)
      : readback_(testing::FloorReadback(testing::FloorCamera(kWidth, kHeight))) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double d = affine(x, y);
        readback_.depth[readback_.Index(x, y)] = d > 0.0 ? static_cast<float>(1.0 / d) : 1e10f;
      }
    }
  }

  std::optional<DepthGradient> At(int x, int y, bool use_outlines = true) const {
    const AffineDepth affine_depth(readback_.camera, readback_.kind);
    SampleOptions options;
    options.use_outlines = use_outlines;
    DepthGradient gradient;
    if (!DepthGradientAt(readback_.View(), affine_depth, options, x, y, &gradient)) {
      return std::nullopt;
    }
    return gradient;
  }

 private:
  PlaneReadback readback_;
};

// Depth is float: half a unit in the last place of affine depths below 1, times two.
constexpr double kRounding = 2.0 * 0x1p-24;

void ExpectGradient(const std::optional<DepthGradient>& gradient,
                    double d,
                    double d_x,
                    double d_y) {
  ASSERT_TRUE(gradient.has_value());
  EXPECT_NEAR(gradient->d, d, kRounding);
  EXPECT_NEAR(gradient->d_x, d_x, kRounding);
  EXPECT_NEAR(gradient->d_y, d_y, kRounding);
}

// Two planes, and which of them fills the pixel.
struct Plane {
  double d, d_x, d_y;
  double At(int x, int y) const { return d + d_x * x + d_y * y; }
};
constexpr Plane kNear = {0.50, 2e-3, -1e-3};
constexpr Plane kFar = {0.10, -1e-3, 5e-4};

void ExpectExactEverywhere(const std::function<bool(int, int)>& is_near) {
  const DepthImage image([&](int x, int y) { return (is_near(x, y) ? kNear : kFar).At(x, y); });
  int num_outlines = 0;
  for (int y = 1; y + 1 < kHeight; ++y) {
    for (int x = 1; x + 1 < kWidth; ++x) {
      SCOPED_TRACE(std::to_string(x) + ", " + std::to_string(y));
      const Plane& plane = is_near(x, y) ? kNear : kFar;
      ExpectGradient(image.At(x, y), plane.At(x, y), plane.d_x, plane.d_y);
      const bool is_outline =
          is_near(x - 1, y) != is_near(x, y) || is_near(x + 1, y) != is_near(x, y) ||
          is_near(x, y - 1) != is_near(x, y) || is_near(x, y + 1) != is_near(x, y);
      EXPECT_EQ(image.At(x, y, /*use_outlines=*/false).has_value(), !is_outline);
      num_outlines += static_cast<int>(is_outline);
    }
  }
  EXPECT_GE(num_outlines, 2 * (std::min(kWidth, kHeight) - 2));
}

TEST(DepthGradientAt, IsExactOnBothSidesOfAStep) {
  ExpectExactEverywhere([](int x, int) { return x >= 11; });
  ExpectExactEverywhere([](int x, int) { return x < 11; });
  ExpectExactEverywhere([](int, int y) { return y >= 7; });
  ExpectExactEverywhere([](int, int y) { return y < 7; });
}

TEST(DepthGradientAt, IsExactAtACorner) {
  ExpectExactEverywhere([](int x, int y) { return x >= 11 && y >= 7; });
  ExpectExactEverywhere([](int x, int y) { return x < 11 || y < 7; });
}

// A wall one pixel wide continues along itself alone. Across it there is no right answer; the
// difference that is nearer in depth is taken.
TEST(DepthGradientAt, AlongAWallOfOnePixelIsExact) {
  const DepthImage image([](int x, int y) {
    if (x == 10) return kNear.At(x, y);
    return kFar.At(x, y) + (x < 10 ? 0.05 : 0.0);  // nearer to the left
  });
  for (int y = 1; y + 1 < kHeight; ++y) {
    const double to_left = kNear.At(10, y) - (kFar.At(9, y) + 0.05);
    ExpectGradient(image.At(10, y), kNear.At(10, y), to_left, kNear.d_y);
    EXPECT_FALSE(image.At(10, y, /*use_outlines=*/false).has_value());
  }
}

TEST(DepthGradientAt, BesideTheBackgroundIsThatOfTheSurface) {
  // A strip of surface two pixels wide, upright and lying.
  for (const bool upright : {true, false}) {
    const DepthImage image([upright](int x, int y) {
      const int across = upright ? x : y;
      return across == 8 || across == 9 ? kNear.At(x, y) : 0.0;
    });
    for (int along = 1; along + 1 < kHeight; ++along) {
      for (const int across : {8, 9}) {
        const int x = upright ? across : along, y = upright ? along : across;
        ExpectGradient(image.At(x, y), kNear.At(x, y), kNear.d_x, kNear.d_y);
        EXPECT_FALSE(image.At(x, y, /*use_outlines=*/false).has_value());
      }
    }
  }
}

TEST(DepthGradientAt, HasNoneWhereNothingContinues) {
  // Alone; with neighbours along one direction only; on the background.
  const DepthImage image([](int x, int y) {
    const bool alone = x == 5 && y == 5;
    const bool line = x == 12 && y >= 3 && y <= 9;
    return alone || line ? kNear.At(x, y) : 0.0;
  });
  EXPECT_FALSE(image.At(5, 5).has_value());
  EXPECT_FALSE(image.At(12, 6).has_value());
  EXPECT_FALSE(image.At(6, 5).has_value());
}

TEST(DepthGradientAt, HasNoneInTheOutermostPixels) {
  const DepthImage image([](int x, int y) { return kNear.At(x, y); });
  for (int x = 0; x < kWidth; ++x) {
    EXPECT_FALSE(image.At(x, 0).has_value());
    EXPECT_FALSE(image.At(x, kHeight - 1).has_value());
  }
  for (int y = 0; y < kHeight; ++y) {
    EXPECT_FALSE(image.At(0, y).has_value());
    EXPECT_FALSE(image.At(kWidth - 1, y).has_value());
  }
}

// On a smooth plane nothing changes: central differences either way, to the last bit.
TEST(DepthGradientAt, OnPlanesIsTheSameWithAndWithoutOutlines) {
  const DepthImage image([](int x, int y) { return kNear.At(x, y); });
  for (int y = 1; y + 1 < kHeight; ++y) {
    for (int x = 1; x + 1 < kWidth; ++x) {
      const auto with = image.At(x, y), without = image.At(x, y, /*use_outlines=*/false);
      ASSERT_TRUE(with.has_value());
      ASSERT_TRUE(without.has_value());
      EXPECT_EQ(with->d_x, without->d_x);
      EXPECT_EQ(with->d_y, without->d_y);
    }
  }
}

}  // namespace
}  // namespace lightfit
