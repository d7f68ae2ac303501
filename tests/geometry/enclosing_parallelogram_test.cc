#include "geometry/enclosing_parallelogram.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"
#include "tests/testing/shapes.h"

namespace lightfit {
namespace {

using testing::Extent;
using testing::Overhang;
using testing::Random;
using testing::RandomPolygon;
using testing::RelativeError;

// Where the optimum must not be above the grid, and contacts must touch: rounding, with metrics of
// condition 1e6.
constexpr double kTolerance = 1e-9;

Eigen::Matrix2d RandomMetric(Random& random, double max_condition) {
  const Eigen::Matrix2d root = random.Matrix2(std::sqrt(max_condition));
  return random.LogUniform(1e-6, 1e6) * root * root.transpose();
}

// The energy over the normals' angles in whitened coordinates, from widths alone:
//   ( W(a)^2 / width^2 + W(b)^2 / height^2 ) / sin^2(a - b).   math.md 5
class AngleEnergy {
 public:
  AngleEnergy(const Polygon& polygon, const Eigen::Matrix2d& metric, double width, double height)
      : width_(width), height_(height) {
    // The symmetric root, unlike the library's triangular one.
    const Eigen::Matrix2d root =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(metric).operatorSqrt();
    for (const Eigen::Vector2d& vertex : polygon) whitened_.push_back(root * vertex);
  }

  double Width(double angle) const { return Extent(whitened_, {std::cos(angle), std::sin(angle)}); }
  double operator()(double a, double b) const { return Combine(Width(a), Width(b), a - b); }
  double Combine(double width_a, double width_b, double between) const {
    const double s = std::sin(between);
    return (std::pow(width_a / width_, 2) + std::pow(width_b / height_, 2)) / (s * s);
  }

