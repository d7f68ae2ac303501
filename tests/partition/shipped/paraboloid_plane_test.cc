#include "partition/shipped/paraboloid_plane.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "partition/shipped/paraboloid.h"
#include "tests/partition/shipped/surrounded_lamp.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::Random;
using testing::SurroundedLamp;

// Twin of the footprint: the texel is moved in the map, its ray meets the sample's plane, and that
// point moves on the screen. By central differences.
double FootprintByDifferences(const ParaboloidPair& pair,
                              const Light& light,
                              const Samples& samples,
                              size_t i) {
  // Rays of the plane d = d0 + d_x x + d_y y are linear in (x, y, 1).
  const Eigen::Matrix<double, 3, 4>& m = samples.ray_from_screen;
  const double d0 = samples.d[i] - samples.d_x[i] * samples.x[i] - samples.d_y[i] * samples.y[i];
  Eigen::Matrix3d ray_from_plane;
  ray_from_plane << m.col(0) + samples.d_x[i] * m.col(2), m.col(1) + samples.d_y[i] * m.col(2),
      m.col(3) + d0 * m.col(2);
  const Eigen::Matrix3d plane_from_ray = ray_from_plane.inverse();
  const Eigen::Matrix3d ray_from_direction = RayFromWorld(light).leftCols<3>();
  const Sample sample = samples.At(i);
  const ParaboloidPlace place =
      pair.At(light.position + ray_from_direction.transpose() * sample.X.normalized());
  const auto screen = [&](const Eigen::Vector2d& texel) -> Eigen::Vector2d {
    const Eigen::Vector3d direction = pair.RayAt({place.half, texel}).direction;
    return (plane_from_ray * ray_from_direction * direction).hnormalized();
  };
  constexpr double kStep = 1e-4;
  Eigen::Matrix2d J;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(axis);
    J.col(axis) = (screen(place.texel + step) - screen(place.texel - step)) / (2.0 * kStep);
  }
  return J.norm() / std::sqrt(2.0);
}

TEST(ParaboloidPlane, SumsTheFootprintsThatTexelsHaveOnTheScreen) {
  int num_lamps = 0;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const SurroundedLamp lamp(seed);
    const Surfaces surfaces = lamp.FindSurfaces();
    const Samples samples = lamp.Select(surfaces);
    if (samples.size() < 20) continue;
    ++num_lamps;
    Random random(seed);
    const ParaboloidPair pair = *MakeParaboloidPair(lamp.light, random.UnitVector(), 2 * 200 * 200);
    double sum = 0.0;
    for (size_t i = 0; i < samples.size(); ++i) {
      sum += samples.weight[i] * FootprintByDifferences(pair, lamp.light, samples, i);
    }
    const std::vector<DirectionSample> directions = DirectionSamples(lamp.light, samples);
    ASSERT_EQ(directions.size(), samples.size());
    EXPECT_NEAR(SumOfFootprints(pair.normal, pair.size, directions) / sum, 1.0, 1e-5);
    // The mean that the choice is made by is the same sum in units of its least.
    double all = 0.0;
    for (const DirectionSample& sample : directions) {
      all += sample.weight * std::sqrt(0.5 * sample.G.trace());
    }
    EXPECT_NEAR(PlaneWithCosts(pair.normal, directions).footprints * all * 2.0 / pair.size / sum,
                1.0,
                1e-5);
  }
  EXPECT_GT(num_lamps, 2);
}

