// tests/render/judge_stage.h
//
// A scene, what a camera sees of it, and the truth, for tests of the judge.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "render/judge.h"
#include "tests/render/testing.h"
#include "tests/testing/matchers.h"

namespace lightfit::testing {

struct Stage {
  Stage(Scene scene, const Camera& camera, const Light& light, int num_threads = 2)
      : caster(Caster(std::move(scene), num_threads)),
        image(*RenderSurfaces(caster, camera)),
        light(light),
        truth(TrueLighting(caster, image, light)),
        counts(CountLighting(truth)) {}

  ShadowImage Judged(MapSize size) const { return Judged(MapAround(image, light, size), size); }
  ShadowImage Judged(const Eigen::Matrix4d& matrix, MapSize size) const {
    return Judged(JudgedMap{matrix, size});
  }
  ShadowImage Judged(const JudgedMap& map, int phases = 1) const {
    JudgeOptions options;
    options.phases = phases;
    auto judged = JudgeMatrix(caster, image, truth, light, map, options);
    EXPECT_THAT(judged, IsOk());
    return judged.ok() ? *std::move(judged) : ShadowImage();
  }

  RayCaster caster;
  SurfaceImage image;
  Light light;
  std::vector<Lighting> truth;
  LightingCounts counts;
};

inline Camera Above(int width = 64, int height = 64) {
  return *LookAtCamera({2, -9, 7}, {0, 0, 0}, Eigen::Vector3d::UnitZ(), 0.7, width, height);
}

inline Stage BoxStage(uint64_t seed, const Light& light, int num_threads = 2) {
  const BoxScene boxes = MakeBoxScene(seed);
  return Stage(SceneOf(boxes), RandomCamera(boxes, seed, 96, 72), light, num_threads);
}

inline const Light kSun = Light::Directional("sun", {1, 0.7, -0.8});
inline const Light kLamp = Light::Point("lamp", {12, -9, 12});

}  // namespace lightfit::testing
