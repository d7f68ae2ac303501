#include "render/generator/scene_generator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "render/generator/shapes.h"
#include "tests/render/testing.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using testing::HashOf;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

SceneGeneratorOptions Options(uint64_t seed, int num_objects, int64_t num_triangles) {
  SceneGeneratorOptions options;
  options.seed = seed;
  options.num_objects = num_objects;
  options.num_triangles = num_triangles;
  return options;
}

TEST(GenerateScene, HasAsManyTrianglesAsAsked) {
  for (const auto& [objects, triangles] : {std::pair<int, int64_t>{1, 100},
                                           {1, 5000},
                                           {3, 300},
                                           {40, 4000},
                                           {40, 50001},
                                           {200, 40000}}) {
    for (const uint64_t seed : {1, 2, 3}) {
      auto scene = GenerateScene(Options(seed, objects, triangles));
      ASSERT_THAT(scene, IsOk());
      const auto count = static_cast<double>(scene->triangles.size());
      // A ring of a shape has some dozen triangles, so small numbers cannot be met exactly.
      EXPECT_NEAR(count, triangles, std::max(0.01 * triangles, 12.0)) << objects << " objects";
      EXPECT_EQ(DropBadTriangles(&*scene), 0);
    }
  }
}

TEST(GenerateScene, HasElevenHundredThousandTrianglesByDefault) {
  const auto scene = GenerateScene({});
  ASSERT_THAT(scene, IsOk());
  EXPECT_NEAR(static_cast<double>(scene->triangles.size()), 1.1e6, 1e4);
  EXPECT_EQ(HashOf(*scene), HashOf(*GenerateScene({})));
}

TEST(GenerateScene, StandsOnTheFloor) {
  for (const double floor : {20.0, 3.0}) {
    SceneGeneratorOptions options = Options(4, 60, 20000);
    options.floor_half_size = floor;
    const auto scene = GenerateScene(options);
    ASSERT_THAT(scene, IsOk());
    const Eigen::AlignedBox3d bounds = BoundsOf(*scene);
    EXPECT_NEAR(bounds.min().x(), -floor, 0.15 * floor);
    EXPECT_NEAR(bounds.max().z(), floor, 0.15 * floor);
    EXPECT_GE(bounds.min().y(), -0.002 * floor);
    EXPECT_GT(bounds.max().y(), 0.1 * floor);
    EXPECT_LT(bounds.max().y(), 0.5 * floor);
  }
}

TEST(GenerateScene, IsTheSameForASeedAndAnotherForAnother) {
  std::set<uint64_t> hashes;
  for (const uint64_t seed : {0, 1, 2, 3, 4}) {
    const auto scene = GenerateScene(Options(seed, 20, 5000));
    ASSERT_THAT(scene, IsOk());
    const auto again = GenerateScene(Options(seed, 20, 5000));
    EXPECT_EQ(HashOf(*scene), HashOf(*again));
    hashes.insert(HashOf(*scene));
  }
  EXPECT_EQ(hashes.size(), 5u);
}

TEST(GenerateScene, IsTheSameOnEveryMachine) {
  // Written down once. It changes only when the generator is meant to.
  const auto scene = GenerateScene(Options(1, 20, 5000));
  ASSERT_THAT(scene, IsOk());
  EXPECT_EQ(HashOf(*scene), 616307982611366383ULL);
}

TEST(GenerateScene, TheViewerStandsFreeAndSeesManyObjects) {
  for (const uint64_t seed : {1, 2, 3}) {
    auto scene = GenerateScene(Options(seed, 40, 20000));
    ASSERT_THAT(scene, IsOk());
    for (const Eigen::Vector3i& triangle : scene->triangles) {
      for (const int i : triangle) {
        const Eigen::Vector3f& v = scene->vertices[i];
        EXPECT_FALSE(std::abs(v.x()) < 1.5F && v.z() > 15.5F && v.z() < 20.0F) << v.transpose();
      }
    }
    // Objects follow one another in the list of triangles.
    const RayCaster caster = testing::Caster(*std::move(scene));
    const auto image = RenderSurfaces(
        caster, *LookAtCamera({0, 1.7, 18}, {0, 0.5, 0}, Eigen::Vector3d::UnitY(), 1.05, 96, 96));
    ASSERT_THAT(image, IsOk());
    std::set<int> objects;
    for (const SurfacePoint& pixel : image->pixels) {
      if (pixel.triangle >= 2) objects.insert(pixel.triangle * 40 / 20000);
    }
    EXPECT_GE(objects.size(), 15u);
    EXPECT_GT(image->num_surface, 96 * 96 / 2);
  }
}

