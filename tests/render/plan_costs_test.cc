#include "render/plan_costs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "geometry/homography.h"
#include "render/shadow_map.h"
#include "tests/render/plan_stage.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::PlanStage;
using testing::Random;
using testing::RandomLightAbove;
using testing::RandomPlan;
using testing::StatusIs;

PlanCosts Measured(const RayCaster& caster,
                   const SurfaceImage& image,
                   const std::vector<Lighting>& truth,
                   const Light& light,
                   const Plan& plan) {
  const auto costs = MeasurePlanCosts(caster, image, truth, light, plan);
  EXPECT_THAT(costs, IsOk());
  return costs.ok() ? *costs : PlanCosts();
}

PlanCosts Measured(const PlanStage& stage, const Plan& plan) {
  return Measured(stage.caster, stage.image, stage.truth, stage.light, plan);
}

// (u, v, w) of a world point.
Eigen::Vector3d InMap(const PlanMap& map, const Eigen::Vector3d& world) {
  const Eigen::Vector4d at = map.map_from_world * world.homogeneous();
  return {at.x() / at.w(), at.y() / at.w(), at.w()};
}

bool IsInRectangle(const PlanMap& map, const Eigen::Vector3d& world) {
  const Eigen::Vector3d at = InMap(map, world);
  return at.z() > 0.0 && at.x() >= 0.0 && at.y() >= 0.0 && at.x() < map.size.width &&
         at.y() < map.size.height;
}

TEST(MeasurePlanCosts, OverlapIsTheNumberOfMapsThatHoldAJudgedPixel) {
  for (uint64_t seed = 801; seed < 811; ++seed) {
    Random random(seed);
    const PlanStage stage(seed, RandomLightAbove(random));
    const Plan plan = RandomPlan(stage, random, random.Int(1, 7));
    const PlanCosts costs = Measured(stage, plan);
    std::vector<int64_t> held(plan.maps.size(), 0);
    int64_t num_judged = 0, num_held = 0, num_in_any = 0, num_asking = 0;
    for (size_t i = 0; i < stage.truth.size(); ++i) {
      if (stage.truth[i] != Lighting::kLit && stage.truth[i] != Lighting::kShadowed) continue;
      ++num_judged;
      const Eigen::Vector3d& world = stage.image.pixels[i].position;
      bool is_in_any = false;
      for (size_t k = 0; k < plan.maps.size(); ++k) {
        bool holds = IsInRectangle(plan.maps[k], world);
        for (const Eigen::RowVector4d& half_space : plan.maps[k].half_spaces) {
          holds = holds && half_space * world.homogeneous() >= 0.0;
        }
        held[k] += holds;
        num_held += holds;
        is_in_any = is_in_any || holds;
      }
      num_in_any += is_in_any;
    }
    ASSERT_EQ(costs.maps.size(), plan.maps.size());
    EXPECT_EQ(costs.receivers, num_judged);
    for (size_t k = 0; k < held.size(); ++k) {
      EXPECT_EQ(costs.maps[k].receivers, held[k]);
      EXPECT_LE(costs.maps[k].asked, held[k]);
      num_asking += costs.maps[k].asked;
    }
    EXPECT_EQ(num_asking, num_in_any);
    EXPECT_DOUBLE_EQ(costs.overlap, static_cast<double>(num_held) / num_judged);
  }
}

// A map's frustum by its rays: the planes through neighbouring ones of its four corner rays.
class FrustumByRays {
 public:
  FrustumByRays(const PlanMap& map, const Light& light, const Eigen::AlignedBox3d& bounds)
      : map_(map) {
    const MapRays rays(light, *MapFromRay(map.map_from_world, light), bounds);
    const double width = map.size.width, height = map.size.height;
    const Ray middle = *rays.At(0.5 * width, 0.5 * height);
    const std::array<Ray, 4> corners = {
        *rays.At(0.0, 0.0), *rays.At(width, 0.0), *rays.At(width, height), *rays.At(0.0, height)};
    for (int i = 0; i < 4; ++i) {
      const Ray &ray = corners[i], &next = corners[(i + 1) % 4];
      origins_[i] = ray.origin;
      // From the point a step along the one ray to the other's: also right for parallel rays.
      normals_[i] = ray.direction.cross(next.origin + next.direction - ray.origin).normalized();
      const Eigen::Vector3d inside = middle.origin + middle.direction;
      if (normals_[i].dot(inside - origins_[i]) < 0.0) normals_[i] *= -1.0;
    }
  }

