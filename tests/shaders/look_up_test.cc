// The look-up of docs/plans.md, run as a shader, beside PlanLookUp.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "geometry/affine_depth.h"
#include "partition/plan.h"
#include "partition/plan_uniforms.h"
#include "tests/partition/random_plan.h"
#include "tests/shaders/gl.h"
#include "tests/shaders/plan_shader.h"
#include "tests/shaders/plans_example.h"
#include "tests/testing/matchers.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using testing::IsOk;
using testing::LinkGlslLookUp;
using testing::LinkHlslLookUp;
using testing::PlacesOf;
using testing::Random;
using testing::RandomPlan;
using testing::RandomPlanLight;
using testing::ShaderPlace;
using testing::ShaderPoint;
using testing::TestScene;

// How a shader's maps differ from the look-up's, and how far single precision may lead it.
struct Differences {
  // Single precision knows some seven digits of q,
  static constexpr double kSameCoarseness = 1e-6;
  // and five or six of a texel's coordinate, whose terms cancel: of 1024, texels,
  static constexpr double kSameTexel = 5e-3;
  // or of a depth.
  static constexpr double kSameDepth = 1e-5;

  int64_t points = 0, in_a_map = 0;
  int64_t by_coarseness = 0, by_side = 0, unexplained = 0;
  double worst_texel = 0.0, worst_depth = 0.0;
  double worst_coarseness = 0.0, worst_side = 0.0;  // of the explained

  void Print(const std::string& what) const {
    std::printf(
        "%s: %lld points, %lld in a map; another map than the look-up's at %lld between equals "
        "(%.1e of q at most) and %lld on a side (%.1e texels at most); texels within %.1e, "
        "depths within %.1e\n",
        what.c_str(),
        static_cast<long long>(points),
        static_cast<long long>(in_a_map),
        static_cast<long long>(by_coarseness),
        worst_coarseness,
        static_cast<long long>(by_side),
        worst_side,
        worst_texel,
        worst_depth);
  }
};

class Reference {
 public:
  Reference(const Plan& plan, const Light& light, double guard_texels)
      : plan_(plan),
        guard_texels_(guard_texels),
        look_up_(*PlanLookUp::Create(plan, light, guard_texels)) {}

  const PlanLookUp& look_up() const { return look_up_; }

  void Compare(const std::vector<ShaderPoint>& points,
               const std::vector<ShaderPlace>& places,
               Differences& to) const {
    for (size_t i = 0; i < points.size(); ++i) Compare(points[i], places[i], to);
  }

 private:
  void Compare(const ShaderPoint& point, const ShaderPlace& place, Differences& to) const {
    const Eigen::Vector3d world = point.head<3>().cast<double>();
    const PlanPlace want = look_up_.At(world);
    const int map = static_cast<int>(place.map);
    ++to.points;
    to.in_a_map += want.map >= 0 ? 1 : 0;
    if (map == want.map) {
      if (map < 0) return;
      const Eigen::Vector2d off = Eigen::Vector2d(place.u, place.v) - want.texel;
      to.worst_texel = std::max(to.worst_texel, off.cwiseAbs().maxCoeff());
      to.worst_depth = std::max(to.worst_depth, std::abs(place.depth - DepthOf(map, world)));
      return;
    }
    const double side = std::min(DistanceFromSide(map, world), DistanceFromSide(want.map, world));
    if (map >= 0 && want.map >= 0) {
      const double q = look_up_.CoarsenessOf(map, world);
      const double want_q = look_up_.CoarsenessOf(want.map, world);
      const double difference = std::abs(q - want_q) / std::max(std::abs(q), std::abs(want_q));
      if (difference < Differences::kSameCoarseness) {
        ++to.by_coarseness;
        to.worst_coarseness = std::max(to.worst_coarseness, difference);
        return;
      }
    }
    if (side < Differences::kSameTexel) {
      ++to.by_side;
      to.worst_side = std::max(to.worst_side, side);
      return;
    }
    constexpr int kNumSaid = 3;
    if (++to.unexplained > kNumSaid) return;
    ADD_FAILURE() << "at (" << world.transpose() << ") the shader asks map " << map << ", want "
                  << want.map << "; " << side << " texels from a side";
  }

