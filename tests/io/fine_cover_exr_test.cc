// A finer image of a read-back, against the same file read as a read-back of its own.
#include "io/fine_cover_exr.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstdio>
#include <string>
#include <vector>

#include "io/readback_exr.h"
#include "io/readback_exr_write.h"
#include "tests/io/testing.h"
#include "tests/testing/box_scene.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::HasAll;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::IsOk;
using testing::Random;
using testing::StatusIs;

constexpr int kWidth = 48, kHeight = 32;

Camera Resized(Camera camera, int width, int height) {
  camera.screen_from_camera.row(0) *= static_cast<double>(width) / camera.width;
  camera.screen_from_camera.row(1) *= static_cast<double>(height) / camera.height;
  camera.width = width;
  camera.height = height;
  return camera;
}

// A random scene as files: a read-back, and finer images of it to choose from.
struct Files {
  BoxScene scene;
  std::vector<Light> lights;
  Camera camera;
  testing::TemporaryFolder folder;
  ReadbackFile readback;

  explicit Files(uint64_t seed, bool orthographic = false) : scene(MakeBoxScene(seed)) {
    lights = RandomLights(scene, seed, 3);
    camera = RandomCamera(scene, seed, kWidth, kHeight);
    if (orthographic) {
      camera.orthographic = true;
      camera.screen_from_camera << 4.0, 0.0, 0.5 * kWidth, 0.0, -4.0, 0.5 * kHeight, 0.0, 0.0, 1.0;
    }
    Write("coarse.exr", camera);
    readback = *ReadReadbackExr(folder.File("coarse.exr"), lights);
  }

  // With the third state of the lights that have a bit in `facing_lights`.
  std::string Write(const std::string& name,
                    const Camera& of,
                    uint32_t facing_lights = ~uint32_t{0}) const {
    const SyntheticReadback image = Render(scene, of, lights);
    Readback view = image.ViewWithFacing();
    view.facing_lights = facing_lights;
    if (facing_lights == 0) view.facing_bits = {};
    EXPECT_THAT(WriteReadbackExr(folder.File(name), view, lights), IsOk());
    return folder.File(name);
  }

  absl::StatusOr<FineCoverFile> Read(const std::string& path,
                                     const ReadbackExrOptions& options = {}) const {
    return ReadFineCoverExr(path, lights, options, readback);
  }
};

TEST(ReadFineCoverExr, HasTheBitsAndDepthsOfTheFile) {
  int num_seeds = 0;
  for (uint64_t seed = 1; seed <= 8; ++seed) {
    Random random(seed);
    const Files files(seed, /*orthographic=*/seed % 4 == 0);
    // Not of one proportion: cells need not be square.
    const int width = kWidth * random.Int(2, 4), height = kHeight + random.Int(1, 70);
    const uint32_t facing_lights = seed % 3 == 0 ? 0u : seed % 3 == 1 ? 7u : 5u;
    const std::string path =
        files.Write("fine.exr", Resized(files.camera, width, height), facing_lights);
    const auto fine = files.Read(path);
    ASSERT_THAT(fine, IsOk());
    const auto file = ReadReadbackExr(path, files.lights);
    ASSERT_THAT(file, IsOk());
    EXPECT_EQ(fine->columns, width);
    EXPECT_EQ(fine->rows, height);
    EXPECT_EQ(fine->depth, file->depth);
    ASSERT_EQ(fine->shadow_bits.size(), file->shadow_bits.size());
    ASSERT_EQ(fine->lit_bits.size(), facing_lights == 0 ? 0u : file->shadow_bits.size());
    uint32_t seen_shadow = 0, seen_lit = 0, seen_turned = 0;
    for (size_t i = 0; i < file->depth.size(); ++i) {
      uint32_t shadow = 0, lit = 0;
      for (const Light& light : files.lights) {
        const uint32_t bit = uint32_t{1} << light.shadow_bit;
        const bool is_known = (facing_lights & bit) != 0;
        const bool faces = is_known && (file->facing_bits[i] & bit) != 0;
        const bool is_blocked = (file->shadow_bits[i] & bit) != 0;
        if (is_blocked && (faces || !is_known)) shadow |= bit;
        if (!is_blocked && faces) lit |= bit;
        if (is_blocked && is_known && !faces) seen_turned |= bit;
      }
      ASSERT_EQ(fine->shadow_bits[i], shadow) << "pixel " << i << ", seed " << seed;
      if (!fine->lit_bits.empty()) {
        ASSERT_EQ(fine->lit_bits[i], lit) << "pixel " << i << ", seed " << seed;
      }
      seen_shadow |= shadow;
      seen_lit |= lit;
    }
    EXPECT_EQ(seen_shadow, 7u);
    EXPECT_EQ(seen_lit, facing_lights);
    num_seeds += seen_turned != 0 ? 1 : 0;

    // And it goes with the read-back.
    const FineCover view = fine->View();
    Readback readback = files.readback.View();
    readback.fine_cover = &view;
    EXPECT_THAT(ValidateReadback(readback), IsOk());
    EXPECT_EQ(view.nearest.data(), fine->depth.data());
    EXPECT_THAT(view.furthest, IsEmpty());
  }
  EXPECT_GE(num_seeds, 3);
}