  enum class Place { kOut, kIn, kTie };

  // Of a triangle, by planes as in the header.
  Place Of(const std::array<Eigen::Vector3d, 3>& corners) const {
    constexpr double kTie = 1e-9;  // of coordinates of about 10
    bool is_tie = false, is_behind = true;
    for (int plane = 0; plane < 4; ++plane) {
      double most = -1e300;
      for (const Eigen::Vector3d& corner : corners) {
        most = std::max(most, normals_[plane].dot(corner - origins_[plane]));
      }
      if (most < -kTie) return Place::kOut;
      is_tie = is_tie || most < kTie;
    }
    for (const Eigen::Vector3d& corner : corners) {
      is_behind = is_behind && !(InMap(map_, corner).z() > 0.0);
    }
    if (is_behind) return Place::kOut;
    return is_tie ? Place::kTie : Place::kIn;
  }

 private:
  const PlanMap& map_;
  std::array<Eigen::Vector3d, 4> origins_, normals_;
};

std::array<Eigen::Vector3d, 3> CornersOf(const Scene& scene, size_t triangle) {
  std::array<Eigen::Vector3d, 3> corners;
  for (int i = 0; i < 3; ++i) {
    corners[i] = scene.vertices[scene.triangles[triangle][i]].cast<double>();
  }
  return corners;
}

// Boxes and triangles all around, some behind the lamp; a light that has some of them in each map.
PlanStage CrowdedStage(uint64_t seed, Random& random, Scene* scene) {
  PlanStage stage(seed, RandomLightAbove(random), 32, 24);
  *scene = stage.caster.scene();
  const Scene triangles = testing::RandomTriangles(random, 400, 50.0);
  for (size_t i = 0; i < triangles.triangles.size(); ++i) {
    const auto corners = CornersOf(triangles, i);
    testing::AddTriangle(corners[0], corners[1], corners[2], scene);
  }
  return stage;
}

TEST(MeasurePlanCosts, CastersAreThoseNotOutsideOfAPlaneThroughTwoCornerRays) {
  int64_t num_drawn = 0, num_out = 0, num_ties = 0;
  for (uint64_t seed = 821; seed < 831; ++seed) {
    Random random(seed);
    Scene scene;
    const PlanStage stage = CrowdedStage(seed, random, &scene);
    const RayCaster crowded = testing::Caster(scene);
    const Plan plan = RandomPlan(stage, random, random.Int(1, 6));
    const PlanCosts costs = Measured(crowded, stage.image, stage.truth, stage.light, plan);
    std::vector<int> draws(crowded.scene().triangles.size(), 0);
    int64_t num_ties_here = 0, sum = 0;
    for (size_t k = 0; k < plan.maps.size(); ++k) {
      const FrustumByRays frustum(plan.maps[k], stage.light, crowded.bounds());
      int64_t drawn = 0, ties = 0;
      for (size_t i = 0; i < draws.size(); ++i) {
        const FrustumByRays::Place place = frustum.Of(CornersOf(crowded.scene(), i));
        drawn += place == FrustumByRays::Place::kIn;
        ties += place == FrustumByRays::Place::kTie;
        num_out += place == FrustumByRays::Place::kOut;
        draws[i] += place != FrustumByRays::Place::kOut;
      }
      EXPECT_GE(costs.maps[k].casters, drawn);
      EXPECT_LE(costs.maps[k].casters, drawn + ties);
      num_ties_here += ties;
      sum += costs.maps[k].casters;
      num_drawn += drawn;
    }
    int64_t in_any = 0;
    for (const int count : draws) in_any += count > 0;
    EXPECT_LE(costs.casters, in_any);
    EXPECT_GE(costs.casters, in_any - num_ties_here);
    EXPECT_DOUBLE_EQ(costs.draws_per_caster, static_cast<double>(sum) / costs.casters);
    num_ties += num_ties_here;
  }
  std::printf("%lld drawn, %lld left out, %lld on a plane\n",
              static_cast<long long>(num_drawn),
              static_cast<long long>(num_out),
              static_cast<long long>(num_ties));
  EXPECT_GT(num_drawn, 1000);
  EXPECT_GT(num_out, 1000);
  EXPECT_LT(num_ties, num_drawn / 100);
}

