#include "partition/shipped/paraboloid_edges.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "partition/shipped/paraboloid.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::Random;

// An edge in front of the light, in one half, seen at an angle of any size.
struct Edge {
  Eigen::Vector3d from, to;
  double angle() const { return std::atan2(from.cross(to).norm(), from.dot(to)); }
};
Edge RandomEdge(Random& random) {
  const double length = random.LogUniform(1e-2, 3.0);
  while (true) {
    const Eigen::Vector3d from = random.InCube(1.0);
    const Eigen::Vector3d to = from + length * random.UnitVector();
    if (from.z() < 0.0 || to.z() < 0.0 || from.cross(to).norm() < 1e-3) continue;
    return {from, to};
  }
}

// Furthest that the image of the edge is from the chord of its ends, by going along the edge.
double SampledError(const Edge& edge) {
  const Eigen::Vector2d begin = ParaboloidFromDirection(edge.from.normalized());
  const Eigen::Vector2d chord = ParaboloidFromDirection(edge.to.normalized()) - begin;
  const Eigen::Vector2d across = Eigen::Vector2d(-chord.y(), chord.x()).normalized();
  double most = 0.0;
  // Even in angle, as an edge that ends near the light turns fast there.
  const Eigen::Vector3d a = edge.from.normalized();
  const Eigen::Vector3d b = (edge.to - edge.to.dot(a) * a).normalized();
  constexpr int kSteps = 1000;
  for (int i = 0; i <= kSteps; ++i) {
    const double angle = edge.angle() * i / kSteps;
    const Eigen::Vector2d uv = ParaboloidFromDirection(std::cos(angle) * a + std::sin(angle) * b);
    most = std::max(most, std::abs(across.dot(uv - begin)));
  }
  return most;
}

TEST(ChordError, IsThatOfTheSampledArcAndAtMostAnEighthOfTheSquaredAngle) {
  double largest = 0.0;
  Random random(1);
  for (int i = 0; i < 3000; ++i) {
    const Edge edge = RandomEdge(random);
    const double error = ChordError(edge.from.normalized(), edge.to.normalized());
    // The highest point lies between two samples: second order in the step.
    EXPECT_NEAR(error, SampledError(edge), 1e-6);
    const double bound = edge.angle() * edge.angle() / 8.0;
    EXPECT_LE(error, bound * (1.0 + 1e-9) + 1e-15);
    largest = std::max(largest, error / bound);
  }
  std::printf("largest error over phi^2 / 8: %.4f\n", largest);
  EXPECT_GT(largest, 0.9);
}

// The bound's order: s = |m_z| phi^2 / (8 (1 + d_z)^2) for small edges.
TEST(ChordError, IsForSmallEdgesThePlanesSlantByTheDensity) {
  Random random(2);
  for (int i = 0; i < 500; ++i) {
    Eigen::Vector3d d = random.UnitVector();
    d.z() = std::abs(d.z());
    const Eigen::Vector3d across = d.cross(random.UnitVector()).normalized();
    const double half_angle = 1e-3;
    const Eigen::Vector3d from = (d - half_angle * across).normalized();
    const Eigen::Vector3d to = (d + half_angle * across).normalized();
    if (from.z() < 0.0 || to.z() < 0.0) continue;
    const double m_z = std::abs(from.cross(to).normalized().z());
    const double phi = 2.0 * half_angle;
    const double foretold = m_z * phi * phi / 8.0 * ParaboloidDensity(d.z());
    EXPECT_NEAR(ChordError(from, to), foretold, 1e-3 * foretold + 1e-15);
  }
}

TEST(ChordError, IsNoneTowardsTheLightAndTheWholeRadiusOfHalfTheRim) {
  EXPECT_EQ(ChordError({0.6, 0.0, 0.8}, {0.6, 0.0, 0.8}), 0.0);
  // A plane through the axis is seen as a straight line.
  EXPECT_NEAR(ChordError({0.6, 0.0, 0.8}, {-0.8, 0.0, 0.6}), 0.0, 1e-15);
  const double almost = 1e-6;
  EXPECT_NEAR(ChordError({1.0, 0.0, 0.0}, Eigen::Vector3d(-1.0, almost, 0.0).normalized()),
              1.0,
              2.0 * almost);
}

