#include "render/shipped/paraboloid_raster.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "partition/shipped/paraboloid_edges.h"
#include "tests/render/shipped/tessellated.h"
#include "tests/render/testing.h"

namespace lightfit {
namespace {

using testing::Random;

ParaboloidPair PairAt(const Eigen::Vector3d& centre, const Eigen::Vector3d& normal, int size) {
  ParaboloidPair pair;
  pair.centre = centre;
  pair.normal = normal.normalized();
  pair.size = size;
  return pair;
}

std::vector<uint8_t> All(const ParaboloidPair& pair) {
  return std::vector<uint8_t>(GridOf(pair).num_texels(), 1);
}

// Half a texel at most, as a phase moves maps.
Eigen::Vector2d RandomMove(Random& random) {
  const double u = random.Uniform(-0.5, 0.5);
  return {u, random.Uniform(-0.5, 0.5)};
}

// Of a texel's centre in the disc of radius 1.
Eigen::Vector2d DiscOf(const ParaboloidPair& pair,
                       const TexelGrid::Texel& texel,
                       const Eigen::Vector2d& move) {
  const Eigen::Vector2d place = TexelGrid::CentreOf(texel) - move;
  return 2.0 / pair.size * place - Eigen::Vector2d::Ones();
}

Ray RayOf(const ParaboloidPair& pair, const TexelGrid::Texel& texel, const Eigen::Vector2d& move) {
  const TexelRay ray = pair.RayAt({texel.map, TexelGrid::CentreOf(texel) - move});
  return {ray.origin, ray.direction.normalized()};
}

double Area(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

// A triangle's image in a half by another way: corners by the tangent of half the angle from the
// axis, and everything at a place of the plane by areas.
struct BentTriangle {
  std::array<Eigen::Vector2d, 3> at;  // texels, moved
  Eigen::Vector3d distance, d_z;

  BentTriangle(const std::array<Eigen::Vector3d, 3>& corners,
               const ParaboloidPair& pair,
               int half,
               const Eigen::Vector2d& move) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d d = pair.HalfFromWorld(half) * (corners[k] - pair.centre);
      const double angle = std::atan2(d.head<2>().norm(), d.z());
      const Eigen::Vector2d uv = std::tan(0.5 * angle) * d.head<2>().normalized();
      at[k] = 0.5 * pair.size * (uv + Eigen::Vector2d::Ones()) + move;
      distance(k) = d.norm();
      d_z(k) = std::cos(angle);
    }
  }

  // Weights of the corners, of sum 1.
  Eigen::Vector3d WeightsAt(const Eigen::Vector2d& p) const {
    const Eigen::Vector3d areas(
        Area(at[1], at[2], p), Area(at[2], at[0], p), Area(at[0], at[1], p));
    return areas / areas.sum();
  }

