// A frame loop's optimizer takes nothing from the heap once its pool has seen the work.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <vector>

#include "base/scratch.h"
#include "optimizer/evaluate.h"
#include "optimizer/fit.h"
#include "optimizer/tracking/tracker.h"
#include "tests/testing/allocation_counter.h"
#include "tests/testing/box_scene.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using testing::NumAllocations;
using testing::TestScene;

constexpr MapSize kMap = {1024, 512};
constexpr int kNumLights = 6;  // suns, near and far points
constexpr int kNumRounds = 4;

struct Choice {
  const char* name;
  FitOptions options;
};

std::vector<Choice> Choices() {
  FitOptions refined;
  refined.search = Search::kRotationLineSearchRefined;
  refined.affine = Affine::kSkewedRectangle;
  return {{"default", {}},
          {"squared", testing::SquaredFootprints()},
          {"as published", FitOptions::AsPublished()},
          {"refined", refined}};
}

// A read-back in which every light can be fitted: an error's message is allocated.
TestScene SceneForAllLights(const FitOptions& options) {
  for (uint64_t seed = 1; seed < 100; ++seed) {
    TestScene scene(seed, kNumLights);
    const LightMatrices matrices = FitLights(scene.View(), scene.lights, kMap, options);
    if (std::all_of(matrices.begin(), matrices.end(), [](const auto& m) { return m.ok(); })) {
      std::printf("[   seed   ] %d\n", static_cast<int>(seed));
      return scene;
    }
  }
  ADD_FAILURE() << "no scene has shadows of all lights";
  return TestScene(1, kNumLights);
}

TEST(AllocationCounter, SeesWhatNewAndEigenTake) {
  const int64_t before = NumAllocations();
  const auto number = std::make_unique<int>(3);
  const int64_t after_new = NumAllocations();
  const Eigen::VectorXd numbers = Eigen::VectorXd::Constant(*number * 1000, 1.0);
  const int64_t after_eigen = NumAllocations();
  const ScratchVector<double> more(numbers.begin(), numbers.end());
  EXPECT_GT(after_new, before);
  EXPECT_GT(after_eigen, after_new);
  EXPECT_GT(NumAllocations(), after_eigen);
  EXPECT_EQ(more.size(), 3000u);
}

TEST(FitLights, AllocatesNothingFromAWarmPool) {
  for (const Choice& choice : Choices()) {
    SCOPED_TRACE(choice.name);
    TestScene scene = SceneForAllLights(choice.options);
    scene.lights[1].name = "a name of more than fifteen characters";
    const LightMatrices expected = FitLights(scene.View(), scene.lights, kMap, choice.options);
    ScratchPool pool;
    for (int round = 0; round < kNumRounds; ++round) {
      const ScratchScope scope(&pool);
      const int64_t before = NumAllocations();
      const LightMatrices matrices = FitLights(scene.View(), scene.lights, kMap, choice.options);
      const int64_t num_allocated = NumAllocations() - before;
      if (round == 0) {
        EXPECT_GT(num_allocated, 0);
      } else {
        EXPECT_EQ(num_allocated, 0) << "round " << round;
      }
      for (size_t i = 0; i < matrices.size(); ++i) {
        ASSERT_TRUE(matrices[i].ok()) << matrices[i].status();
        EXPECT_EQ(matrices[i]->map_from_world, expected[i]->map_from_world);
        EXPECT_EQ(matrices[i]->light_name, expected[i]->light_name);
        EXPECT_EQ(matrices[i]->figures.energy, expected[i]->figures.energy);
      }
    }
    std::printf("%s: %d blocks, %d KiB for %d lights\n",
                choice.name,
                static_cast<int>(pool.num_blocks()),
                static_cast<int>(pool.num_bytes() / 1024),
                kNumLights);
  }
}

// Results kept from frame to frame, as a renderer would, do not refer to the pool and reuse what
// they hold.
TEST(FitLights, ResultsCopiedOutOutliveThePool) {
  const TestScene scene = SceneForAllLights({});
  LightMatrices kept(scene.lights.size());
  Eigen::Matrix4d expected;
  {
    ScratchPool pool;
    for (int round = 0; round < kNumRounds; ++round) {
      const ScratchScope scope(&pool);
      const int64_t before = NumAllocations();
      const LightMatrices matrices = FitLights(scene.View(), scene.lights, kMap);
      for (size_t i = 0; i < matrices.size(); ++i) {
        // Where there was no matrix yet, one is made: outside of the pool.
        const ScratchScope outside(nullptr);
        kept[i] = matrices[i];
      }
      const int64_t num_allocated = NumAllocations() - before;
      if (round > 0) {
        EXPECT_EQ(num_allocated, 0) << "round " << round;
      }
      expected = matrices[0]->map_from_world;
    }
  }
  EXPECT_EQ(kept[0]->map_from_world, expected);
  for (const absl::StatusOr<LightMatrix>& matrix : kept) {
    EXPECT_EQ(matrix->search.trace.get_allocator().resource(), nullptr);
    EXPECT_EQ(matrix->search.trace.front().station, "start");
  }
}

TEST(EvaluateMatrix, AllocatesNothingFromAWarmPool) {
  const TestScene scene = SceneForAllLights({});
  const LightMatrices matrices = FitLights(scene.View(), scene.lights, kMap);
  ScratchPool pool;
  for (int round = 0; round < kNumRounds; ++round) {
    const ScratchScope scope(&pool);
    const int64_t before = NumAllocations();
    for (size_t i = 0; i < matrices.size(); ++i) {
      const absl::StatusOr<Figures> figures =
          EvaluateMatrix(scene.View(), scene.lights[i], matrices[i]->map_from_world, kMap);
      ASSERT_TRUE(figures.ok()) << figures.status();
      EXPECT_GT(figures->energy, 0.0);
    }
    const int64_t num_allocated = NumAllocations() - before;
    if (round > 0) {
      EXPECT_EQ(num_allocated, 0) << "round " << round;
    }
  }
}

// A camera that walks back and forth: matrices are kept, shifted and replaced.
TEST(Tracker, AllocatesNothingFromAWarmPool) {
  const BoxScene scene = MakeBoxScene(1);
  const std::vector<Light> lights = RandomLights(scene, 1, 3);
  const Camera first = RandomCamera(scene, 1, 96, 64);
  std::vector<SyntheticReadback> frames;
  for (const int place : {0, 1, 2, 3, 2, 1}) {
    Camera camera = first;
    camera.camera_from_world(0, 3) += 0.4 * place;
    frames.push_back(Render(scene, camera, lights));
  }
  for (const double stability : {0.0, 0.5, 1.0}) {
    Tracker tracker(TrackerOptions::ForStability(stability));
    ScratchPool pool;
    int64_t last_round = 0;
    int num_matrices = 0;
    for (int round = 0; round < 4; ++round) {
      last_round = 0;
      for (const SyntheticReadback& frame : frames) {
        const ScratchScope scope(&pool);
        const int64_t before = NumAllocations();
        const TrackedMatrices matrices = tracker.Update(frame.View(), lights, kMap);
        last_round += NumAllocations() - before;
        for (const auto& matrix : matrices) num_matrices += matrix.ok();
      }
    }
    EXPECT_EQ(last_round, 0) << "stability " << stability;
    EXPECT_GE(num_matrices, 48);
  }
}

}  // namespace
}  // namespace lightfit
