#include "render/surface_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/readback_image.h"
#include "tests/render/testing.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::Random;
using testing::StatusIs;

Camera ViewOfFloor(int width, int height) {
  return *LookAtCamera({1, -12, 3}, {0, 0, 1}, Eigen::Vector3d::UnitZ(), 1.0, width, height);
}

Camera Orthographic(int width, int height) {
  Camera camera = ViewOfFloor(width, height);
  camera.orthographic = true;
  camera.screen_from_camera << 10, 0, 0.5 * width, 0, 10, 0.5 * height, 0, 0, 1;
  return camera;
}

TEST(RenderSurfaces, DepthOfAPlaneIsExact) {
  Scene scene;
  testing::AddFloor(1000.0, &scene);
  const RayCaster caster = testing::Caster(scene);
  for (const Camera& camera : {ViewOfFloor(40, 30), Orthographic(40, 30)}) {
    const auto image = RenderSurfaces(caster, camera);
    ASSERT_THAT(image, testing::IsOk());
    EXPECT_GT(image->num_surface, 300);
    const Eigen::Matrix4d screen_from_world = camera.ScreenFromWorld();
    int64_t num_surface = 0;
    for (int y = 0; y < 30; ++y) {
      for (int x = 0; x < 40; ++x) {
        const SurfacePoint& pixel = image->pixels[40 * y + x];
        if (!pixel.is_surface()) continue;
        ++num_surface;
        EXPECT_NEAR(pixel.position.z(), 0.0, 1e-11 * pixel.camera_z);
        EXPECT_NEAR(pixel.normal.z(), 1.0, 1e-12);  // towards the eye
        const Eigen::Vector4d screen = screen_from_world * pixel.position.homogeneous();
        EXPECT_NEAR(screen.x() / screen.w(), x + 0.5, 1e-9);
        EXPECT_NEAR(screen.y() / screen.w(), y + 0.5, 1e-9);
        const double depth = camera.orthographic ? pixel.camera_z : 1.0 / pixel.camera_z;
        EXPECT_NEAR(screen.z() / screen.w(), depth, 1e-11 * std::abs(depth));
      }
    }
    EXPECT_EQ(num_surface, image->num_surface);
  }
}

TEST(RenderSurfaces, AgreesWithAnalyticBoxes) {
  const BoxScene boxes = MakeBoxScene(31);
  const RayCaster caster = testing::Caster(testing::SceneOf(boxes));
  const Camera camera = RandomCamera(boxes, 31, 160, 120);
  const SyntheticReadback expected = Render(boxes, camera, {});
  const auto image = RenderSurfaces(caster, camera);
  ASSERT_THAT(image, testing::IsOk());
  int num_different = 0;
  for (size_t i = 0; i < image->pixels.size(); ++i) {
    const double depth = image->pixels[i].is_surface() ? image->pixels[i].camera_z : 1e10;
    // Corners are rounded to single precision: 1e-6 of 20 metres, more along the view.
    if (testing::RelativeError(depth, expected.depth[i]) > 1e-4) ++num_different;
  }
  EXPECT_GT(image->num_surface, 5000);
  EXPECT_LE(num_different, 10);  // of 19200: pixels on an edge
}

TEST(RenderSurfaces, NothingInViewIsAResult) {
  Scene scene;
  testing::AddFloor(1.0, &scene);
  const RayCaster caster = testing::Caster(scene);
  const auto image = RenderSurfaces(
      caster, *LookAtCamera({0, 0, 5}, {0, 1, 9}, Eigen::Vector3d::UnitZ(), 1.0, 20, 10));
  ASSERT_THAT(image, testing::IsOk());
  EXPECT_EQ(image->num_surface, 0);
  EXPECT_EQ(image->pixels.size(), 200u);
}

TEST(RenderSurfaces, RefusesBadCameras) {
  Scene scene;
  testing::AddFloor(1.0, &scene);
  const RayCaster caster = testing::Caster(scene);
  Camera camera = ViewOfFloor(20, 10);
  camera.width = 0;
  EXPECT_THAT(RenderSurfaces(caster, camera),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("camera")));
  camera = ViewOfFloor(20, 10);
  camera.camera_from_world(0, 3) = std::nan("");
  EXPECT_THAT(RenderSurfaces(caster, camera),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("camera")));
}

TEST(RenderReadback, HoldsDepthAndTheBitOfEachLight) {
  const BoxScene boxes = MakeBoxScene(32);
  const RayCaster caster = testing::Caster(testing::SceneOf(boxes));
  const Camera camera = RandomCamera(boxes, 32, 96, 64);
  std::vector<Light> lights = RandomLights(boxes, 32, 3);
  lights[1].shadow_bit = 31;
  const auto readback = RenderReadback(caster, camera, lights);
  ASSERT_THAT(readback, testing::IsOk());
  ASSERT_THAT(ValidateReadback(readback->View()), testing::IsOk());
  const auto image = RenderSurfaces(caster, camera);
  ASSERT_THAT(image, testing::IsOk());
  uint32_t seen = 0;
  for (const Light& light : lights) {
    const std::vector<Lighting> lighting = TrueLighting(caster, *image, light);
    for (size_t i = 0; i < lighting.size(); ++i) {
      EXPECT_EQ(readback->shadow_bits[i] >> light.shadow_bit & 1U,
                lighting[i] == Lighting::kShadowed ? 1U : 0U);
      EXPECT_EQ(readback->facing_bits[i] >> light.shadow_bit & 1U,
                lighting[i] == Lighting::kShadowed || lighting[i] == Lighting::kLit ? 1U : 0U);
      seen |= readback->facing_bits[i];
    }
    EXPECT_TRUE(readback->View().KnowsFacing(light.shadow_bit));
  }
  const uint32_t used = 1U | 1U << 31 | 1U << lights[2].shadow_bit;
  EXPECT_EQ(seen, used);
  EXPECT_EQ(readback->facing_lights, used);
  for (size_t i = 0; i < image->pixels.size(); ++i) {
    EXPECT_EQ(readback->depth[i],
              image->pixels[i].is_surface() ? static_cast<float>(image->pixels[i].camera_z)
                                            : kReadbackBackground);
  }
  lights[0].shadow_bit = 32;
  EXPECT_THAT(RenderReadback(caster, camera, lights),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("shadow_bit")));
}

}  // namespace
}  // namespace lightfit
