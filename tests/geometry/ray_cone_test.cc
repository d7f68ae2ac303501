#include "geometry/ray_cone.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "base/stop.h"
#include "geometry/convex_hull.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::MatrixNear;
using testing::Random;

double Margin(const std::vector<Eigen::Vector3d>& rays, const Eigen::Vector3d& axis) {
  double margin = 1.0;
  for (const Eigen::Vector3d& ray : rays) margin = std::min(margin, axis.dot(ray.normalized()));
  return margin;
}

// The best margin over directions spread evenly on the sphere, improved by random steps.
double BestMargin(Random& random, const std::vector<Eigen::Vector3d>& rays) {
  double best = -1.0;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  constexpr int kDirections = 1000;
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / kDirections;
    const double angle = i * M_PI * (3.0 - std::sqrt(5.0));
    const double radius = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d candidate(radius * std::cos(angle), radius * std::sin(angle), z);
    if (const double margin = Margin(rays, candidate); margin > best) {
      best = margin;
      axis = candidate;
    }
  }
  for (double step = 0.1; step > 1e-6; step *= 0.97) {
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector3d candidate = (axis + step * random.UnitVector()).normalized();
      if (const double margin = Margin(rays, candidate); margin > best) {
        best = margin;
        axis = candidate;
      }
    }
  }
  return best;
}

// Rays within `half_angle` of a random direction, with lengths over many scales.
std::vector<Eigen::Vector3d> RaysInCone(Random& random, double half_angle, int count) {
  const Eigen::Matrix3d turn = random.Rotation();
  std::vector<Eigen::Vector3d> rays;
  for (int i = 0; i < count; ++i) {
    const double angle = half_angle * std::sqrt(random.Uniform(0.0, 1.0));
    const double around = random.Uniform(0.0, 2.0 * M_PI);
    rays.push_back(random.LogUniform(1e-4, 1e4) * turn *
                   Eigen::Vector3d(std::sin(angle) * std::cos(around),
                                   std::sin(angle) * std::sin(around),
                                   std::cos(angle)));
  }
  return rays;
}

TEST(FeasibleAxis, AgreesWithBruteForceOnWhetherThereIsOne) {
  Random random(81);
  int num_feasible = 0;
  for (int i = 0; i < 150; ++i) {
    const std::vector<Eigen::Vector3d> rays =
        RaysInCone(random, random.Uniform(0.1, 2.5), random.Int(1, 40));
    const double best = BestMargin(random, rays);
    const std::optional<Eigen::Vector3d> axis = FeasibleAxis(rays);
    if (best > 2.0 * kMinConeMargin) {
      ASSERT_TRUE(axis.has_value()) << i << ": best margin " << best;
      EXPECT_NEAR(axis->norm(), 1.0, 1e-12);
      EXPECT_GT(Margin(rays, *axis), 0.0);
      // Either room to spare, or the axis of the smallest cone.
      EXPECT_GT(Margin(rays, *axis), std::min(0.29, best - 1e-3)) << i;
      ++num_feasible;
    } else if (best < 0.3 * kMinConeMargin) {
      EXPECT_FALSE(axis.has_value()) << i << ": best margin " << best;
    }
  }
  EXPECT_GT(num_feasible, 30);
  EXPECT_LT(num_feasible, 130);
}

TEST(FeasibleAxis, FindsNoneForRaysAllAround) {
  Random random(82);
  for (int i = 0; i < 50; ++i) {
    std::vector<Eigen::Vector3d> rays;
    for (int k = 0; k < 100; ++k) rays.push_back(random.UnitVector());
    EXPECT_FALSE(FeasibleAxis(rays).has_value()) << i;
  }
  const std::vector<Eigen::Vector3d> opposite = {{1, 0, 0}, {-1, 0, 0}};
  EXPECT_FALSE(FeasibleAxis(opposite).has_value());
  const std::vector<Eigen::Vector3d> in_a_plane = {{1, 0, 0}, {-0.5, 0.8, 0}, {-0.5, -0.8, 0}};
  EXPECT_FALSE(FeasibleAxis(in_a_plane).has_value());
}