TEST(GenerateScene, RefusesAbsurdSizes) {
  constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
  EXPECT_THAT(GenerateScene(Options(1, 0, 1000)), StatusIs(kInvalid, HasSubstr("num_objects = 0")));
  EXPECT_THAT(GenerateScene(Options(1, 40, 3999)),
              StatusIs(kInvalid, HasSubstr("num_triangles = 3999, want 4000")));
  EXPECT_THAT(GenerateScene(Options(1, 40, int64_t{1} << 40)),
              StatusIs(kInvalid, HasSubstr("want")));
  SceneGeneratorOptions options;
  for (const double floor : {0.0, -1.0, 1e9, std::nan("")}) {
    options.floor_half_size = floor;
    EXPECT_THAT(GenerateScene(options), StatusIs(kInvalid, HasSubstr("floor_half_size")));
  }
}

TEST(SinTurns, IsTheSine) {
  testing::Random random(71);
  for (int i = 0; i < 1000; ++i) {
    const double turns = random.Uniform(-3.0, 3.0);
    EXPECT_NEAR(SinTurns(turns), std::sin(2.0 * M_PI * turns), 1e-13);
    EXPECT_NEAR(CosTurns(turns), std::cos(2.0 * M_PI * turns), 1e-13);
  }
}

// Every edge belongs to two triangles, and they go along it in opposite directions.
void ExpectClosed(const Scene& scene) {
  std::set<std::pair<int, int>> edges;
  for (const Eigen::Vector3i& t : scene.triangles) {
    for (int i = 0; i < 3; ++i) {
      EXPECT_TRUE(edges.insert({t[i], t[(i + 1) % 3]}).second);
    }
  }
  for (const auto& [from, to] : edges) EXPECT_EQ(edges.count({to, from}), 1u);
}

TEST(Shapes, AreClosedAndOfTheirSize) {
  using Outline = Solid::Outline;
  using Profile = Solid::Profile;
  for (const Outline outline :
       {Outline::kCircle, Outline::kSquare, Outline::kHexagon, Outline::kStar}) {
    for (const Profile profile :
         {Profile::kBall, Profile::kCylinder, Profile::kCone, Profile::kCapsule, Profile::kVase}) {
      Solid solid;
      solid.outline = outline;
      solid.profile = profile;
      solid.height = 3.0;
      Scene scene;
      AppendSolid(solid, 1000, &scene);
      ExpectClosed(scene);
      EXPECT_NEAR(static_cast<double>(scene.triangles.size()), 1000.0, 20.0);
      const Eigen::AlignedBox3d bounds = BoundsOf(scene);
      EXPECT_NEAR(bounds.min().y(), 0.0, 1e-6);
      EXPECT_NEAR(bounds.max().y(), 3.0, 1e-6);
      EXPECT_LE(bounds.max().x(), 1.0 + 1e-6);
      if (profile == Profile::kCylinder) {
        EXPECT_NEAR(bounds.max().x(), 1.0, 1e-6);
      }
    }
  }
  for (const auto& [around, through] : {std::pair{1, 0}, {2, 3}, {3, 2}, {2, 5}}) {
    Scene scene;
    AppendTube({around, through, 0.4, 0.1}, 1000, &scene);
    ExpectClosed(scene);
    EXPECT_NEAR(static_cast<double>(scene.triangles.size()), 1000.0, 20.0);
    EXPECT_NEAR(BoundsOf(scene).max().y(), through == 0 ? 0.1 : 0.5, 0.01);
  }
}

}  // namespace
}  // namespace lightfit
