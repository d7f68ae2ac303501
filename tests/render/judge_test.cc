#include "render/judge.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/shadow_map.h"
#include "tests/render/testing.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using testing::AddQuad;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::Random;
using testing::StatusIs;

// A scene, what a camera sees of it, and the truth.
struct Stage {
  Stage(Scene scene, const Camera& camera, const Light& light, int num_threads = 2)
      : caster(testing::Caster(std::move(scene), num_threads)),
        image(*RenderSurfaces(caster, camera)),
        light(light),
        truth(TrueLighting(caster, image, light)),
        counts(CountLighting(truth)) {}

  ShadowImage Judged(MapSize size) const {
    return Judged(testing::MapAround(image, light, size), size);
  }
  ShadowImage Judged(const Eigen::Matrix4d& matrix, MapSize size) const {
    auto judged = JudgeMatrix(caster, image, truth, light, matrix, size);
    EXPECT_THAT(judged, IsOk());
    return judged.ok() ? *std::move(judged) : ShadowImage();
  }

  RayCaster caster;
  SurfaceImage image;
  Light light;
  std::vector<Lighting> truth;
  LightingCounts counts;
};

Camera Above(int width = 64, int height = 64) {
  return *LookAtCamera({2, -9, 7}, {0, 0, 0}, Eigen::Vector3d::UnitZ(), 0.7, width, height);
}

Stage BoxStage(uint64_t seed, const Light& light, int num_threads = 2) {
  const BoxScene boxes = MakeBoxScene(seed);
  return Stage(testing::SceneOf(boxes), RandomCamera(boxes, seed, 96, 72), light, num_threads);
}

const Light kSun = Light::Directional("sun", {1, 0.7, -0.8});
const Light kLamp = Light::Point("lamp", {12, -9, 12});

TEST(JudgeMatrix, ManyTexelsGiveTheTruthAndFewerGiveLessOfIt) {
  for (const Light& light : {kSun, kLamp}) {
    const Stage stage = BoxStage(81, light);
    ASSERT_GT(stage.counts.shadowed, 100);
    int64_t previous = -1;
    for (const int size : {4096, 256, 64, 16}) {
      const WrongPixels wrong = stage.Judged({size, size}).wrong;
      // Texels of a centimetre: a pixel or two on an edge.
      if (size == 4096) {
        EXPECT_LE(wrong.ideal, 20) << light.name;
      }
      EXPECT_GT(wrong.ideal, previous) << light.name << " " << size;
      EXPECT_EQ(wrong.outside, 0);
      previous = wrong.ideal;
    }
  }
}

TEST(JudgeMatrix, ALoneTiltedPlaneHasNoAcne) {
  Scene scene;
  AddQuad({-5, -5, -1}, {5, -5, 2}, {5, 5, 4}, {-5, 5, 1}, &scene);
  for (const Light& light : {kSun, kLamp, Light::Directional("low", {1, 0.2, -0.4})}) {
    const Stage stage(scene, Above(), light);
    ASSERT_GT(stage.counts.lit, 1000) << light.name;
    for (const int size : {3, 8, 50}) {
      const WrongPixels wrong = stage.Judged({size, size}).wrong;
      EXPECT_EQ(wrong.ideal, 0) << light.name;
      EXPECT_EQ(wrong.practical, 0) << light.name;
    }
  }
}

TEST(JudgeMatrix, ConvexBoxesAloneHaveNoAcne) {
  Random random(62);
  for (int i = 0; i < 5; ++i) {
    Scene scene;
    const Eigen::Vector3d half_size = Eigen::Vector3d::Constant(1.5) + 0.5 * random.InCube(1.0);
    testing::AddBox({{0, 0, 0}, half_size, random.Uniform(0.0, 3.0)}, &scene);
    for (const Light& light : {kSun, kLamp}) {
      const Stage stage(scene, Above(), light);
      ASSERT_GT(stage.counts.lit, 200);
      for (const int size : {3, 8, 50}) {
        const WrongPixels wrong = stage.Judged({size, size}).wrong;
        EXPECT_EQ(wrong.ideal, 0) << light.name << " " << size;
        EXPECT_EQ(wrong.practical, 0) << light.name << " " << size;
      }
    }
  }
}

// Two planes that meet in the line x = 0, z = 0, at 45 degrees.
Scene TwoPlanes(double side_height) {
  Scene scene;
  AddQuad({0, -3, 0}, {0, 3, 0}, {-3, 3, side_height}, {-3, -3, side_height}, &scene);
  AddQuad({0, -3, 0}, {0, 3, 0}, {3, 3, side_height}, {3, -3, side_height}, &scene);
  return scene;
}

