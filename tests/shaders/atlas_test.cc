// PlanLight() of docs/plans.md over an atlas: what it samples, its guard, and the page's example,
// drawn and looked up.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <set>
#include <tuple>
#include <vector>

#include "optimizer/figures/footprint_image.h"
#include "tests/partition/random_plan.h"
#include "tests/shaders/gl_atlas.h"
#include "tests/shaders/plan_shader.h"
#include "tests/shaders/plans_example.h"
#include "tests/testing/matchers.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using testing::AtlasLayout;
using testing::DepthTexture;
using testing::GlAtlas;
using testing::IsOk;
using testing::LightsOf;
using testing::Random;
using testing::RandomPlan;
using testing::RandomPlanLight;
using testing::ShaderLights;
using testing::ShaderPlace;
using testing::ShaderPoint;
using testing::SideBySide;
using testing::TestScene;

class PlanAtlas : public testing::GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (HasFatalFailure()) return;
    program_ = testing::LinkGlslLight("PlanLight");
    ASSERT_NE(program_, 0u);
  }
  void TearDown() override {
    glDeleteProgram(program_);
    GlTest::TearDown();
  }

  GLuint program_ = 0;
};

std::vector<ShaderPoint> PointsInCube(Random& random, int num_points) {
  std::vector<ShaderPoint> points;
  for (int i = 0; i < num_points; ++i) {
    points.push_back(random.InCube(4.0).cast<float>().homogeneous());
  }
  return points;
}

// How far a place in a texel is from the texel's sides, texels.
double DistanceFromTexelSide(const ShaderPlace& place) {
  return std::min(std::abs(place.u - std::round(place.u)), std::abs(place.v - std::round(place.v)));
}

// A random plan, and depths wherever its maps are.
struct DepthsOfMaps {
  Light light;
  Plan plan;
  AtlasLayout layout;         // side by side, or in layers one upon the other
  std::vector<float> depths;  // row by row, of `layout.width`

  DepthsOfMaps(Random& random, bool in_layers) : light(RandomPlanLight(random)) {
    plan = RandomPlan(light, random);
    plan.border = random.Coin() ? Border::kLit : Border::kDark;
    if (in_layers) {
      for (PlanMap& map : plan.maps) {
        map.size = plan.maps[0].size;
        layout.offsets.emplace_back(0, layout.height);
        layout.width = map.size.width;
        layout.height += map.size.height;
      }
    } else {
      layout = SideBySide(plan);
    }
    depths.resize(static_cast<size_t>(layout.width) * layout.height);
    for (float& depth : depths) depth = static_cast<float>(random.Uniform(0.0, 1.0));
  }

  float At(const ShaderPlace& place) const {
    const Eigen::Vector2i& offset = layout.offsets[static_cast<int>(place.map)];
    const int x = offset.x() + static_cast<int>(place.u);
    const int y = offset.y() + static_cast<int>(place.v);
    return depths[static_cast<size_t>(y) * layout.width + x];
  }
};

struct NumCompared {
  int texels = 0, lit = 0, outside = 0;
};

// Holds lights against the depths that the places say.
void Compare(const DepthsOfMaps& maps, const ShaderLights& found, NumCompared& num) {
  // Samplers of nearest texels may round a coordinate, and a comparison a depth.
  constexpr double kTexelRounding = 0.01, kDepthRounding = 1e-6;
  for (size_t i = 0; i < found.lights.size(); ++i) {
    const ShaderPlace& place = found.places[i];
    if (place.map < 0) {
      ASSERT_EQ(found.lights[i], maps.plan.border == Border::kLit ? 1.0f : 0.0f);
      ++num.outside;
      continue;
    }
    const float depth = maps.At(place);
    if (DistanceFromTexelSide(place) < kTexelRounding) continue;
    if (std::abs(place.depth - depth) < kDepthRounding) continue;
    ASSERT_EQ(found.lights[i], place.depth <= depth ? 1.0f : 0.0f)
        << "map " << place.map << " at " << place.u << ", " << place.v << ", depth " << place.depth
        << ", there " << depth;
    ++num.texels;
    num.lit += found.lights[i] == 1.0f ? 1 : 0;
  }
}