// Where the arc's circle is: its radius is 1 / |m_z|, and it meets the rim in opposite points.
TEST(ChordError, BelongsToACircleThroughOppositePointsOfTheRim) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    Eigen::Vector3d m = random.UnitVector();
    if (std::abs(m.z()) < 0.05) continue;
    const Eigen::Vector2d centre = m.head<2>() / m.z();
    const Eigen::Vector3d e = FrameAlong(m).row(0), f = FrameAlong(m).row(1);
    for (int step = 0; step < 20; ++step) {
      const double angle = 0.1 + 0.3 * step;
      const Eigen::Vector3d d = std::cos(angle) * e + std::sin(angle) * f;
      if (d.z() < -0.9) continue;
      EXPECT_NEAR((ParaboloidFromDirection(d) - centre).norm() * std::abs(m.z()), 1.0, 1e-9);
    }
  }
}

TEST(WidestEdge, IsFiveDegreesForHalfATexelOf1024) {
  const double degrees = WidestEdge(1024, 0.5) * 180.0 / M_PI;
  std::printf("widest edge for half a texel of 1024: %.3f degrees\n", degrees);
  EXPECT_NEAR(degrees, 5.06, 0.005);
  // As wide as that, at the rim and along it, an edge is off by that much.
  const double angle = WidestEdge(1024, 0.5);
  const double texels =
      512.0 * ChordError({1.0, 0.0, 0.0}, {std::cos(angle), std::sin(angle), 0.0});
  EXPECT_LE(texels, 0.5);
  EXPECT_GE(texels, 0.49);
}

TEST(EdgeAngleBound, HoldsForEveryEdgeNoNearerThanItsDistance) {
  Random random(4);
  double largest = 0.0;
  for (int i = 0; i < 5000; ++i) {
    const Edge edge = {random.InCube(1.0), random.InCube(1.0)};
    const Eigen::Vector3d along = edge.to - edge.from;
    const double t = std::clamp(-edge.from.dot(along) / along.squaredNorm(), 0.0, 1.0);
    const double distance = (edge.from + t * along).norm();
    const double bound = EdgeAngleBound(along.norm(), distance);
    EXPECT_LE(edge.angle(), bound * (1.0 + 1e-9));
    largest = std::max(largest, edge.angle() / bound);
  }
  EXPECT_GT(largest, 0.99);
  EXPECT_NEAR(EdgeAngleBound(2.0, 1.0), 0.5 * M_PI, 1e-12);
}

TEST(EdgeParts, AreAsManyAsKeepEveryPartWithinTheErrorAndNoMoreThanTheBoundAsks) {
  Random random(5);
  int num_cut = 0;
  for (int i = 0; i < 500; ++i) {
    const Edge edge = RandomEdge(random);
    const Eigen::Vector3d along = edge.to - edge.from;
    const double t = std::clamp(-edge.from.dot(along) / along.squaredNorm(), 0.0, 1.0);
    const double distance = (edge.from + t * along).norm();
    const int size = random.Int(64, 2048);
    const double allowed = random.Uniform(0.25, 2.0);
    const int parts = EdgeParts(along.norm(), distance, size, allowed);
    num_cut += parts > 1 ? 1 : 0;
    for (int part = 0; part < std::min(parts, 300); ++part) {
      const Edge piece = {edge.from + along * part / parts, edge.from + along * (part + 1) / parts};
      const double texels = 0.5 * size * ChordError(piece.from.normalized(), piece.to.normalized());
      EXPECT_LE(texels, allowed * (1.0 + 1e-9));
    }
    if (parts > 1) {
      EXPECT_GT(EdgeAngleBound(along.norm() / (parts - 1), distance), WidestEdge(size, allowed));
    }
  }
  EXPECT_GT(num_cut, 100);
  EXPECT_EQ(EdgeParts(1.0, 1e-12, 1024, 0.5), kMostEdgeParts);
}

}  // namespace
}  // namespace lightfit