TEST(JudgeMatrix, PracticalBiasAddsFalseShadowInValleysOnly) {
  const Light light = Light::Directional("sun", {0.2, 0.3, -1});
  const Stage valley(TwoPlanes(3.0), Above(), light);
  ASSERT_EQ(valley.counts.shadowed, 0);
  const WrongPixels in_valley = valley.Judged({12, 12}).wrong;
  EXPECT_EQ(in_valley.ideal, 0);
  EXPECT_GT(in_valley.practical, 10);
  EXPECT_GT(in_valley.practical_weighted, 0.3 * in_valley.practical);
  EXPECT_LT(in_valley.practical_weighted, in_valley.practical);

  const Stage roof(TwoPlanes(-3.0), Above(), light);
  ASSERT_EQ(roof.counts.shadowed, 0);
  EXPECT_EQ(roof.Judged({12, 12}).wrong.ideal, 0);
  EXPECT_EQ(roof.Judged({12, 12}).wrong.practical, 0);
}

TEST(JudgeMatrix, ReceiversOutsideTheMapAreLit) {
  const Stage stage = BoxStage(71, kSun);
  ASSERT_GT(stage.counts.shadowed, 100);
  const MapSize size = {64, 64};
  Eigen::Matrix4d away = testing::MapAround(stage.image, stage.light, size);
  away.row(0) += 1000.0 * away.row(3);
  const ShadowImage judged = stage.Judged(away, size);
  EXPECT_EQ(judged.wrong.ideal, stage.counts.shadowed);
  EXPECT_EQ(judged.wrong.outside, stage.counts.shadowed);
  EXPECT_EQ(CountLighting(judged.ideal).lit, stage.counts.lit + stage.counts.shadowed);
  EXPECT_EQ(CountLighting(judged.practical).shadowed, 0);

  // Half of them.
  Eigen::Matrix4d half = testing::MapAround(stage.image, stage.light, size);
  half.row(0) += 32.0 * half.row(3);
  const WrongPixels wrong = stage.Judged(half, size).wrong;
  EXPECT_GT(wrong.outside, 0);
  EXPECT_LT(wrong.outside, stage.counts.shadowed);
}

TEST(JudgeMatrix, LeavesBackgroundAndSurfacesThatFaceAwayAlone) {
  const Stage stage = BoxStage(83, kSun);
  const ShadowImage judged = stage.Judged({32, 32});
  for (size_t i = 0; i < stage.truth.size(); ++i) {
    if (stage.truth[i] == Lighting::kLit || stage.truth[i] == Lighting::kShadowed) continue;
    EXPECT_EQ(judged.ideal[i], stage.truth[i]);
    EXPECT_EQ(judged.practical[i], stage.truth[i]);
  }
}

// The definition, by all hits of every texel's ray.
void ExpectIsBruteForce(const Stage& stage, MapSize size) {
  const Eigen::Matrix4d matrix = testing::MapAround(stage.image, stage.light, size);
  const ShadowImage judged = stage.Judged(matrix, size);
  const auto map_from_ray = MapFromRay(matrix, stage.light);
  ASSERT_THAT(map_from_ray, IsOk());
  const MapRays rays(stage.light, *map_from_ray, stage.caster.bounds());
  int num_compared = 0, num_dark = 0, num_skipped = 0;
  for (size_t i = 0; i < stage.truth.size(); ++i) {
    if (stage.truth[i] != Lighting::kLit && stage.truth[i] != Lighting::kShadowed) continue;
    const SurfacePoint& pixel = stage.image.pixels[i];
    const Eigen::Vector4d place = matrix * pixel.position.homogeneous();
    const double u = std::floor(place.x() / place.w()) + 0.5;
    const double v = std::floor(place.y() / place.w()) + 0.5;
    const std::optional<Ray> ray = rays.At(u, v);
    ASSERT_TRUE(ray.has_value());
    const testing::BruteHits hits = testing::AllHits(stage.caster.scene(), *ray);
    const double slope = pixel.normal.dot(ray->direction);
    // Edges and edge-on planes are left to rounding.
    if (hits.near_an_edge || slope > -1e-2) {
      ++num_skipped;
      continue;
    }
    const double wanted = pixel.normal.dot(pixel.position - ray->origin) / slope;
    bool ideal = false, practical = false;
    if (!hits.distances.empty()) {
      double nearest = hits.distances[0];
      for (const double hit : hits.distances) {
        if (std::abs(hit - wanted) < std::abs(nearest - wanted)) nearest = hit;
      }
      ideal = nearest > hits.distances[0] + 1e-4;
      practical = hits.distances[0] < wanted - 1e-4 - 2e-4 * 20.0;  // the default's largest share
      if (std::abs(wanted - hits.distances[0]) < 0.02)
        practical = judged.practical[i] == Lighting::kShadowed;
    }
    ++num_compared;
    num_dark += ideal;
    EXPECT_EQ(judged.ideal[i] == Lighting::kShadowed, ideal) << "pixel " << i;
    EXPECT_EQ(judged.practical[i] == Lighting::kShadowed, practical) << "pixel " << i;
  }
  EXPECT_GT(num_compared, 800);
  EXPECT_GT(num_dark, 50);
  EXPECT_LT(num_skipped, num_compared / 4);
}