void ExpectManyOfAll(const NumCompared& num) {
  EXPECT_GT(num.texels, 10000);
  EXPECT_GT(num.lit, num.texels / 10);
  EXPECT_LT(num.lit, num.texels - num.texels / 10);
  EXPECT_GT(num.outside, 1000);
}

TEST_F(PlanAtlas, ComparesWithTheTexelOfTheAskedMapAndWithTheBorderOutside) {
  NumCompared num;
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    const DepthsOfMaps maps(random, /*in_layers=*/false);
    const DepthTexture atlas(maps.layout.width, maps.layout.height, maps.depths.data(), {});
    const auto uniforms = MakePlanUniforms(maps.plan, maps.light, 0.0, maps.layout.offsets);
    ASSERT_THAT(uniforms, IsOk());
    Compare(maps, LightsOf(program_, *uniforms, atlas, PointsInCube(random, 4000)), num);
  }
  ExpectManyOfAll(num);
}

TEST_F(PlanAtlas, LayersOfAnArrayAreComparedWithAlike) {
  const GLuint program = testing::LinkGlslLight("PlanLightInLayers");
  ASSERT_NE(program, 0u);
  NumCompared num;
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    const DepthsOfMaps maps(random, /*in_layers=*/true);
    const MapSize size = maps.plan.maps[0].size;
    const int num_layers = static_cast<int>(maps.plan.maps.size());
    const DepthTexture layers(
        size.width, size.height, maps.depths.data(), {.num_layers = num_layers});
    const auto uniforms = MakePlanUniforms(maps.plan, maps.light);
    ASSERT_THAT(uniforms, IsOk());
    Compare(maps, LightsOf(program, *uniforms, layers, PointsInCube(random, 4000)), num);
  }
  ExpectManyOfAll(num);
  glDeleteProgram(program);
}