  double DepthOf(int map, const Eigen::Vector3d& world) const {
    const Eigen::Vector4d at = plan_.maps[map].map_from_world * world.homogeneous();
    return std::clamp(at.z() / at.w(), 0.0, 1.0);
  }

  // Texels; infinite for no map.
  double DistanceFromSide(int map, const Eigen::Vector3d& world) const {
    if (map < 0) return std::numeric_limits<double>::infinity();
    const Eigen::Vector4d at = plan_.maps[map].map_from_world * world.homogeneous();
    const Eigen::Array2d texel = at.head<2>() / at.w();
    const Eigen::Array2d size(plan_.maps[map].size.width, plan_.maps[map].size.height);
    return std::min((texel - guard_texels_).abs().minCoeff(),
                    (size - guard_texels_ - texel).abs().minCoeff());
  }

  const Plan& plan_;
  double guard_texels_;
  PlanLookUp look_up_;
};

// A point on the border between what is looked up at `inside` and what at `outside`.
Eigen::Vector3d BorderBetween(const PlanLookUp& look_up,
                              Eigen::Vector3d inside,
                              Eigen::Vector3d outside) {
  constexpr int kHalvings = 40;
  const int map = look_up.At(inside).map;
  for (int i = 0; i < kHalvings; ++i) {
    const Eigen::Vector3d middle = 0.5 * (inside + outside);
    (look_up.At(middle).map == map ? inside : outside) = middle;
  }
  return inside;
}

// Where single precision has a hard time: on the borders of maps, of their rectangles and of each
// other, between `points` that follow each other.
std::vector<ShaderPoint> PointsOnBorders(const PlanLookUp& look_up,
                                         const std::vector<ShaderPoint>& points,
                                         size_t num_points) {
  std::vector<ShaderPoint> on_borders;
  for (size_t i = 1; i < points.size() && on_borders.size() < num_points; ++i) {
    const Eigen::Vector3d from = points[i - 1].head<3>().cast<double>();
    const Eigen::Vector3d to = points[i].head<3>().cast<double>();
    if (look_up.At(from).map == look_up.At(to).map) continue;
    on_borders.push_back(BorderBetween(look_up, from, to).cast<float>().homogeneous());
  }
  return on_borders;
}

// An engine's atlas that is never drawn.
struct NoAtlas {
  Plan plan;
  PlanUniforms uniforms;

  std::vector<Eigen::Vector2i> Place(const Plan& placed) {
    plan = placed;
    return std::vector<Eigen::Vector2i>(placed.maps.size(), Eigen::Vector2i::Zero());
  }
  void Draw(const Eigen::Vector2i&, MapSize, const Eigen::Matrix4d&) {}
  void Upload(const void* data, size_t bytes) { std::memcpy(&uniforms, data, bytes); }
};