TEST(JudgeMatrix, IsBruteForceOnBoxes) {
  Random random(65);
  Scene scene;
  testing::AddFloor(4.0, &scene);
  for (int i = 0; i < 6; ++i) {
    Eigen::Vector3d center = random.InCube(3.0);
    center.z() = random.Uniform(0.5, 2.0);
    testing::AddBox({center, Eigen::Vector3d(0.5, 0.3, 0.4), random.Uniform(0.0, 3.0)}, &scene);
  }
  for (const Light& light : {kSun, kLamp})
    ExpectIsBruteForce(Stage(scene, Above(), light), {24, 24});
}

TEST(JudgeMatrix, IsBruteForceOnRandomTriangles) {
  Random random(66);
  Scene scene = testing::RandomTriangles(random, 60, 5.0);
  testing::AddFloor(4.0, &scene);
  for (const Light& light : {kSun, kLamp})
    ExpectIsBruteForce(Stage(scene, Above(), light), {24, 24});
}

TEST(JudgeMatrix, IsTheSameOnAnyNumberOfThreads) {
  const ShadowImage one = BoxStage(67, kSun, 1).Judged({100, 100});
  for (const int num_threads : {2, 5}) {
    const ShadowImage other = BoxStage(67, kSun, num_threads).Judged({100, 100});
    EXPECT_EQ(other.ideal, one.ideal);
    EXPECT_EQ(other.practical, one.practical);
    EXPECT_EQ(other.wrong.practical_weighted, one.wrong.practical_weighted);
  }
}

TEST(JudgeMatrix, AFarLampIsAsGoodAsTheSunInItsDirection) {
  const Stage sun = BoxStage(83, kSun);
  const Stage lamp = BoxStage(83, Light::Point("far", -1e5 * kSun.direction.normalized()));
  const MapSize size = {128, 128};
  const int64_t wrong_sun = sun.Judged(size).wrong.ideal;
  const int64_t wrong_lamp =
      lamp.Judged(testing::MapAround(lamp.image, lamp.light, size, kSun.direction), size)
          .wrong.ideal;
  EXPECT_NEAR(static_cast<double>(wrong_lamp), static_cast<double>(wrong_sun), 0.3 * wrong_sun);
}

TEST(JudgeMatrix, RefusesWhatItCannotJudge) {
  const Stage stage = BoxStage(69, kSun);
  const MapSize size = {16, 16};
  const Eigen::Matrix4d matrix = testing::MapAround(stage.image, stage.light, size);
  const auto judge = [&](const Light& light, MapSize map_size, double constant_share) {
    BiasOptions bias;
    bias.constant_share = constant_share;
    return JudgeMatrix(stage.caster, stage.image, stage.truth, light, matrix, map_size, bias);
  };
  constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
  EXPECT_THAT(judge(kLamp, size, 0.0), StatusIs(kInvalid, HasSubstr("do not leave the light")));
  EXPECT_THAT(judge(kSun, {0, 16}, 0.0), StatusIs(kInvalid, HasSubstr("0x16")));
  EXPECT_THAT(judge(kSun, {65536, 65536}, 0.0), StatusIs(kInvalid, HasSubstr("65536x65536")));
  EXPECT_THAT(judge(kSun, size, -1.0), StatusIs(kInvalid, HasSubstr("constant_share = -1")));
  EXPECT_THAT(judge(kSun, size, std::nan("")), StatusIs(kInvalid, HasSubstr("constant_share")));
  EXPECT_THAT(JudgeMatrix(stage.caster, stage.image, {}, kSun, matrix, size),
              StatusIs(kInvalid, HasSubstr("truth has 0 pixels")));
}

}  // namespace
}  // namespace lightfit
