#include "render/generator/room.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "render/clearance.h"
#include "render/generator/room_parts.h"
#include "render/generator/scene_generator.h"
#include "tests/render/testing.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using testing::HashOf;
using testing::IsOk;
using testing::StatusIs;

constexpr uint64_t kSeeds[] = {1, 2, 3, 4, 5, 6, 7, 8};
constexpr int64_t kTriangles = 30'000;

// Whether the ray passes through the whole depth of the box: into it and out of it again.
bool PassesThrough(const Ray& ray, const Eigen::AlignedBox3d& box) {
  double near = 0.0, far = 1e300;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (box.min()[axis] - ray.origin[axis]) / ray.direction[axis];
    const double b = (box.max()[axis] - ray.origin[axis]) / ray.direction[axis];
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  }
  return near < far;
}

Eigen::Vector3d ToSun(double elevation_deg, double azimuth_deg) {
  const double elevation = elevation_deg * M_PI / 180.0, azimuth = azimuth_deg * M_PI / 180.0;
  return {std::cos(elevation) * std::cos(azimuth),
          std::sin(elevation),
          std::cos(elevation) * std::sin(azimuth)};
}

// The share of places a hand's breadth above the floor that the sun reaches.
double LitShare(const RayCaster& caster, const Room& room, const Eigen::Vector3d& to_sun) {
  constexpr int kSide = 60;
  int num_lit = 0;
  for (int i = 0; i < kSide * kSide; ++i) {
    const int column = i % kSide, row = i / kSide;
    const Eigen::Vector3d share((column + 0.5) / kSide, 0.0, (row + 0.5) / kSide);
    Eigen::Vector3d place = room.inside.min() + share.cwiseProduct(room.inside.sizes());
    place.y() = 0.1;
    if (!caster.IsBlocked({place, to_sun})) ++num_lit;
  }
  return static_cast<double>(num_lit) / (kSide * kSide);
}

TEST(Room, IsTheSameOnEveryMachine) {
  // Written down once. It changes only when the generator is meant to.
  EXPECT_EQ(HashOf(MakeRoom(5, kTriangles).scene), 14396863338568897973ULL);
  std::set<uint64_t> hashes;
  for (const uint64_t seed : kSeeds) {
    const uint64_t hash = HashOf(MakeRoom(seed, kTriangles).scene);
    EXPECT_EQ(hash, HashOf(MakeRoom(seed, kTriangles).scene));
    hashes.insert(hash);
  }
  EXPECT_EQ(hashes.size(), std::size(kSeeds));
}