// Every triangle of which any point lies in the rectangle, before the light, is drawn; few others.
TEST(MeasurePlanCosts, NoCasterIsMissedAndFewAreDrawnForNothing) {
  int64_t num_reaching = 0, num_drawn = 0;
  for (uint64_t seed = 841; seed < 847; ++seed) {
    Random random(seed);
    Scene scene;
    const PlanStage stage = CrowdedStage(seed, random, &scene);
    Plan plan = RandomPlan(stage, random, 1);
    // Receivers' half spaces cut no casters.
    Eigen::RowVector4d half_space;
    half_space << random.UnitVector().transpose(), 0.0;
    plan.maps[0].half_spaces.push_back(half_space);
    const RayCaster crowded = testing::Caster(scene);
    int64_t reaching = 0;
    for (size_t i = 0; i < crowded.scene().triangles.size(); ++i) {
      const auto corners = CornersOf(crowded.scene(), i);
      constexpr int kSteps = 40;
      bool reaches = false;
      for (int a = 0; a <= kSteps && !reaches; ++a) {
        for (int b = 0; a + b <= kSteps && !reaches; ++b) {
          const Eigen::Vector3d point =
              corners[0] + (corners[1] - corners[0]) * (static_cast<double>(a) / kSteps) +
              (corners[2] - corners[0]) * (static_cast<double>(b) / kSteps);
          reaches = IsInRectangle(plan.maps[0], point);
        }
      }
      reaching += reaches;
    }
    const PlanCosts costs = Measured(crowded, stage.image, stage.truth, stage.light, plan);
    EXPECT_GE(costs.maps[0].casters, reaching);
    EXPECT_EQ(costs.casters, costs.maps[0].casters);
    EXPECT_EQ(costs.draws_per_caster, 1.0);
    num_reaching += reaching;
    num_drawn += costs.casters;
  }
  std::printf("%lld reach in, %lld drawn\n",
              static_cast<long long>(num_reaching),
              static_cast<long long>(num_drawn));
  EXPECT_GT(num_reaching, 200);
  EXPECT_LT(num_drawn, 1.2 * num_reaching);
}

// Texels of a unit of the floor; columns of a board of 10 x 10 around the origin, from `first` on.
PlanMap NoonColumns(const Light& noon, int first, int num_columns) {
  const Eigen::Matrix<double, 3, 4> ray_from_world = RayFromWorld(noon);
  // Rays are (e1.x, e2.x, 1) in some turn: that of the world's x and y.
  Eigen::Matrix3d world_from_ray = Eigen::Matrix3d::Identity();
  world_from_ray.topLeftCorner<2, 2>() = ray_from_world.topLeftCorner<2, 2>().inverse();
  Eigen::Matrix3d map_from_world = Eigen::Matrix3d::Identity();
  map_from_world(0, 2) = 5.0 - first;
  map_from_world(1, 2) = 5.0;
  return testing::PlanMapOf(
      MapFromWorld(map_from_world * world_from_ray, ray_from_world, noon, {1.0, 2.0}, 1.0),
      {num_columns, 10});
}

TEST(MeasurePlanCosts, CountsOfABoardByHand) {
  const Light noon = Light::Directional("noon", {0.0, 0.0, -1.0});
  Scene scene;
  testing::AddFloor(5.0, &scene);  // two triangles, in every map
  // One small triangle over each of the columns 0 ... 9, at x = -4.5 ... 4.5.
  for (int column = 0; column < 10; ++column) {
    const Eigen::Vector3d middle(column - 4.5, 0.0, 2.0);
    testing::AddTriangle(middle + Eigen::Vector3d(0.1, 0, 0),
                         middle + Eigen::Vector3d(0, 0.1, 0),
                         middle + Eigen::Vector3d(-0.1, 0, 0),
                         &scene);
  }
  const RayCaster caster = testing::Caster(scene);
  const Camera camera = *LookAtCamera({0, -9, 7}, {0, 0, 0}, Eigen::Vector3d::UnitZ(), 0.7, 48, 48);
  const SurfaceImage image = *RenderSurfaces(caster, camera);
  const std::vector<Lighting> truth = TrueLighting(caster, image, noon);
  Plan plan;
  plan.maps = {NoonColumns(noon, 0, 4), NoonColumns(noon, 3, 6)};
  const PlanCosts costs = Measured(caster, image, truth, noon, plan);
  EXPECT_EQ(costs.maps[0].casters, 2 + 4);  // columns 0 ... 3
  EXPECT_EQ(costs.maps[1].casters, 2 + 6);  // 3 ... 8
  EXPECT_EQ(costs.casters, 2 + 9);
  EXPECT_DOUBLE_EQ(costs.draws_per_caster, 14.0 / 11.0);
}