 private:
  Polygon whitened_;
  double width_, height_;
};

// A grid over both angles, then a compass search from its best points.
double LeastEnergyOnGrid(const AngleEnergy& energy) {
  constexpr int kSteps = 180;
  std::vector<double> widths;
  for (int i = 0; i < kSteps; ++i) widths.push_back(energy.Width(M_PI * i / kSteps));
  struct Start {
    double energy, a, b;
  };
  std::vector<Start> starts;
  for (int i = 0; i < kSteps; ++i) {
    Start best = {std::numeric_limits<double>::infinity(), 0.0, 0.0};
    for (int k = 0; k < kSteps; ++k) {
      if (k == i) continue;
      const double a = M_PI * i / kSteps, b = M_PI * k / kSteps;
      const double here = energy.Combine(widths[i], widths[k], a - b);
      if (here < best.energy) best = {here, a, b};
    }
    starts.push_back(best);
  }
  std::sort(starts.begin(), starts.end(), [](const Start& x, const Start& y) {
    return x.energy < y.energy;
  });
  starts.resize(4);
  double least = starts.front().energy;
  for (Start& start : starts) {
    for (double step = M_PI / kSteps; step > 1e-9;) {
      const Start before = start;
      for (const auto& [da, db] : {std::pair(step, 0.0),
                                   std::pair(-step, 0.0),
                                   std::pair(0.0, step),
                                   std::pair(0.0, -step),
                                   std::pair(step, step),
                                   std::pair(-step, -step)}) {
        const double here = energy(before.a + da, before.b + db);
        if (here < start.energy) start = {here, before.a + da, before.b + db};
      }
      if (start.energy == before.energy) step *= 0.5;
    }
    least = std::min(least, start.energy);
  }
  return least;
}

void ExpectContactsTouch(const EnclosingParallelogram& result, const Polygon& polygon) {
  Eigen::Matrix2d edges;
  edges << result.shape.edge_u, result.shape.edge_v;
  const Eigen::Matrix2d unit_from_plane = edges.inverse();
  for (int strip = 0; strip < 2; ++strip) {
    const StripContacts& contacts = result.contacts[strip];
    const auto coordinate = [&](int vertex) {
      return (unit_from_plane * (polygon.at(vertex) - result.shape.corner))(strip);
    };
    EXPECT_NEAR(coordinate(contacts.low_vertex), 0.0, kTolerance);
    EXPECT_NEAR(coordinate(contacts.high_vertex), 1.0, kTolerance);
    if (contacts.flush_vertex < 0) continue;
    EXPECT_NEAR(coordinate(contacts.flush_vertex), contacts.flush_on_high ? 1.0 : 0.0, kTolerance);
    EXPECT_NE(contacts.flush_vertex,
              contacts.flush_on_high ? contacts.high_vertex : contacts.low_vertex);
  }
}

void ExpectOptimal(const Polygon& polygon,
                   const Eigen::Matrix2d& metric,
                   double width,
                   double height) {
  const EnclosingParallelogram result = MinEnergyParallelogram(polygon, metric, width, height);
  EXPECT_LE(Overhang(result.shape, polygon), kTolerance);
  EXPECT_LE(RelativeError(result.energy, ParallelogramEnergy(result.shape, metric, width, height)),
            kTolerance);
  ExpectContactsTouch(result, polygon);
  const double grid = LeastEnergyOnGrid(AngleEnergy(polygon, metric, width, height));
  EXPECT_LE(result.energy, grid * (1.0 + kTolerance))
      << polygon.size() << " vertices, metric\n"
      << metric << "\nmap " << width << " x " << height;
}

Polygon RegularPolygon(int n, double turn) {
  Polygon polygon;
  for (int i = 0; i < n; ++i) {
    const double angle = turn + 2.0 * M_PI * i / n;
    polygon.emplace_back(std::cos(angle), std::sin(angle));
  }
  return polygon;
}

TEST(MinEnergyParallelogram, NeverAboveGridOnRandomPolygons) {
  Random random(71);
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE(i);
    ExpectOptimal(RandomPolygon(random, random.Int(3, 40), 10.0),
                  RandomMetric(random, 1e6),
                  random.LogUniform(100.0, 4000.0),
                  random.LogUniform(100.0, 4000.0));
  }
}

TEST(MinEnergyParallelogram, NeverAboveGridOnSlivers) {
  Random random(72);
  for (int i = 0; i < 20; ++i) {
    SCOPED_TRACE(i);
    ExpectOptimal(
        RandomPolygon(random, random.Int(3, 12), 1e4), RandomMetric(random, 1e2), 1024.0, 512.0);
  }
}

TEST(MinEnergyParallelogram, NeverAboveGridOnSquareMaps) {
  Random random(73);
  for (int i = 0; i < 20; ++i) {
    SCOPED_TRACE(i);
    ExpectOptimal(
        RandomPolygon(random, random.Int(3, 40), 10.0), RandomMetric(random, 1e4), 512.0, 512.0);
  }
}

TEST(MinEnergyParallelogram, NeverAboveGridOnRegularPolygons) {
  Random random(74);
  for (const int n : {3, 4, 5, 6, 7, 8, 12, 17, 24}) {
    for (const double turn : {0.0, 0.3}) {
      SCOPED_TRACE(n);
      ExpectOptimal(RegularPolygon(n, turn), Eigen::Matrix2d::Identity(), 1.0, 1.0);
      ExpectOptimal(RegularPolygon(n, turn), RandomMetric(random, 100.0), 2.0, 1.0);
    }
  }
}

TEST(MinEnergyParallelogram, NeverAboveGridWithExactlyParallelEdges) {
  Random random(75);
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    // Small integers, so that the opposite edges are parallel to the last bit.
    const Eigen::Vector2d u(random.Int(1, 9), random.Int(-3, 3)),
        v(random.Int(-3, 0), random.Int(4, 9));
    const Eigen::Vector2d corner(random.Int(-9, 9), random.Int(-9, 9));
    const Polygon parallelogram = {corner, corner + u, corner + u + v, corner + v};
    ExpectOptimal(parallelogram, RandomMetric(random, 1e4), 1024.0, 512.0);
    const Polygon rectangle = {{0, 0}, {u.x(), 0}, {u.x(), v.y()}, {0, v.y()}};
    ExpectOptimal(rectangle, Eigen::Matrix2d::Identity(), 640.0, 480.0);
    const Polygon hexagon = {corner,
                             corner + u,
                             corner + 2 * u + v,
                             corner + 2 * u + 2 * v,
                             corner + u + 2 * v,
                             corner + v};
    if (Cross(u, v) > 0.0) ExpectOptimal(hexagon, RandomMetric(random, 100.0), 300.0, 700.0);
  }
}