TEST(ReadFineCoverExr, RefusesWhatIsNotLarger) {
  const Files files(1);
  for (const auto& [width, height] : {std::pair(kWidth, kHeight),
                                      {kWidth / 2, kHeight / 2},
                                      {2 * kWidth, kHeight},
                                      {kWidth, 2 * kHeight},
                                      {kWidth - 1, kHeight + 1}}) {
    const std::string path = files.Write("fine.exr", Resized(files.camera, width, height));
    const auto fine = files.Read(path);
    EXPECT_EQ(fine.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_TRUE(HasAll(fine.status().message(),
                       {path,
                        std::to_string(width) + " x " + std::to_string(height) + " pixels",
                        "more than the read-back's 48 x 32"}));
  }
  EXPECT_THAT(files.Read(files.Write("fine.exr", Resized(files.camera, kWidth + 1, kHeight + 1))),
              IsOk());
}

// By half a pixel and more in any way; what single precision loses is no difference.
TEST(ReadFineCoverExr, RefusesACameraThatSeesAnotherView) {
  for (const bool orthographic : {false, true}) {
    const Files files(2, orthographic);
    const Camera same = Resized(files.camera, 3 * kWidth, 3 * kHeight);
    const auto refused = StatusIs(absl::StatusCode::kInvalidArgument,
                                  HasSubstr("fine.exr: its camera sees another view"));
    std::vector<Camera> others(5, same);
    others[0].screen_from_camera(0, 2) += 0.5;
    others[1].screen_from_camera.row(1) *= 1.02;
    others[2].camera_from_world(0, 3) += 0.5;
    others[3].camera_from_world =
        (Eigen::Affine3d(Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitY())).matrix() *
         same.camera_from_world)
            .eval();
    others[4] = Resized(RandomCamera(files.scene, 77, kWidth, kHeight), 3 * kWidth, 3 * kHeight);
    for (size_t i = 0; i < others.size(); ++i) {
      SCOPED_TRACE(i);
      const std::string path = files.Write("fine.exr", others[i]);
      EXPECT_THAT(files.Read(path), refused);
      // Who states the camera knows better than the file.
      ReadbackExrOptions stated;
      stated.camera = files.camera;
      EXPECT_THAT(files.Read(path, stated), IsOk());
    }
    Camera rounded = same;
    rounded.camera_from_world = same.camera_from_world.cast<float>().cast<double>();
    EXPECT_THAT(files.Read(files.Write("fine.exr", rounded)), IsOk());
  }
}

TEST(ReadFineCoverExr, ALightWithoutChannelsHasNothingThere) {
  const Files files(3);
  const Camera camera = Resized(files.camera, 2 * kWidth, 2 * kHeight);
  const SyntheticReadback image = Render(files.scene, camera, files.lights);
  const std::string path = files.folder.File("fine.exr");
  const std::vector<Light> two = {files.lights[0], files.lights[2]};
  ASSERT_THAT(WriteReadbackExr(path, image.ViewWithFacing(), two), IsOk());
  const auto fine = files.Read(path);
  ASSERT_THAT(fine, IsOk());
  uint32_t seen_shadow = 0, seen_lit = 0;
  for (size_t i = 0; i < fine->depth.size(); ++i) {
    seen_shadow |= fine->shadow_bits[i];
    seen_lit |= fine->lit_bits[i];
  }
  EXPECT_EQ(seen_shadow, 5u);
  EXPECT_EQ(seen_lit, 5u);
}

TEST(ReadFineCoverExr, NamesAFileThatIsNotThere) {
  const Files files(4);
  EXPECT_THAT(files.Read(files.folder.File("none.exr")),
              StatusIs(absl::StatusCode::kNotFound, HasSubstr("none.exr")));
}

}  // namespace
}  // namespace lightfit