TEST(MeasurePlanCosts, WhatLiesBehindALampIsNotDrawn) {
  const Light lamp = Light::Point("lamp", {0.0, 0.0, 5.0});
  Scene scene;
  testing::AddFloor(5.0, &scene);  // two triangles
  // One above the lamp; one that reaches from above it into its cone; one beside.
  testing::AddTriangle({-1, -1, 7}, {1, -1, 7}, {0, 1, 7}, &scene);
  testing::AddTriangle({0.1, 0, 8}, {-0.1, 0, 8}, {0, 0.1, 1}, &scene);
  testing::AddTriangle({9, 0, 4}, {9, 1, 4}, {9, 0, 3}, &scene);
  const RayCaster caster = testing::Caster(scene);
  const Camera camera = *LookAtCamera({0, -9, 7}, {0, 0, 0}, Eigen::Vector3d::UnitZ(), 0.7, 48, 48);
  const SurfaceImage image = *RenderSurfaces(caster, camera);
  const std::vector<Lighting> truth = TrueLighting(caster, image, lamp);
  // The floor's middle, seen from the lamp.
  const Eigen::Vector3d down = -Eigen::Vector3d::UnitZ();
  const Eigen::Matrix<double, 3, 4> ray_from_world = RayFromWorld(lamp, down);
  Eigen::Matrix3d map_from_ray;
  map_from_ray << 50.0, 0.0, 32.0, 0.0, 50.0, 32.0, 0.0, 0.0, 1.0;
  Plan plan;
  plan.maps = {testing::PlanMapOf(MapFromWorld(map_from_ray, ray_from_world, lamp, {1.0, 2.0}, 1.0),
                                  {64, 64})};
  EXPECT_EQ(Measured(caster, image, truth, lamp, plan).casters, 3);
}

TEST(MeasurePlanCosts, IsZeroWhereNothingIsThere) {
  const PlanStage stage(851, Light::Directional("sun", {1.0, 0.7, -0.8}));
  Plan plan;
  // A map of what lies beyond the scene.
  plan.maps = {testing::PlanMapOf(
      testing::Moved(testing::MapAround(stage.image, stage.light, {64, 64}), {1e6, 0.0}),
      {64, 64})};
  const PlanCosts costs = Measured(stage, plan);
  EXPECT_EQ(costs.overlap, 0.0);
  EXPECT_EQ(costs.casters, 0);
  EXPECT_EQ(costs.draws_per_caster, 0.0);
  // Nor is a pixel of no receiver.
  const std::vector<Lighting> background(stage.truth.size(), Lighting::kBackground);
  EXPECT_EQ(Measured(stage.caster, stage.image, background, stage.light, plan).overlap, 0.0);
}

TEST(MeasurePlanCosts, RefusesWhatItCannotMeasure) {
  Random random(861);
  const PlanStage stage(861, Light::Directional("sun", {1.0, 0.7, -0.8}));
  const Plan plan = RandomPlan(stage, random, 2);
  constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
  EXPECT_THAT(MeasurePlanCosts(stage.caster, stage.image, {}, stage.light, plan),
              StatusIs(kInvalid, HasSubstr("truth has 0 pixels")));
  EXPECT_THAT(MeasurePlanCosts(stage.caster, stage.image, stage.truth, stage.light, {}),
              StatusIs(kInvalid, HasSubstr("plan of 0 maps")));
  EXPECT_THAT(MeasurePlanCosts(
                  stage.caster, stage.image, stage.truth, Light::Point("lamp", {1, 2, 9}), plan),
              StatusIs(kInvalid, HasSubstr("do not leave the light")));
}

}  // namespace
}  // namespace lightfit