TEST(ParaboloidPlane, HasTheBestOfTwoHundredNormalsAndNearlyOfAll) {
  double worst = 1.0;
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const SurroundedLamp lamp(seed);
    const Surfaces surfaces = lamp.FindSurfaces();
    const std::vector<DirectionSample> samples =
        DirectionSamples(lamp.light, lamp.Select(surfaces));
    if (samples.size() < 20) continue;
    const ParaboloidPlane best = BestParaboloidPlane(samples);
    for (const Eigen::Vector3d& normal : ParaboloidNormals()) {
      EXPECT_GE(SumOfFootprints(normal, 1, samples),
                SumOfFootprints(best.normal, 1, samples) * (1.0 - 1e-12));
    }
    double least = 1e300;
    Random random(seed);
    for (int i = 0; i < 2000; ++i) {
      least = std::min(least, PlaneWithCosts(random.UnitVector(), samples).footprints);
    }
    worst = std::max(worst, best.footprints / least);
  }
  std::printf("footprints of the best of 200 normals over those of the best of 2000: %.4f\n",
              worst);
  EXPECT_LT(worst, 1.03);
}

TEST(ParaboloidNormals, AreTwoHundredSpreadOverAHalfSphere) {
  const std::vector<Eigen::Vector3d>& normals = ParaboloidNormals();
  ASSERT_EQ(normals.size(), 200u);
  Random random(3);
  double widest = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d d = random.UnitVector();
    double most = 0.0;
    for (const Eigen::Vector3d& normal : normals) most = std::max(most, std::abs(normal.dot(d)));
    widest = std::max(widest, std::acos(std::min(most, 1.0)));
  }
  std::printf("widest gap between normals: %.2f degrees\n", widest * 180.0 / M_PI);
  EXPECT_LT(widest, 12.0 * M_PI / 180.0);
  for (const Eigen::Vector3d& normal : normals) EXPECT_NEAR(normal.norm(), 1.0, 1e-12);
}

TEST(ParaboloidPlane, AvoidsTrianglesAsMuchAsThePenaltySays) {
  Random random(4);
  // Samples all around the horizon want a level plane; triangles that stand there do not.
  std::vector<DirectionSample> samples;
  std::vector<CasterTriangle> triangles;
  for (int i = 0; i < 100; ++i) {
    const double angle = 2.0 * M_PI * i / 100.0;
    const Eigen::Vector3d d(std::cos(angle), std::sin(angle), 0.0);
    samples.push_back({d, Eigen::Matrix3d::Identity() - d * d.transpose(), 1.0});
    if (std::abs(d.x()) < 0.5) continue;  // room for a plane that passes through y
    triangles.push_back({d + Eigen::Vector3d(0.0, 0.0, 0.3),
                         d + Eigen::Vector3d(0.0, 0.0, -0.3),
                         1.1 * d + Eigen::Vector3d(0.0, 0.0, -0.3)});
  }
  const ParaboloidPlane without = BestParaboloidPlane(samples);
  EXPECT_GT(std::abs(without.normal.z()), 0.99);
  EXPECT_EQ(without.share_cut, 0.0);  // none given
  const ParaboloidPlane none = BestParaboloidPlane(samples, triangles, 0.0);
  EXPECT_EQ(none.normal, without.normal);
  EXPECT_GT(none.share_cut, 0.9);
  double last_share = 2.0, last_footprints = 0.0;
  for (const double penalty : {0.0, 0.1, 1.0, 10.0}) {
    const ParaboloidPlane plane = BestParaboloidPlane(samples, triangles, penalty);
    EXPECT_LE(plane.share_cut, last_share);
    EXPECT_GE(plane.footprints, last_footprints);
    last_share = plane.share_cut;
    last_footprints = plane.footprints;
    // Twin: no other normal is cheaper.
    for (const Eigen::Vector3d& normal : ParaboloidNormals()) {
      const ParaboloidPlane other = PlaneWithCosts(normal, samples, triangles);
      EXPECT_GE(other.footprints + penalty * other.share_cut,
                plane.footprints + penalty * plane.share_cut - 1e-12);
    }
  }
  EXPECT_EQ(last_share, 0.0);
}

TEST(ParaboloidPlane, IsSomePlaneWithoutSamples) {
  const ParaboloidPlane plane = BestParaboloidPlane({});
  EXPECT_EQ(plane.footprints, 1.0);
  EXPECT_EQ(plane.normal, ParaboloidNormals().front());
}

}  // namespace
}  // namespace lightfit