// A cone of almost half the sphere: found as long as a little more than kMinConeMargin is left.
TEST(FeasibleAxis, FindsNearlyFlatCones) {
  Random random(83);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Matrix3d turn = random.Rotation();
    const double margin = random.LogUniform(1.1 * kMinConeMargin, 0.2);
    std::vector<Eigen::Vector3d> rays;
    for (int k = 0; k < 24; ++k) {
      // Crowded to one side, so that the mean of the rays is a bad axis.
      const double around = 2.0 * M_PI * std::pow(k / 24.0, 3.0);
      const double out = std::sqrt(1.0 - margin * margin);
      rays.push_back(random.LogUniform(0.1, 10.0) * turn *
                     Eigen::Vector3d(out * std::cos(around), out * std::sin(around), margin));
    }
    const std::optional<Eigen::Vector3d> axis = FeasibleAxis(rays);
    ASSERT_TRUE(axis.has_value()) << i << ": margin " << margin;
    EXPECT_GE(Margin(rays, *axis), margin - 1e-6) << i;
  }
}

TEST(FeasibleAxis, RejectsConesFlatterThanTheMargin) {
  std::vector<Eigen::Vector3d> rays;
  for (int k = 0; k < 12; ++k) {
    rays.emplace_back(std::cos(M_PI * k / 6.0), std::sin(M_PI * k / 6.0), 0.4 * kMinConeMargin);
  }
  EXPECT_FALSE(FeasibleAxis(rays).has_value());
}

TEST(FeasibleAxis, DegenerateInputs) {
  EXPECT_FALSE(FeasibleAxis({}).has_value());
  const std::vector<Eigen::Vector3d> one = {{0.0, -3.0, 4.0}};
  EXPECT_THAT(*FeasibleAxis(one), MatrixNear(Eigen::Vector3d(0.0, -0.6, 0.8), 1e-12));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Eigen::Vector3d> bad = {{0.0, nan, 1.0}, {0.0, 0.0, 1.0}};
  EXPECT_FALSE(FeasibleAxis(bad).has_value());
}

TEST(FeasibleAxis, IsTheSameOfRaysThatAreNotKept) {
  Random random(87);
  int num_feasible = 0;
  for (int i = 0; i < 100; ++i) {
    std::vector<Eigen::Vector3d> rays =
        RaysInCone(random, random.Uniform(0.1, 2.5), random.Int(1, 40));
    UnitRaySum sum;
    for (Eigen::Vector3d& ray : rays) sum.Add(ray = ray.normalized().normalized());
    const std::optional<Eigen::Vector3d> expected = FeasibleAxis(rays);
    const std::optional<Eigen::Vector3d> axis =
        FeasibleAxis(sum, [&rays](const Eigen::Vector3d& along) {
          return *std::min_element(rays.begin(), rays.end(), [&along](auto& a, auto& b) {
            return along.dot(a) < along.dot(b);
          });
        });
    ASSERT_EQ(axis.has_value(), expected.has_value()) << i;
    if (!axis.has_value()) continue;
    EXPECT_THAT(*axis, MatrixNear(*expected, 1e-9)) << i;
    ++num_feasible;
  }
  EXPECT_GT(num_feasible, 20);
  EXPECT_LT(num_feasible, 90);
}

TEST(FeasibleAxis, IsNoneOnceItIsToStop) {
  std::stop_source source;
  source.request_stop();
  const std::vector<Eigen::Vector3d> one = {{0.0, 0.0, 1.0}};
  EXPECT_TRUE(FeasibleAxis(one).has_value());
  const StopScope stop_scope(source.get_token());
  EXPECT_FALSE(FeasibleAxis(one).has_value());
}

TEST(NormalizeRays, FillsTheSquareOfSideTwoAroundTheHullsCentroid) {
  Random random(84);
  for (int i = 0; i < 200; ++i) {
    Polygon hull = testing::RandomPolygon(random, random.Int(3, 30), 100.0);
    const Eigen::Vector2d shift = random.LogUniform(1e-3, 10.0) * random.InCube(1.0).head<2>();
    const double scale = random.LogUniform(1e-6, 10.0);
    for (Eigen::Vector2d& vertex : hull) vertex = scale * (vertex + shift);
    const Polygon before = hull;
    const Eigen::Matrix3d frame = random.Rotation();
    const std::optional<Eigen::Matrix3d> normalized = NormalizeRays(frame, &hull);
    ASSERT_TRUE(normalized.has_value());
    EXPECT_GT(normalized->determinant(), 0.0);
    EXPECT_THAT(Centroid(hull), MatrixNear(Eigen::Vector2d(0.0, 0.0), 1e-9));
    const double rounding = 1e-14 * normalized->norm();
    double x_min = 9, x_max = -9, y_min = 9, y_max = -9;
    for (size_t k = 0; k < hull.size(); ++k) {
      x_min = std::min(x_min, hull[k].x());
      x_max = std::max(x_max, hull[k].x());
      y_min = std::min(y_min, hull[k].y());
      y_max = std::max(y_max, hull[k].y());
      // The hull moved as the matrix moves rays.
      const Eigen::Vector3d ray = frame.transpose() * before[k].homogeneous();
      EXPECT_THAT(Eigen::Vector3d(*normalized * ray),
                  MatrixNear(Eigen::Vector3d(hull[k].homogeneous()), rounding));
    }
    EXPECT_NEAR(x_max - x_min, 2.0, 1e-9);
    EXPECT_NEAR(y_max - y_min, 2.0, 1e-9);
    EXPECT_GT(Area(hull), 0.0);  // still counter-clockwise
  }
}