// Strips along both of two parallel edges are one and the same: no search may stop between them.
TEST(MinEnergyParallelogram, ParallelEdgesCostNoMoreThanNearlyParallelOnes) {
  Random random(78);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector2d u(random.Int(1, 9), random.Int(-3, 3)),
        v(random.Int(-3, 0), random.Int(4, 9));
    if (Cross(u, v) <= 0.0) continue;
    const Eigen::Vector2d corner(random.Int(-9, 9), random.Int(-9, 9));
    Polygon hexagon = {corner,
                       corner + u,
                       corner + 2 * u + v,
                       corner + 2 * u + 2 * v,
                       corner + u + 2 * v,
                       corner + v};
    const Eigen::Matrix2d metric = RandomMetric(random, 100.0);
    const double energy = MinEnergyParallelogram(hexagon, metric, 300.0, 700.0).energy;
    for (Eigen::Vector2d& vertex : hexagon) vertex += 1e-8 * random.InCube(1.0).head<2>();
    const double perturbed = MinEnergyParallelogram(hexagon, metric, 300.0, 700.0).energy;
    EXPECT_LE(energy, perturbed * (1.0 + 1e-6)) << i;
  }
}

TEST(MinEnergyParallelogram, FitsAnAxisAlignedRectangleToItself) {
  const Polygon rectangle = {{0, 0}, {4, 0}, {4, 2}, {0, 2}};
  const EnclosingParallelogram result =
      MinEnergyParallelogram(rectangle, Eigen::Matrix2d::Identity(), 4.0, 2.0);
  EXPECT_NEAR(result.energy, 2.0, 1e-12);
  EXPECT_NEAR(Area(result.shape), 8.0, 1e-12);
}

// Energy follows the polygon's scale squared and the metric's scale.
TEST(MinEnergyParallelogram, ScalesWithPolygonAndMetric) {
  Random random(76);
  for (int i = 0; i < 100; ++i) {
    Polygon polygon = RandomPolygon(random, random.Int(3, 20), 10.0);
    const Eigen::Matrix2d metric = RandomMetric(random, 100.0);
    const double energy = MinEnergyParallelogram(polygon, metric, 512.0, 256.0).energy;
    const double scale = random.LogUniform(1e-6, 1e6);
    for (Eigen::Vector2d& vertex : polygon) vertex *= scale;
    EXPECT_LE(RelativeError(MinEnergyParallelogram(polygon, metric, 512.0, 256.0).energy,
                            scale * scale * energy),
              1e-10);
    const Eigen::Matrix2d scaled = scale * metric;
    EXPECT_LE(RelativeError(MinEnergyParallelogram(polygon, scaled, 512.0, 256.0).energy,
                            scale * scale * scale * energy),
              1e-10);
  }
}

// Swapping the map's sides swaps the strips and nothing else.
TEST(MinEnergyParallelogram, SwapsStripsWithTheMapsSides) {
  Random random(77);
  for (int i = 0; i < 100; ++i) {
    const Polygon polygon = RandomPolygon(random, random.Int(3, 20), 10.0);
    const Eigen::Matrix2d metric = RandomMetric(random, 100.0);
    EXPECT_LE(RelativeError(MinEnergyParallelogram(polygon, metric, 512.0, 256.0).energy,
                            MinEnergyParallelogram(polygon, metric, 256.0, 512.0).energy),
              1e-12);
  }
}

}  // namespace
}  // namespace lightfit
