#include "render/shadow_map.h"

#include <gtest/gtest.h>

#include "tests/render/testing.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using testing::Random;

struct MapCase {
  Light light;
  Eigen::Matrix4d map_from_world;
  Eigen::Matrix3d map_from_ray;
};

// A map of a random light with a tilted axis, around the points of a cube of side 10.
MapCase RandomMap(Random& random, bool is_point) {
  MapCase map;
  const Eigen::Vector3d to_light = random.UnitVector();
  map.light = is_point ? Light::Point("lamp", 10.0 * random.LogUniform(2.0, 1e4) * to_light)
                       : Light::Directional("sun", -2.0 * to_light);
  const Eigen::Matrix<double, 3, 4> ray_from_world = RayFromWorld(map.light, -to_light);
  Eigen::Matrix3d h;
  const double tilt = is_point ? 0.2 * map.light.position.norm() / 10.0 : 0.02;
  h << 5.0 * random.Rotation().topRows<2>(), random.Uniform(-tilt, tilt),
      random.Uniform(-tilt, tilt), 1.0;
  map.map_from_world = MapFromWorld(h, ray_from_world, map.light, {1.0, 2.0}, 1.0);
  const auto map_from_ray = MapFromRay(map.map_from_world, map.light);
  EXPECT_THAT(map_from_ray, testing::IsOk());
  map.map_from_ray = *map_from_ray;
  return map;
}

TEST(MapRays, PointsOfARayFallOnItsTexel) {
  Random random(51);
  const Eigen::AlignedBox3d bounds(Eigen::Vector3d::Constant(-5), Eigen::Vector3d::Constant(5));
  for (int i = 0; i < 300; ++i) {
    const MapCase map = RandomMap(random, i % 2 == 0);
    const MapRays rays(map.light, map.map_from_ray, bounds);
    // A receiver, the ray of its place on the map, and back.
    const Eigen::Vector3d receiver = random.InCube(5.0);
    const Eigen::Vector4d place = map.map_from_world * receiver.homogeneous();
    ASSERT_GT(place.w(), 0.0);
    const double u = place.x() / place.w(), v = place.y() / place.w();
    const std::optional<Ray> ray = rays.At(u, v);
    ASSERT_TRUE(ray.has_value());
    EXPECT_NEAR(ray->direction.norm(), 1.0, 1e-12);
    const double along = ray->direction.dot(receiver - ray->origin);
    EXPECT_GT(along, 0.0);
    // Rounding of the light's position, 1e-16 of up to 1e5.
    EXPECT_LE((ray->origin + along * ray->direction - receiver).norm(), 1e-8);
    // Distances of one receiver agree between neighbouring rays of a sun.
    if (map.light.kind == Light::Kind::kDirectional) {
      const std::optional<Ray> other = rays.At(u + 0.3, v - 0.2);
      ASSERT_TRUE(other.has_value());
      EXPECT_NEAR(other->direction.dot(receiver - other->origin), along, 1e-9);
    }
  }
}

TEST(MapRays, StartInFrontOfAllGeometry) {
  Random random(52);
  const Eigen::AlignedBox3d bounds(Eigen::Vector3d(-50, 2, 3), Eigen::Vector3d(5, 30, 8));
  for (int i = 0; i < 50; ++i) {
    const Light light = Light::Directional("sun", random.UnitVector());
    const MapRays rays(light, Eigen::Matrix3d::Identity(), bounds);
    const std::optional<Ray> ray = rays.At(random.Uniform(-100, 100), random.Uniform(-100, 100));
    ASSERT_TRUE(ray.has_value());
    for (int corner = 0; corner < 8; ++corner) {
      const auto type = static_cast<Eigen::AlignedBox3d::CornerType>(corner);
      EXPECT_GT(light.direction.dot(bounds.corner(type) - ray->origin), 0.0);
    }
  }
}

TEST(MapRays, NothingBeyondTheVanishingLineOfASun) {
  Eigen::Matrix3d map_from_ray = Eigen::Matrix3d::Identity();
  map_from_ray(2, 0) = 1.0;  // w = X_1 + 1
  const MapRays rays(Light::Directional("sun", {0, 0, -1}),
                     map_from_ray,
                     Eigen::AlignedBox3d(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones()));
  EXPECT_TRUE(rays.At(0.5, 0.0).has_value());
  EXPECT_FALSE(rays.At(1.5, 0.0).has_value());  // X = (1.5, 0, -0.5)
}

}  // namespace
}  // namespace lightfit