// All programs on the same points.
class PlanShader : public testing::GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (HasFatalFailure()) return;
    programs_ = {{"GLSL", LinkGlslLookUp()}, {"HLSL", LinkHlslLookUp()}};
    for (Program& program : programs_) ASSERT_NE(program.name, 0u);
  }
  void TearDown() override {
    for (const Program& program : programs_) glDeleteProgram(program.name);
    GlTest::TearDown();
  }

  void Compare(const Plan& plan,
               const Light& light,
               double guard_texels,
               const PlanUniforms& uniforms,
               const std::vector<ShaderPoint>& points) {
    const Reference reference(plan, light, guard_texels);
    const std::vector<ShaderPoint> on_borders =
        PointsOnBorders(reference.look_up(), points, kBordersOfAPlan);
    for (Program& program : programs_) {
      reference.Compare(points, PlacesOf(program.name, uniforms, points), program.anywhere);
      reference.Compare(
          on_borders, PlacesOf(program.name, uniforms, on_borders), program.on_borders);
    }
  }

  void ExpectNoneUnexplained() {
    for (const Program& program : programs_) {
      program.anywhere.Print(program.language + ", anywhere");
      program.on_borders.Print(program.language + ", on borders");
      for (const Differences& differences : {program.anywhere, program.on_borders}) {
        EXPECT_EQ(differences.unexplained, 0);
        EXPECT_LT(differences.worst_texel, Differences::kSameTexel);
        EXPECT_LT(differences.worst_depth, Differences::kSameDepth);
        EXPECT_GT(differences.in_a_map, differences.points / 5);
      }
    }
  }

 private:
  static constexpr size_t kBordersOfAPlan = 500;

  struct Program {
    std::string language;
    GLuint name = 0;
    Differences anywhere = {}, on_borders = {};
  };
  std::vector<Program> programs_;
};

TEST_F(PlanShader, AsksTheMapThatTheLookUpAsksOfRandomPlans) {
  constexpr int kNumPlans = 40, kNumPoints = 18000;
  for (int seed = 1; seed <= kNumPlans; ++seed) {
    Random random(seed);
    const Light light = RandomPlanLight(random);
    const Plan plan = RandomPlan(light, random);
    const double guard_texels = random.Coin() ? 0.0 : 1.5;
    const auto uniforms = MakePlanUniforms(plan, light, guard_texels);
    ASSERT_THAT(uniforms, IsOk());
    std::vector<ShaderPoint> points;
    for (int i = 0; i < kNumPoints; ++i) {
      points.push_back(random.InCube(4.0).cast<float>().homogeneous());
    }
    Compare(plan, light, guard_texels, *uniforms, points);
  }
  ExpectNoneUnexplained();
}

// Receivers of a read-back, each pixel at a few places, and points all around them.
std::vector<ShaderPoint> ReceiversAndOthers(const Readback& readback, Random& random) {
  constexpr int kPlacesOfAPixel = 14;
  const AffineDepth affine_depth(readback.camera, readback.depth_kind);
  const Eigen::Matrix4d world_from_screen = readback.camera.WorldFromScreen();
  std::vector<ShaderPoint> points;
  for (int y = 0; y < readback.height(); ++y) {
    for (int x = 0; x < readback.width(); ++x) {
      const double depth = readback.depth[readback.Index(x, y)];
      if (!affine_depth.IsSurface(depth)) continue;
      const double d = affine_depth.At(x, y, depth);
      for (int i = 0; i < kPlacesOfAPixel; ++i) {
        const Eigen::Vector4d screen(
            x + random.Uniform(0.0, 1.0), y + random.Uniform(0.0, 1.0), d, 1.0);
        const Eigen::Vector3d world = (world_from_screen * screen).hnormalized();
        points.push_back(world.cast<float>().homogeneous());
      }
      points.push_back(random.InCube(30.0).cast<float>().homogeneous());
    }
  }
  return points;
}

TEST_F(PlanShader, AsksTheMapThatTheLookUpAsksOfFittedPlans) {
  int num_maps = 0;
  for (uint64_t seed = 1; seed <= 2; ++seed) {
    Random random(seed);
    const TestScene scene(seed, 3);
    const Readback readback = scene.readback.ViewWithFacing();
    const std::vector<ShaderPoint> points = ReceiversAndOthers(readback, random);
    for (const Light& light : scene.lights) {
      NoAtlas atlas;
      ASSERT_THAT(testing::DrawPlan(readback, light, atlas), IsOk()) << light.name;
      num_maps += static_cast<int>(atlas.plan.maps.size());
      Compare(atlas.plan, light, testing::kExampleGuardTexels, atlas.uniforms, points);
    }
  }
  EXPECT_GT(num_maps, 12);  // of 6 lights: several each
  ExpectNoneUnexplained();
}

}  // namespace
}  // namespace lightfit
