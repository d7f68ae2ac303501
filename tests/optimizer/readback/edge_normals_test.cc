#include "optimizer/readback/edge_normals.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "geometry/affine_depth.h"
#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using testing::FloorReadback;
using testing::MatrixNear;
using testing::PlaneReadback;

// On straight edges the smoothed bit's gradient is the edge's normal, from lit to shadowed, within
// what a window of 5 x 5 binary pixels can tell.
TEST(EdgeNormals, FollowsStraightEdgesAtAnyAngle) {
  constexpr double kToleranceRad = 0.25;
  PlaneReadback readback = FloorReadback();
  const AffineDepth affine_depth(readback.camera, readback.kind);
  for (int degrees = 0; degrees < 360; degrees += 5) {
    const double angle = degrees * M_PI / 180.0;
    const Eigen::Vector2d normal(std::cos(angle), std::sin(angle));
    readback.shadow_bits.assign(readback.depth.size(), 0);
    readback.Cast(
        3, [&](int x, int y) { return normal.dot(Eigen::Vector2d(x - 20.2, y - 15.3)) > 0.0; });
    const Eigen::Vector2d found = EdgeNormals(readback.View(), affine_depth, 3, 2).At(20, 15);
    EXPECT_NEAR(found.norm(), 1.0, 1e-12);
    EXPECT_LT(std::acos(std::min(1.0, found.dot(normal))), kToleranceRad) << degrees << " degrees";
  }
}

TEST(EdgeNormals, IgnoresMissingSurfacesAndTheImagesBorder) {
  PlaneReadback readback = FloorReadback();
  const AffineDepth affine_depth(readback.camera, readback.kind);
  readback.Cast(0, [](int x, int) { return x >= 1; });
  for (int x = 0; x < 40; ++x) readback.depth[readback.Index(x, 16)] = std::nanf("");
  EXPECT_THAT(EdgeNormals(readback.View(), affine_depth, 0, 2).At(1, 15),
              MatrixNear(Eigen::Vector2d(1.0, 0.0), 1e-9));
}

TEST(EdgeNormals, IsZeroWithoutAnEdge) {
  PlaneReadback readback = FloorReadback();
  const AffineDepth affine_depth(readback.camera, readback.kind);
  EXPECT_EQ(EdgeNormals(readback.View(), affine_depth, 0, 2).At(20, 15), Eigen::Vector2d(0, 0));
  readback.Cast(0, [](int x, int y) { return x == 20 && y == 15; });  // a lone pixel: no direction
  EXPECT_EQ(EdgeNormals(readback.View(), affine_depth, 0, 2).At(20, 15), Eigen::Vector2d(0, 0));
  readback.depth.assign(readback.depth.size(), 1e10f);  // no surface at all
  EXPECT_EQ(EdgeNormals(readback.View(), affine_depth, 0, 2).At(20, 15), Eigen::Vector2d(0, 0));
}

// The gradient of the Gaussian-weighted plane that fits the bits best, sums taken plainly from the
// formula, for every window and up to the image's corners.
Eigen::Vector2d NormalPlainly(
    const Readback& readback, const AffineDepth& affine_depth, int bit, int window, int x, int y) {
  std::vector<Eigen::Vector4d> terms;  // weight, dx, dy, bit
  for (int dy = -window; dy <= window; ++dy) {
    for (int dx = -window; dx <= window; ++dx) {
      const int px = x + dx, py = y + dy;
      if (px < 0 || py < 0 || px >= readback.width() || py >= readback.height()) continue;
      const size_t pixel = static_cast<size_t>(py) * readback.width() + px;
      if (!affine_depth.IsSurface(readback.depth[pixel])) continue;
      const double sigma = 0.5 * window;
      terms.emplace_back(std::exp(-(dx * dx + dy * dy) / (2.0 * sigma * sigma)),
                         dx,
                         dy,
                         (readback.shadow_bits[pixel] >> bit) & 1u);
    }
  }
  double weight = 0.0, mean = 0.0;
  for (const Eigen::Vector4d& term : terms) {
    weight += term(0);
    mean += term(0) * term(3);
  }
  mean /= weight;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector4d& term : terms) {
    sum += term(0) * (term(3) - mean) * term.segment<2>(1);
  }
  return sum.norm() > 1e-9 ? Eigen::Vector2d(sum.normalized()) : Eigen::Vector2d(0.0, 0.0);
}

TEST(EdgeNormals, EqualsThePlainSumForEveryWindow) {
  const testing::TestScene scene(7, 3, 60, 44);
  const Readback view = scene.View();
  const AffineDepth affine_depth(view.camera, view.depth_kind);
  int num_edges = 0;
  for (int window = 1; window <= 8; ++window) {
    for (int bit = 0; bit < 3; ++bit) {
      const EdgeNormals normals(view, affine_depth, bit, window);
      for (int y = 0; y < view.height(); y += 3) {
        for (int x = 0; x < view.width(); x += 3) {
          if (!affine_depth.IsSurface(view.depth[static_cast<size_t>(y) * view.width() + x])) {
            continue;
          }
          const Eigen::Vector2d expected = NormalPlainly(view, affine_depth, bit, window, x, y);
          EXPECT_THAT(normals.At(x, y), MatrixNear(expected, 1e-6)) << x << ", " << y;
          num_edges += static_cast<int>(!expected.isZero());
        }
      }
    }
  }
  EXPECT_GE(num_edges, 500);
}

}  // namespace
}  // namespace lightfit