  // How many texels a weight needs to fall from 1 to 0, at least.
  double LeastHeight() const {
    const double area = std::abs(Area(at[0], at[1], at[2]));
    return area /
           std::max({(at[0] - at[1]).norm(), (at[1] - at[2]).norm(), (at[2] - at[0]).norm()});
  }
};

TEST(ParaboloidRaster, IsBruteForceOverTheBentTriangles) {
  // Texels: the rounding of corners moves edges by less.
  constexpr double kRounding = 0.01;
  int num_drawn = 0, num_cut_away = 0, num_skipped = 0, num_across = 0;
  for (uint64_t seed = 1001; seed <= 1030; ++seed) {
    Random random(seed);
    const ParaboloidPair pair = PairAt(random.InCube(2.0), random.UnitVector(), random.Int(40, 90));
    const Eigen::Vector2d move = RandomMove(random);
    Scene scene;
    // Near one another, so that few lie straight behind.
    const double extent = random.LogUniform(0.3, 3.0);
    const Eigen::Vector3d middle = pair.centre + 2.0 * random.UnitVector();
    testing::AddTriangle(middle + random.InCube(extent),
                         middle + random.InCube(extent),
                         middle + random.InCube(extent),
                         &scene);
    const ParaboloidRaster raster(scene, pair, move, All(pair), 1);
    std::array<Eigen::Vector3d, 3> corners;
    for (int k = 0; k < 3; ++k) corners[k] = scene.vertices[k].cast<double>();
    const double limit = -4.0 * 2.0 / pair.size;
    for (int32_t number = 0; number < GridOf(pair).num_texels(); ++number) {
      const TexelGrid::Texel texel = GridOf(pair).TexelOf(number);
      ASSERT_EQ(GridOf(pair).NumberOf(texel), number);
      const BentTriangle bent(corners, pair, texel.map, move);
      // Corners far behind are cut at a box around the disc as well, which changes nothing in it.
      const double height = bent.LeastHeight();
      if (height < 1.0) continue;
      const Eigen::Vector3d weights = bent.WeightsAt(TexelGrid::CentreOf(texel));
      const double d_z = weights.dot(bent.d_z);
      // How much of d_z a texel is, at most.
      const double d_z_slope = (bent.d_z.maxCoeff() - bent.d_z.minCoeff()) / height;
      const bool is_near_an_edge = std::abs(weights.minCoeff()) * height < kRounding ||
                                   std::abs(d_z - limit) < kRounding * d_z_slope;
      if (is_near_an_edge) {
        ++num_skipped;
        continue;
      }
      const bool is_inside = weights.minCoeff() > 0.0;
      const bool is_drawn = is_inside && d_z > limit;
      num_cut_away += is_inside && !is_drawn ? 1 : 0;
      const absl::Span<const double> distances = raster.DistancesOf(number);
      ASSERT_EQ(distances.size(), is_drawn ? 1u : 0u)
          << "half " << texel.map << " column " << texel.column << " row " << texel.row;
      if (!is_drawn) continue;
      ++num_drawn;
      num_across += bent.d_z.minCoeff() < limit ? 1 : 0;
      const double slope = (bent.distance.maxCoeff() - bent.distance.minCoeff()) / height;
      EXPECT_NEAR(distances[0], weights.dot(bent.distance), kRounding * slope + 1e-9);
      EXPECT_EQ(raster.First(number), distances[0]);
    }
  }
  std::printf(
      "%d texels drawn, %d of them by triangles across the plane, %d cut away, %d skipped\n",
      num_drawn,
      num_across,
      num_cut_away,
      num_skipped);
  EXPECT_GT(num_drawn, 3000);
  EXPECT_GT(num_across, 300);
  EXPECT_GT(num_cut_away, 300);
  EXPECT_LT(num_skipped, num_drawn);
}

// Twelve triangles around the light, each edge in so many parts.
Scene BoxAround(const Eigen::Vector3d& centre, Random& random, int parts) {
  Scene box, fine;
  testing::AddBox({centre + random.InCube(0.3), {1.0, 1.2, 0.8}, random.Uniform(0.0, 3.0)}, &box);
  for (const Eigen::Vector3i& triangle : box.triangles) {
    testing::AddParts({box.vertices[triangle[0]].cast<double>(),
                       box.vertices[triangle[1]].cast<double>(),
                       box.vertices[triangle[2]].cast<double>()},
                      parts,
                      &fine);
  }
  return fine;
}

TEST(ParaboloidRaster, AFineBoxAroundTheLightIsDrawnOnceOnEveryTexelOfBothDiscs) {
  for (uint64_t seed = 1041; seed <= 1046; ++seed) {
    Random random(seed);
    const ParaboloidPair pair = PairAt(random.InCube(2.0), random.UnitVector(), 100);
    const Eigen::Vector2d move = RandomMove(random);
    const Scene box = BoxAround(pair.centre, random, 16);
    const ParaboloidRaster raster(box, pair, move, All(pair), 2);
    int num_texels = 0;
    for (int32_t number = 0; number < GridOf(pair).num_texels(); ++number) {
      const Eigen::Vector2d disc = DiscOf(pair, GridOf(pair).TexelOf(number), move);
      // A receiver asks texels that the disc cuts, whose centres are at most a texel off it.
      if (disc.norm() > 1.0 + 2.0 / pair.size) continue;
      ++num_texels;
      ASSERT_EQ(raster.DistancesOf(number).size(), 1u) << disc.transpose();
    }
    EXPECT_GT(num_texels, 15000);
  }
}

// The segment of a circle between an edge's chord and its arc. Directions of its ends in the half.
struct ChordAndArc {
  Eigen::Vector2d begin, end, along, across;
  Eigen::Vector2d centre;  // of the circle
  double radius;           // likewise
  double height;           // of the arc over the chord: P7
  double side;             // of the chord on which the arc lies

  ChordAndArc(const Eigen::Vector3d& from, const Eigen::Vector3d& to)
      : begin(ParaboloidFromDirection(from.normalized())),
        end(ParaboloidFromDirection(to.normalized())),
        along((end - begin).normalized()),
        across(-along.y(), along.x()),
        height(ChordError(from.normalized(), to.normalized())) {
    const Eigen::Vector3d plane = from.cross(to).normalized();
    centre = plane.head<2>() / plane.z();
    radius = 1.0 / std::abs(plane.z());
    const Eigen::Vector3d middle = (from.normalized() + to.normalized()).normalized();
    side = across.dot(ParaboloidFromDirection(middle) - begin) > 0.0 ? 1.0 : -1.0;
  }