// Maps that are wholly lit stand beside maps that are wholly dark: a sampler that blends 2x2 texels
// mixes them where a look-up is nearer to a side than half a texel.
TEST_F(PlanAtlas, GuardKeepsABlendingSamplerInItsMap) {
  int num_mixed_without = 0, num_asked = 0;
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    const Light light = RandomPlanLight(random);
    const Plan plan = RandomPlan(light, random);
    const AtlasLayout layout = SideBySide(plan);
    std::vector<float> depths(static_cast<size_t>(layout.width) * layout.height, 0.0f);
    const auto is_lit = [](int map) { return map % 2 == 0; };
    for (size_t k = 0; k < plan.maps.size(); ++k) {
      for (int y = 0; y < layout.height; ++y) {
        // Beyond a map's last row there is the other answer as well.
        const bool lit = is_lit(static_cast<int>(k)) == (y < plan.maps[k].size.height);
        float* row = &depths[static_cast<size_t>(y) * layout.width + layout.offsets[k].x()];
        std::fill(row, row + plan.maps[k].size.width, lit ? 1.0f : 0.0f);
      }
    }
    const DepthTexture atlas(layout.width, layout.height, depths.data(), {.blends = true});
    const std::vector<ShaderPoint> points = PointsInCube(random, 20000);
    for (const double guard_texels : {0.5, 0.0}) {
      const auto uniforms = MakePlanUniforms(plan, light, guard_texels, layout.offsets);
      ASSERT_THAT(uniforms, IsOk());
      const ShaderLights found = LightsOf(program_, *uniforms, atlas, points);
      for (size_t i = 0; i < points.size(); ++i) {
        const int map = static_cast<int>(found.places[i].map);
        // At depth 0 nothing is dark.
        if (map < 0 || found.places[i].depth == 0.0f) continue;
        const float own = is_lit(map) ? 1.0f : 0.0f;
        if (guard_texels > 0.0) {
          ASSERT_EQ(found.lights[i], own) << found.places[i].u << ", " << found.places[i].v;
          ++num_asked;
        } else {
          num_mixed_without += found.lights[i] != own ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(num_asked, 10000);
  EXPECT_GT(num_mixed_without, 10);
}

Eigen::Vector3d Towards(const Light& light, const Eigen::Vector3d& receiver) {
  constexpr double kSunWay = 5.0;  // world units
  if (light.kind == Light::Kind::kPoint) return 0.5 * (light.position + receiver);
  return receiver - kSunWay * light.direction.normalized();
}

// Shadow nearly everywhere, as indoors: lights reach a rectangle of the screen at most.
void DarkenButOneWindow(SyntheticReadback& readback) {
  const int width = readback.camera.width, height = readback.camera.height;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool is_window =
          std::abs(2 * x - width) < width / 3 && std::abs(2 * y - height) < height / 3;
      if (!is_window) readback.shadow_bits[static_cast<size_t>(y) * width + x] = ~uint32_t{0};
    }
  }
}

// The example of the page: a caster on the ray of every other receiver, drawn as a point into every
// map. Its receivers are dark; others are lit, but for those in a texel with a caster.
TEST_F(PlanAtlas, WhatTheExampleDrawsIsFound) {
  // Rasterisers round a point's place to 1/256 of a texel.
  constexpr double kTexelRounding = 0.01;
  int num_dark = 0, num_lit = 0, num_several = 0, num_dark_borders = 0, num_lit_borders = 0;
  for (uint64_t seed = 1; seed <= 2; ++seed) {
    TestScene scene(seed, 3, 72, 48);
    if (seed == 2) DarkenButOneWindow(scene.readback);
    const Readback readback = scene.readback.ViewWithFacing();
    const absl::StatusOr<std::vector<Eigen::Vector3d>> receivers = ReceiverPositions(readback);
    ASSERT_THAT(receivers, IsOk());
    for (const Light& light : scene.lights) {
      std::vector<ShaderPoint> points, casters;
      for (const Eigen::Vector3d& receiver : *receivers) {
        points.push_back(receiver.cast<float>().homogeneous());
        if (points.size() % 2 == 0) {
          casters.push_back(Towards(light, receiver).cast<float>().homogeneous());
        }
      }
      GlAtlas atlas(casters);
      ASSERT_THAT(testing::DrawPlan(readback, light, atlas), IsOk()) << light.name;
      const ShaderLights found = LightsOf(program_, atlas.uniforms(), atlas.texture(), points);
      num_several += atlas.plan().maps.size() > 1 ? 1 : 0;
      const bool is_dark_border = atlas.plan().border == Border::kDark;
      ++(is_dark_border ? num_dark_borders : num_lit_borders);

      std::set<std::tuple<int, int, int>> drawn;  // map, texel; a caster's neighbours as well
      for (size_t k = 0; k < atlas.plan().maps.size(); ++k) {
        const PlanMap& map = atlas.plan().maps[k];
        for (const ShaderPoint& caster : casters) {
          const Eigen::Vector4d at = map.map_from_world * caster.cast<double>();
          if (!(at.w() > 0.0)) continue;
          const int u = static_cast<int>(std::floor(at.x() / at.w()));
          const int v = static_cast<int>(std::floor(at.y() / at.w()));
          for (int i = -1; i <= 1; ++i) {
            for (int j = -1; j <= 1; ++j) drawn.emplace(static_cast<int>(k), u + i, v + j);
          }
        }
      }
      for (size_t i = 0; i < points.size(); ++i) {
        const ShaderPlace& place = found.places[i];
        if (place.map < 0 || DistanceFromTexelSide(place) < kTexelRounding) continue;
        const bool has_caster = i % 2 == 1;
        const std::tuple<int, int, int> texel(
            static_cast<int>(place.map), static_cast<int>(place.u), static_cast<int>(place.v));
        // What the border answers rightly may be nearer than the near plane, or beyond the far one,
        // where casters are as near and nothing is as far.
        if (place.depth == (is_dark_border ? 1.0f : 0.0f) && has_caster == !is_dark_border)
          continue;
        if (has_caster) {
          ASSERT_EQ(found.lights[i], 0.0f) << light.name << " receiver " << i;
          ++num_dark;
        } else if (drawn.count(texel) == 0) {
          ASSERT_EQ(found.lights[i], 1.0f) << light.name << " receiver " << i;
          ++num_lit;
        }
      }
    }
  }
  std::printf(
      "%d receivers behind a caster, %d beside all of them; %d plans of several maps, "
      "%d with a lit border, %d with a dark one\n",
      num_dark,
      num_lit,
      num_several,
      num_lit_borders,
      num_dark_borders);
  EXPECT_GT(num_dark, 1000);
  EXPECT_GT(num_lit, 100);
  EXPECT_GT(num_several, 0);
  EXPECT_GT(num_dark_borders, 0);
  EXPECT_GT(num_lit_borders, 0);
}

}  // namespace
}  // namespace lightfit
