#include "optimizer/readback/cover.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>

#include "geometry/convex_hull.h"
#include "optimizer/figures/footprint_image.h"
#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::PlaneReadback;
using testing::StatusIs;
using testing::TestScene;

std::vector<Eigen::Vector3d> WorldPositions(const Surfaces& surfaces) {
  return *ReceiverPositions(surfaces.readback);
}

// The distance of a point outside the polygon, in units of rays; negative inside.
double DistanceOutside(const Polygon& polygon, const Eigen::Vector2d& point) {
  double outside = -1e300;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d edge = polygon[(i + 1) % polygon.size()] - polygon[i];
    outside = std::max(outside, -Cross(edge, point - polygon[i]) / edge.norm());
  }
  return outside;
}

// Calls check(light, receivers, cover) for each light of some random scenes.
template <typename Check>
void ForEachCover(const Check& check) {
  int num_covers = 0;
  for (uint64_t seed = 1; seed <= 8; ++seed) {
    const TestScene scene(seed, 6, 160, 100);
    const Surfaces surfaces = *FindSurfaces(scene.View(), 0x3f, {});
    for (const Light& light : scene.lights) {
      const absl::StatusOr<RayCover> cover = CoverReceivers(surfaces, light, Cover::kReceivers);
      ASSERT_THAT(cover, IsOk()) << light.name << ", seed " << seed;
      SCOPED_TRACE(light.name);
      check(light, surfaces, *cover);
      ++num_covers;
    }
  }
  EXPECT_EQ(num_covers, 48);
}

// Tiles bound the hull and only some are looked into, yet it is that of all pixels.
TEST(CoverReceivers, HullIsExactlyThatOfAllPixels) {
  ForEachCover([](const Light& light, const Surfaces& surfaces, const RayCover& cover) {
    std::vector<Eigen::Vector2d> points;
    for (const Eigen::Vector3d& position : WorldPositions(surfaces)) {
      const Eigen::Vector3d ray =
          cover.normalized_from_ray * (RayFromWorld(light) * position.homogeneous());
      EXPECT_GT(ray.z(), 0.0);
      points.push_back(ray.hnormalized());
      EXPECT_LE(DistanceOutside(cover.hull, points.back()), 1e-9);
    }
    const Polygon exact = ConvexHull(points);
    for (const Eigen::Vector2d& vertex : cover.hull) {
      EXPECT_GE(DistanceOutside(exact, vertex), -1e-9);  // on the exact hull, not outside of it
      EXPECT_LE(DistanceOutside(exact, vertex), 1e-9);
    }
    EXPECT_NEAR(Area(cover.hull), Area(exact), 1e-9);
  });
}

TEST(CoverReceivers, OriginIsStrictlyInsideTheHull) {
  ForEachCover([](const Light&, const Surfaces&, const RayCover& cover) {
    EXPECT_LT(DistanceOutside(cover.hull, {0.0, 0.0}), -0.01);
    EXPECT_GT(cover.normalized_from_ray.determinant(), 0.0);
  });
}

TEST(CoverReceivers, DepthBoundsHoldAndAreNotLoose) {
  ForEachCover([](const Light& light, const Surfaces& surfaces, const RayCover& cover) {
    double near = 1e300, far = -1e300;
    for (const Eigen::Vector3d& position : WorldPositions(surfaces)) {
      const Eigen::Vector3d ray = RayFromWorld(light) * position.homogeneous();
      const double depth = light.kind == Light::Kind::kPoint
                               ? cover.normalized_from_ray.row(2).dot(ray)
                               : position.dot(light.direction.normalized());
      near = std::min(near, depth);
      far = std::max(far, depth);
    }
    const double rounding = 1e-9 * std::max(std::abs(near), std::abs(far));
    EXPECT_LE(cover.depth.near, near + rounding);
    EXPECT_GE(cover.depth.far, far - rounding);
    // Tile corners reach further than their receivers, but not by more than the scene's extent.
    EXPECT_GE(cover.depth.near, near - 1.5 * (far - near));
    EXPECT_LE(cover.depth.far, far + 1.5 * (far - near));
    if (light.kind == Light::Kind::kPoint) {
      EXPECT_GT(cover.depth.near, 0.0);
      EXPECT_NEAR(cover.normalized_from_ray.row(2).norm(), 1.0, 1e-9);
    }
  });
}