// Corners of neighbouring pixels are the same point, computed twice. Found as a map that missed
// most of its cell: the edge between the two vertices pointed against the sense of the hull.
TEST(NormalizeRays, DropsVerticesThatOnlyRoundingKeepsApart) {
  Polygon hull = {{1.0264278658751245, 0.32344473053411038},
                  {0.32021379554430679, 0.93438854973687269},
                  {-0.39910574559104683, 1.0430837771361841},
                  {-0.96301912254423061, 0.76857146650844377},
                  {-0.91976379143025466, -0.10997147172416999},
                  {-0.69832940490024598, -0.95691584011918862},
                  {0.15291491880707414, -0.95691622286381561},
                  {0.88317532752209527, -0.87007327429829484},
                  {0.88317532752209527, -0.87007327429829473},
                  {1.0369808774557694, 0.12809822007995164}};
  hull.push_back(hull.front() + Eigen::Vector2d(1e-16, 2e-16));
  const size_t num_vertices = hull.size();
  ASSERT_TRUE(NormalizeRays(Eigen::Matrix3d::Identity(), &hull).has_value());
  EXPECT_EQ(hull.size(), num_vertices - 2);
  for (size_t i = 0; i < hull.size(); ++i) {
    EXPECT_GT((hull[(i + 1) % hull.size()] - hull[i]).norm(), 1e-3) << i;
  }
}

TEST(NormalizeRays, RefusesHullsWithoutArea) {
  for (Polygon hull :
       {Polygon{}, Polygon{{1, 2}}, Polygon{{0, 0}, {1, 1}}, Polygon{{0, 0}, {1, 0}, {2, 1e-11}}}) {
    EXPECT_FALSE(NormalizeRays(Eigen::Matrix3d::Identity(), &hull).has_value()) << hull.size();
  }
}

// math.md 1: w >= min_w on every ray exactly inside the polar polygon.
TEST(PolarPolygon, VerticesHaveLeastWOnTwoRaysAndMoreOnTheOthers) {
  Random random(85);
  for (int i = 0; i < 200; ++i) {
    Polygon hull = testing::RandomPolygon(random, random.Int(3, 30), 10.0);
    ASSERT_TRUE(NormalizeRays(Eigen::Matrix3d::Identity(), &hull).has_value());
    const double min_w = random.LogUniform(1e-6, 0.9);
    const Polygon polar = PolarPolygon(hull, min_w);
    ASSERT_EQ(polar.size(), hull.size());
    for (const Eigen::Vector2d& axis : polar) {
      EXPECT_TRUE(axis.allFinite());
      int num_least = 0;
      for (const Eigen::Vector2d& ray : hull) {
        const double w = axis.dot(ray) + 1.0;
        EXPECT_GE(w, min_w - 1e-8);
        num_least += static_cast<int>(std::abs(w - min_w) < 1e-8);
      }
      EXPECT_GE(num_least, 2);
    }
  }
}

TEST(PolarPolygon, ContainsExactlyTheUsableAxes) {
  Random random(86);
  for (int i = 0; i < 100; ++i) {
    Polygon hull = testing::RandomPolygon(random, random.Int(3, 20), 5.0);
    ASSERT_TRUE(NormalizeRays(Eigen::Matrix3d::Identity(), &hull).has_value());
    const Polygon polar = PolarPolygon(hull, 0.01);
    EXPECT_GT(Area(polar), 0.0);
    for (int k = 0; k < 50; ++k) {
      const double share = random.Uniform(0.0, 1.5);
      if (std::abs(share - 1.0) < 1e-6) continue;
      const Eigen::Vector2d axis = testing::PointInPolygon(random, polar, share);
      double w_min = 1.0;
      for (const Eigen::Vector2d& ray : hull) w_min = std::min(w_min, axis.dot(ray) + 1.0);
      EXPECT_EQ(w_min >= 0.01, share < 1.0) << share;
    }
  }
}

}  // namespace
}  // namespace lightfit