TEST(Room, HasAsManyGoodTrianglesAsAsked) {
  for (const uint64_t seed : kSeeds) {
    for (const int64_t triangles : {kTriangles, int64_t{150'000}}) {
      Room room = MakeRoom(seed, triangles);
      // Each of some dozen round things may miss its number by a dozen.
      EXPECT_NEAR(room.scene.triangles.size(), triangles, 0.02 * triangles) << "seed " << seed;
      EXPECT_EQ(DropBadTriangles(&room.scene), 0) << "seed " << seed;
    }
  }
}

TEST(Room, IsClosedButForItsWindows) {
  for (const uint64_t seed : kSeeds) {
    SCOPED_TRACE(seed);
    const Room room = MakeRoom(seed, kTriangles);
    ASSERT_GE(room.windows.size(), 2u);
    ASSERT_LE(room.windows.size(), 3u);
    const RayCaster caster = testing::Caster(room.scene);
    testing::Random random(static_cast<int>(seed));
    constexpr int kRays = 20'000;
    int num_out = 0;
    for (int i = 0; i < kRays; ++i) {
      Eigen::Vector3d origin;
      for (int axis = 0; axis < 3; ++axis) {
        origin[axis] =
            room.inside.min()[axis] + random.Uniform(0.01, 0.99) * room.inside.sizes()[axis];
      }
      const Ray ray{origin, random.InCube(1.0).normalized()};
      if (caster.FirstHit(ray).is_surface()) continue;
      ++num_out;
      bool through_window = false;
      for (const Eigen::AlignedBox3d& window : room.windows) {
        through_window = through_window || PassesThrough(ray, window);
      }
      EXPECT_TRUE(through_window) << "from " << origin.transpose() << " along "
                                  << ray.direction.transpose();
    }
    EXPECT_GT(num_out, kRays / 500);
    EXPECT_LT(num_out, kRays / 5);
  }
}

// Light comes in by the windows towards -x, and nothing of a sun on the other side.
TEST(Room, WindowsLetTheSunIn) {
  for (const uint64_t seed : kSeeds) {
    SCOPED_TRACE(seed);
    const Room room = MakeRoom(seed, kTriangles);
    const RayCaster caster = testing::Caster(room.scene);
    for (const double elevation_deg : {15.0, 30.0, 50.0}) {
      for (const double azimuth_deg : {130.0, 180.0, 230.0}) {
        const double share = LitShare(caster, room, ToSun(elevation_deg, azimuth_deg));
        EXPECT_GT(share, 0.002) << elevation_deg << ", " << azimuth_deg;
        EXPECT_LT(share, 0.4) << elevation_deg << ", " << azimuth_deg;
      }
      EXPECT_EQ(LitShare(caster, room, ToSun(elevation_deg, 30.0)), 0.0);
    }
  }
}

TEST(Room, ViewersStandFreeAndSeeManyThings) {
  for (const uint64_t seed : kSeeds) {
    SCOPED_TRACE(seed);
    const RayCaster caster = testing::Caster(MakeRoom(seed, kTriangles).scene);
    for (const Eigen::Vector2d& viewer : kRoomViewers) {
      const Eigen::Vector3d eye(viewer.x(), 1.6, viewer.y());
      EXPECT_GT(Clearance(caster, eye), 0.5);
      const auto camera = LookAtCamera(eye, {0.0, 0.8, 0.0}, Eigen::Vector3d::UnitY(), 1.1, 96, 96);
      const auto image = RenderSurfaces(caster, *camera);
      ASSERT_THAT(image, IsOk());
      std::set<int> triangles;
      for (const SurfacePoint& pixel : image->pixels) triangles.insert(pixel.triangle);
      EXPECT_GT(triangles.size(), 100u);
    }
  }
}

TEST(Room, IsAKindOfGeneratedScene) {
  SceneGeneratorOptions options;
  options.kind = SceneKind::kRoom;
  options.seed = 5;
  options.num_triangles = kTriangles;
  const auto scene = GenerateScene(options);
  ASSERT_THAT(scene, IsOk());
  EXPECT_EQ(HashOf(*scene), HashOf(MakeRoom(5, kTriangles).scene));
  options.num_triangles = 19'999;
  EXPECT_THAT(GenerateScene(options),
              StatusIs(absl::StatusCode::kInvalidArgument,
                       ::testing::HasSubstr("num_triangles = 19999, want 20000")));
}

// Every edge belongs to two triangles, and they go along it in opposite directions; where cells
// meet at a corner alone, to four.
TEST(Slab, IsClosedAndAsLargeAsItsCells) {
  testing::Random random(12);
  for (int i = 0; i < 100; ++i) {
    Slab slab;
    slab.back = random.Uniform(-2.0, 0.0);
    slab.front = slab.back + random.Uniform(0.1, 1.0);
    double x = 0.0, y = 0.0;
    for (int k = 0; k < 4; ++k) slab.columns.push_back(x += random.Uniform(0.1, 1.0));
    for (int k = 0; k < 5; ++k) slab.rows.push_back(y += random.Uniform(0.1, 1.0));
    double area = 0.0;
    for (int cell = 0; cell < 12; ++cell) {
      slab.open.push_back(random.Uniform(0.0, 1.0) < 0.3 ? 1 : 0);
      if (slab.open.back() != 0) continue;
      area += (slab.columns[cell % 3 + 1] - slab.columns[cell % 3]) *
              (slab.rows[cell / 3 + 1] - slab.rows[cell / 3]);
    }
    Scene scene;
    AppendSlab(slab, &scene);
    std::multiset<std::pair<int, int>> edges;
    double volume = 0.0;
    for (const Eigen::Vector3i& t : scene.triangles) {
      for (int k = 0; k < 3; ++k) edges.insert({t[k], t[(k + 1) % 3]});
      const Eigen::Vector3d a = scene.vertices[t[0]].cast<double>();
      volume +=
          a.dot(scene.vertices[t[1]].cast<double>().cross(scene.vertices[t[2]].cast<double>())) /
          6.0;
    }
    for (const auto& [from, to] : edges) {
      EXPECT_EQ(edges.count({from, to}), edges.count({to, from}));
    }
    // Wound counter-clockwise seen from outside.
    EXPECT_NEAR(volume, area * (slab.front - slab.back), 1e-5);
  }
}

}  // namespace
}  // namespace lightfit