// Tiles stand for their receivers: the mean is that of all unit rays to a share of the cone.
TEST(CoverReceivers, MeanRayIsTheMeanOfUnitRays) {
  ForEachCover([](const Light& light, const Surfaces& surfaces, const RayCover& cover) {
    EXPECT_NEAR(cover.mean_ray.norm(), 1.0, 1e-12);
    if (light.kind == Light::Kind::kDirectional) {
      EXPECT_EQ(cover.mean_ray, Eigen::Vector3d::UnitZ());
      return;
    }
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    double spread = 0.0;
    const auto positions = WorldPositions(surfaces);
    for (const Eigen::Vector3d& position : positions) {
      mean += (RayFromWorld(light) * position.homogeneous()).normalized();
    }
    mean.normalize();
    for (const Eigen::Vector3d& position : positions) {
      spread = std::max(
          spread, ((RayFromWorld(light) * position.homogeneous()).normalized() - mean).norm());
    }
    EXPECT_LT((cover.mean_ray - mean).norm(), 0.15 * spread);
  });
}

PlaneReadback Floor() { return testing::FloorReadback(); }

TEST(CoverReceivers, LightAmongReceiversHasNoSingleMap) {
  // Boxes all around and a floor below; the lamp hangs between them, near the floor.
  const BoxScene scene = MakeBoxScene(3);
  const Camera camera =
      *LookAtCamera({0.0, -30.0, 20.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.9, 160, 100);
  const Light lamp = Light::Point("lamp", {0.0, 0.0, 0.01});
  const SyntheticReadback readback = Render(scene, camera, {lamp});
  const Surfaces surfaces = *FindSurfaces(readback.View(), 1u, {});
  EXPECT_THAT(CoverReceivers(surfaces, lamp),
              StatusIs(absl::StatusCode::kFailedPrecondition,
                       AllOf(HasSubstr("light \"lamp\""), HasSubstr("dual paraboloid"))));
}

// A wall seen head-on has one depth, so that it is flat to the last bit.
TEST(CoverReceivers, LightInThePlaneOfItsReceiversHasNoMap) {
  Camera camera;
  camera.width = 40;
  camera.height = 30;
  camera.screen_from_camera << 32.0, 0.0, 20.0, 0.0, 32.0, 15.0, 0.0, 0.0, 1.0;
  const PlaneReadback readback(camera, DepthKind::kCameraZ, Eigen::Vector3d::UnitZ(), 4.0);
  const Surfaces surfaces = *FindSurfaces(readback.View(), 1u, {});
  for (const Light& light :
       {Light::Directional("skim", {1.0, 0.5, 0.0}), Light::Point("skim", {20.0, 3.0, 4.0})}) {
    EXPECT_THAT(CoverReceivers(surfaces, light),
                StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("light \"skim\"")));
  }
}

TEST(CoverReceivers, OneReceiverHasNoMap) {
  PlaneReadback readback = Floor();
  const float centre = readback.depth[readback.Index(20, 15)];
  readback.depth.assign(readback.depth.size(), 1e10f);
  readback.depth[readback.Index(20, 15)] = centre;
  const Surfaces surfaces = *FindSurfaces(readback.View(), 1u, {});
  for (const Light& light :
       {Light::Directional("sun", {0.1, 0.2, -1.0}), Light::Point("lamp", {1.0, 2.0, 5.0})}) {
    EXPECT_THAT(CoverReceivers(surfaces, light),
                StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("no area")));
  }
}

}  // namespace
}  // namespace lightfit