  // Up to a slack.
  bool Holds(const Eigen::Vector2d& place, double slack) const {
    const double reach = along.dot(place - begin), off = side * across.dot(place - begin);
    if (reach < -slack || reach > (end - begin).norm() + slack) return false;
    if (off < -slack || off > height + slack) return false;
    return (place - centre).norm() <= radius + slack;
  }

  // To the third order of height over chord.
  double Area() const {
    const double chord = (end - begin).norm();
    return 2.0 / 3.0 * chord * height + 0.5 * std::pow(height, 3) / chord;
  }
};

TEST(ParaboloidRaster, ACoarseCasterDiffersFromTheCastOneBetweenChordsAndArcsOnly) {
  double foretold = 0.0;
  int num_different = 0, num_same = 0;
  for (uint64_t seed = 1061; seed <= 1090; ++seed) {
    Random random(seed);
    const ParaboloidPair pair = PairAt(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ(), 128);
    // In one half, seen at a wide angle.
    Scene scene;
    std::array<Eigen::Vector3d, 3> corners;
    for (Eigen::Vector3d& corner : corners) {
      corner = random.InCube(2.0);
      corner.z() = random.Uniform(0.4, 1.5);
    }
    testing::AddTriangle(corners[0], corners[1], corners[2], &scene);
    for (int k = 0; k < 3; ++k) corners[k] = scene.vertices[k].cast<double>();
    const Eigen::Matrix3d half_from_world = pair.HalfFromWorld(0);
    for (Eigen::Vector3d& corner : corners) corner = half_from_world * corner;
    const ParaboloidRaster raster(scene, pair, Eigen::Vector2d::Zero(), All(pair), 1);
    // 1/256 of a texel in both directions, and single precision.
    const double slack = 2.0 / pair.size * 0.01;
    std::vector<ChordAndArc> edges;
    for (int k = 0; k < 3; ++k) {
      edges.emplace_back(corners[k], corners[(k + 1) % 3]);
      foretold += edges.back().Area() * pair.size * pair.size / 4.0;
    }
    for (int32_t number = 0; number < GridOf(pair).num_texels() / 2; ++number) {
      const TexelGrid::Texel texel = GridOf(pair).TexelOf(number);
      const Ray ray = RayOf(pair, texel, Eigen::Vector2d::Zero());
      const testing::BruteHits hits = testing::AllHits(scene, ray);
      const bool is_drawn = !raster.DistancesOf(number).empty();
      if (hits.distances.empty() == !is_drawn) {
        num_same += is_drawn ? 1 : 0;
        continue;
      }
      ++num_different;
      const Eigen::Vector2d disc = DiscOf(pair, texel, Eigen::Vector2d::Zero());
      const bool is_between = std::any_of(
          edges.begin(), edges.end(), [&](const auto& edge) { return edge.Holds(disc, slack); });
      EXPECT_TRUE(is_between) << disc.transpose();
    }
  }
  std::printf(
      "%d texels differ, %.0f foretold; %d are the same\n", num_different, foretold, num_same);
  // The union of the segments is somewhat smaller than their sum.
  EXPECT_LT(num_different, 1.1 * foretold);
  EXPECT_GT(num_different, 0.5 * foretold);
}

// Whether some texel around this one has such a distance, on the ray that is cast.
bool IsAround(const std::vector<double>& cast,
              const TexelGrid& grid,
              const TexelGrid::Texel& texel,
              double distance) {
  constexpr double kTolerance = 0.01;
  double least = 1e300, most = 0.0;
  for (int row = std::max(texel.row - 1, -1); row <= std::min(texel.row + 1, grid.side); ++row) {
    for (int column = std::max(texel.column - 1, -1);
         column <= std::min(texel.column + 1, grid.side);
         ++column) {
      const double there = cast[grid.NumberOf({texel.map, column, row})];
      least = std::min(least, there);
      most = std::max(most, there);
    }
  }
  return distance >= (1.0 - kTolerance) * least && distance <= (1.0 + kTolerance) * most;
}

TEST(ParaboloidRaster, FineCastersAreDrawnAsTheyAreCast) {
  int num_same = 0, num_different = 0, num_far = 0;
  for (uint64_t seed = 1101; seed <= 1104; ++seed) {
    Random random(seed);
    const Eigen::Vector3d lamp(random.Uniform(-5, 5), random.Uniform(-5, 5), random.Uniform(1, 5));
    const ParaboloidPair pair = PairAt(lamp, random.UnitVector(), 128);
    const Eigen::Vector2d move = RandomMove(random);
    const RayCaster caster = testing::Caster(
        testing::Tessellated(testing::SceneOf(MakeBoxScene(seed)), lamp, pair.size, 0.125));
    const ParaboloidRaster raster(caster.scene(), pair, move, All(pair), 2);
    const TexelGrid grid = GridOf(pair);
    std::vector<double> cast(grid.num_texels());
    for (int32_t number = 0; number < grid.num_texels(); ++number) {
      cast[number] = caster.FirstHit(RayOf(pair, grid.TexelOf(number), move)).distance;
    }
    for (int32_t number = 0; number < grid.num_texels(); ++number) {
      const TexelGrid::Texel texel = grid.TexelOf(number);
      if (DiscOf(pair, texel, move).norm() > 1.0) continue;
      const double drawn = raster.First(number);
      if (drawn == cast[number] || std::abs(drawn - cast[number]) < 0.01 * cast[number]) {
        ++num_same;
        continue;
      }
      ++num_different;
      num_far += IsAround(cast, grid, texel, drawn) ? 0 : 1;
    }
  }
  std::printf("%d texels the same, %d not, %d of them unlike the texels around\n",
              num_same,
              num_different,
              num_far);
  EXPECT_LT(num_different, 0.01 * num_same);
  EXPECT_LT(num_far, 0.001 * num_same);
}

TEST(ParaboloidRaster, DrawsWantedTexelsOnlyAndDoesNotDependOnThreads) {
  Random random(1111);
  const ParaboloidPair pair = PairAt({0.0, 0.0, 2.0}, random.UnitVector(), 64);
  const Scene scene = testing::RandomTriangles(random, 20000, 10.0);
  const Eigen::Vector2d move = RandomMove(random);
  const ParaboloidRaster all(scene, pair, move, All(pair), 1);
  std::vector<uint8_t> wanted = All(pair);
  for (uint8_t& flag : wanted) flag = random.Coin() ? 1 : 0;
  const ParaboloidRaster some(scene, pair, move, wanted, 3);
  int num_behind = 0;
  for (int32_t number = 0; number < GridOf(pair).num_texels(); ++number) {
    const absl::Span<const double> distances = some.DistancesOf(number);
    if (wanted[number] == 0) {
      EXPECT_TRUE(distances.empty());
      EXPECT_TRUE(std::isinf(some.First(number)));
      EXPECT_FALSE(some.HasBehind(number, 0.0, 1e300));
      continue;
    }
    EXPECT_EQ(distances, all.DistancesOf(number));
    EXPECT_TRUE(std::is_sorted(distances.begin(), distances.end()));
    if (distances.size() < 3) continue;
    ++num_behind;
    // The middle of the gap behind the second.
    const double between = 0.5 * (distances[1] + distances[2]);
    const double resolution = between - distances[0];
    EXPECT_TRUE(some.HasBehind(number, 0.0, between));
    EXPECT_FALSE(some.HasBehind(number, resolution, between));
    EXPECT_TRUE(some.HasBehind(number, resolution, 2.0 * distances[2]));
    EXPECT_FALSE(some.HasBehind(number, resolution, 0.5 * (between + distances[2])));
  }
  EXPECT_GT(num_behind, 100);
}

TEST(ParaboloidRaster, CornersAtTheLightOrStraightBehindAreLeftOut) {
  const ParaboloidPair pair = PairAt({1.0, 2.0, 3.0}, Eigen::Vector3d::UnitZ(), 32);
  const Eigen::Vector3d front(1.5, 2.0, 4.0), side(2.0, 2.5, 3.1);
  for (const Eigen::Vector3d& corner :
       {Eigen::Vector3d(1.0, 2.0, 3.0), Eigen::Vector3d(1.0, 2.0, 1.0)}) {
    Scene scene;
    testing::AddTriangle(front, side, corner, &scene);
    const ParaboloidRaster raster(scene, pair, Eigen::Vector2d::Zero(), All(pair), 1);
    for (int32_t number = 0; number < GridOf(pair).num_texels() / 2; ++number) {
      EXPECT_TRUE(raster.DistancesOf(number).empty());
    }
  }
  // Almost straight behind: far off in the plane, and finite.
  Scene scene;
  testing::AddTriangle(front, side, {1.0 + 1e-6, 2.0, 1.0}, &scene);
  const ParaboloidRaster raster(scene, pair, Eigen::Vector2d::Zero(), All(pair), 1);
  int num_drawn = 0;
  for (int32_t number = 0; number < GridOf(pair).num_texels(); ++number) {
    for (const double distance : raster.DistancesOf(number)) {
      EXPECT_TRUE(std::isfinite(distance));
      ++num_drawn;
    }
  }
  EXPECT_GT(num_drawn, 0);
}

}  // namespace
}  // namespace lightfit
