#include "render/texel_maps.h"

#include <gtest/gtest.h>

#include "render/shadow_map.h"
#include "tests/render/testing.h"

namespace lightfit {
namespace {

using testing::Random;

// One map of a matrix, of which every receiver asks the first texel.
class OneMap : public TexelMaps {
 public:
  OneMap(const Light& light,
         const Eigen::Matrix3d& map_from_ray,
         MapSize size,
         const Eigen::AlignedBox3d& bounds)
      : rays_(light, map_from_ray, bounds), size_(size) {}

  int64_t num_texels() const override { return int64_t{size_.width} * size_.height; }
  int32_t TexelOf(const Eigen::Vector3d&) const override { return 0; }
  std::optional<Ray> RayOf(int32_t texel) const override {
    const int row = texel / size_.width;
    return rays_.At(texel % size_.width + 0.5, row + 0.5);
  }

 private:
  MapRays rays_;
  MapSize size_;
};

// A map with a tilted axis, around that of the light space.
Eigen::Matrix3d RandomMapFromRay(Random& random) {
  Eigen::Matrix3d map_from_ray;
  map_from_ray << 4.0 * random.Rotation().topLeftCorner<2, 2>(), Eigen::Vector2d(15.0, 10.0),
      random.Uniform(-0.02, 0.02), random.Uniform(-0.02, 0.02), 1.0;
  return map_from_ray;
}

Light RandomLight(Random& random) {
  const Eigen::Vector3d to_light = random.UnitVector();
  return random.Coin() ? Light::Point("lamp", random.LogUniform(1.0, 50.0) * to_light)
                       : Light::Directional("sun", -2.0 * to_light);
}

TEST(TexelMaps, CastDistancesToAPlaneAreExact) {
  Scene scene;
  testing::AddFloor(1e4, &scene);
  const RayCaster caster = testing::Caster(scene);
  int num_hits = 0;
  for (uint64_t seed = 53; seed < 65; ++seed) {
    Random random(seed);
    const OneMap map(RandomLight(random), RandomMapFromRay(random), {16, 12}, caster.bounds());
    const std::vector<uint8_t> wanted(192, 1);
    const std::unique_ptr<TexelHits> hits = map.Draw(caster, wanted);
    for (int texel = 0; texel < 192; ++texel) {
      const double distance = hits->First(texel);
      if (std::isinf(distance)) continue;
      const std::optional<Ray> ray = map.RayOf(texel);
      ASSERT_TRUE(ray.has_value());
      const double expected = -ray->origin.z() / ray->direction.z();
      EXPECT_NEAR(distance, expected, 1e-9 * expected);
      ++num_hits;
    }
  }
  EXPECT_GT(num_hits, 100);
}

TEST(TexelMaps, HitsBehindAreThoseOfBruteForce) {
  int num_behind = 0, num_not = 0;
  for (uint64_t seed = 71; seed < 77; ++seed) {
    Random random(seed);
    const RayCaster caster = testing::Caster(testing::RandomTriangles(random, 60, 10.0));
    const OneMap map(RandomLight(random), RandomMapFromRay(random), {40, 30}, caster.bounds());
    const std::vector<uint8_t> wanted(1200, 1);
    const std::unique_ptr<TexelHits> hits = map.Draw(caster, wanted);
    for (int texel = 0; texel < 1200; ++texel) {
      const testing::BruteHits brute = testing::AllHits(caster.scene(), *map.RayOf(texel));
      if (brute.near_an_edge) continue;
      if (brute.distances.empty()) {
        EXPECT_TRUE(std::isinf(hits->First(texel)));
        continue;
      }
      const double first = brute.distances[0];
      EXPECT_NEAR(hits->First(texel), first, 1e-6 * first);
      const double resolution = random.LogUniform(1e-3, 1.0), far = first + random.Uniform(0, 10);
      const auto is_behind = [&](double hit) { return hit > first + resolution && hit < far; };
      const bool is_expected =
          std::any_of(brute.distances.begin(), brute.distances.end(), is_behind);
      EXPECT_EQ(hits->HasBehind(texel, resolution, far), is_expected);
      ++(is_expected ? num_behind : num_not);
    }
  }
  EXPECT_GT(num_behind, 100);
  EXPECT_GT(num_not, 100);
}

TEST(TexelMaps, DrawsWantedTexelsOnly) {
  Scene scene;
  testing::AddFloor(10.0, &scene);
  const RayCaster caster = testing::Caster(scene);
  const OneMap map(
      Light::Directional("sun", {0, 0, -1}), Eigen::Matrix3d::Identity(), {4, 4}, caster.bounds());
  std::vector<uint8_t> wanted(16, 1);
  const std::unique_ptr<TexelHits> all = map.Draw(caster, wanted);
  wanted.assign(16, 0);
  wanted[5] = 1;
  const std::unique_ptr<TexelHits> one = map.Draw(caster, wanted);
  for (int i = 0; i < 16; ++i) {
    EXPECT_TRUE(std::isfinite(all->First(i)));
    if (i == 5) {
      EXPECT_EQ(one->First(i), all->First(i));
    } else {
      EXPECT_TRUE(std::isinf(one->First(i)));
    }
  }
}

}  // namespace
}  // namespace lightfit
