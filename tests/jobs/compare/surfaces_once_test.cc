// The pass over all pixels is made once for a read-back, whatever is asked of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "jobs/compare/rows.h"
#include "jobs/compare/stage.h"
#include "optimizer/readback/surfaces.h"
#include "tests/jobs/compare/compare_scene.h"
#include "tests/testing/matchers.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using testing::IsOk;
using testing::TestScene;

TEST(SurfacesOnce, InAComparisonOfAllMethodsOnAllLightsOfAReadback) {
  const TestScene scene(/*seed=*/7, /*num_lights=*/3);
  const int64_t before = NumSurfacesFound();
  const absl::StatusOr<CompareStage> stage = MakeStage(scene.View());
  ASSERT_THAT(stage, IsOk());
  for (const Light& light : scene.lights) CompareMaps(*stage, light, CompareOptions());
  EXPECT_EQ(NumSurfacesFound() - before, 1);
}

// A scene's read-back is rendered for each light, and so is another one for each.
TEST(SurfacesOnce, ForEachLightOfAScene) {
  absl::StatusOr<RayCaster> caster = RayCaster::Build(BoxesOnFloor());
  ASSERT_THAT(caster, IsOk());
  const absl::StatusOr<Camera> camera =
      LookAtCamera({0, 3, 12}, {0, 0.5, 0}, {0, 1, 0}, 1.0, 120, 90);
  ASSERT_THAT(camera, IsOk());
  const absl::StatusOr<CompareStage> stage = MakeStage(*caster, *camera, 64, 48);
  ASSERT_THAT(stage, IsOk());
  const int64_t before = NumSurfacesFound();
  CompareMaps(*stage, Light::Directional("sun", {0.4, -1.0, 0.2}), CompareOptions());
  EXPECT_EQ(NumSurfacesFound() - before, 1);
}

}  // namespace
}  // namespace lightfit
