#include "io/readback_exr_write.h"

#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <random>

#include "io/readback_exr.h"
#include "tests/io/testing.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;

constexpr int kWidth = 23, kHeight = 17;

// Random depths and bits behind a camera.
struct Case {
  Camera camera;
  std::vector<float> depth;
  std::vector<uint32_t> shadow_bits, facing_bits, mapped_bits;
  std::vector<Light> lights = {Light::Directional("sun", {1, 2, -3}, 0),
                               Light::Point("key.left", {4, 5, 6}, 7),
                               Light::Point("a light with spaces", {4, 5, 6}, 31)};

  explicit Case(const Camera& of) : camera(of) {
    std::mt19937 random(testing::kSeed);
    for (int i = 0; i < kWidth * kHeight; ++i) {
      depth.push_back(i % 5 == 0 ? 1e10F : std::ldexp(1.0F + random() * 0x1p-32F, i % 40 - 20));
      shadow_bits.push_back(random());
      facing_bits.push_back(random());
      mapped_bits.push_back(random());
    }
  }
  Readback View() const {
    Readback readback;
    readback.camera = camera;
    readback.depth = depth;
    readback.shadow_bits = shadow_bits;
    return readback;
  }
};

Camera FarCamera() {
  const Eigen::Vector3d eye(391.3, 2.5, -4217.7);
  return *LookAtCamera(
      eye, eye + Eigen::Vector3d(1, -0.3, 0.7), Eigen::Vector3d::UnitY(), 1.1, kWidth, kHeight);
}

std::vector<Camera> Cameras() {
  Camera mirrored = FarCamera();
  mirrored.screen_from_camera.col(0) *= -1.0;
  mirrored.camera_from_world.row(0) *= -1.0;
  Camera orthographic = FarCamera();
  orthographic.orthographic = true;
  orthographic.screen_from_camera << 3.3, 0, 11, 0, 3.3, 8, 0, 0, 1;
  Camera wide_pixels = FarCamera();
  wide_pixels.screen_from_camera(0, 0) *= 0.5;
  Camera shifted = FarCamera();
  shifted.screen_from_camera(0, 2) += 3.0;
  return {FarCamera(),
          testing::StandardCamera(kWidth, kHeight),
          mirrored,
          orthographic,
          wide_pixels,
          shifted};
}

TEST(WriteReadbackExr, ReadsBackAsItWas) {
  const TemporaryFolder folder;
  for (const Camera& camera : Cameras()) {
    const Case written(camera);
    const std::string path = folder.File("a.exr");
    ASSERT_EQ(WriteReadbackExr(path, written.View(), written.lights), absl::OkStatus());
    const auto file = ReadReadbackExr(path, written.lights);
    ASSERT_TRUE(file.ok()) << file.status();
    EXPECT_EQ(file->depth, written.depth);
    EXPECT_EQ(file->camera.orthographic, camera.orthographic);
    // Rounding of products with coordinates of 4e3.
    EXPECT_LE(testing::LargestScreenDifference(camera, file->camera), 1e-11);
    for (size_t l = 0; l < written.lights.size(); ++l) {
      EXPECT_EQ(file->light_status[l], absl::OkStatus());
    }
    const uint32_t used = 1U | 1U << 7 | 1U << 31;
    for (size_t i = 0; i < written.depth.size(); ++i) {
      EXPECT_EQ(file->shadow_bits[i], written.shadow_bits[i] & used);
    }
  }
}

// Those of the lights of which they are known.
TEST(WriteReadbackExr, OptionalBitsReadBackAsTheyWere) {
  const TemporaryFolder folder;
  const std::string path = folder.File("a.exr");
  const Case written(FarCamera());
  Readback readback = written.View();
  readback.facing_bits = written.facing_bits;
  readback.facing_lights = ~(1U << 7);
  readback.mapped_bits = written.mapped_bits;
  readback.mapped_lights = 1U << 7;
  ASSERT_EQ(WriteReadbackExr(path, readback, written.lights), absl::OkStatus());
  const auto file = ReadReadbackExr(path, written.lights);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->facing_lights, 1U | 1U << 31);
  EXPECT_EQ(file->mapped_lights, 1U << 7);
  for (size_t i = 0; i < written.depth.size(); ++i) {
    EXPECT_EQ(file->facing_bits[i], written.facing_bits[i] & (1U | 1U << 31));
    EXPECT_EQ(file->mapped_bits[i], written.mapped_bits[i] & 1U << 7);
  }
}

TEST(WriteReadbackExr, StandardAttributesAloneGiveTheCameraInSinglePrecision) {
  const Case written(FarCamera());
  const TemporaryFolder folder;
  const std::string path = folder.File("a.exr");
  ASSERT_EQ(WriteReadbackExr(path, written.View(), written.lights), absl::OkStatus());
  // Without the exact twins, as another program would see it.
  std::string bytes = testing::Bytes(path);
  int num_renamed = 0;
  for (const std::string name : {"lightfit.worldToCamera", "lightfit.worldToNDC"}) {
    const size_t place = bytes.find(name);
    if (place == std::string::npos) continue;
    bytes[place] = 'X';
    ++num_renamed;
  }
  ASSERT_EQ(num_renamed, 2);
  const auto file = ReadReadbackExr(folder.Write("b.exr", bytes), written.lights);
  ASSERT_TRUE(file.ok()) << file.status();
  const double difference = testing::LargestScreenDifference(written.camera, file->camera);
  EXPECT_LE(difference, 1e-3);
  EXPECT_GT(difference, 1e-9);
}

TEST(WriteReadbackExr, IsTheSameFileEveryTime) {
  const Case written(FarCamera());
  const TemporaryFolder folder;
  for (const char* name : {"a.exr", "b.exr"}) {
    ASSERT_EQ(WriteReadbackExr(folder.File(name), written.View(), written.lights),
              absl::OkStatus());
  }
  EXPECT_TRUE(testing::Bytes(folder.File("a.exr")) == testing::Bytes(folder.File("b.exr")));
  // Nor does the time go in.
  EXPECT_FALSE(Imf::hasCapDate(Imf::InputFile(folder.File("a.exr").c_str()).header()));
}

// Files of this process may not grow beyond `num_bytes`, as if the disk were full.
class FullDisk {
 public:
  explicit FullDisk(rlim_t num_bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit = {num_bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  void (*handler_)(int);
  rlimit before_ = {};
};

TEST(WriteReadbackExr, AFullDiskIsAnErrorAndLeavesTheOldFile) {
  const Case written(FarCamera());
  const TemporaryFolder folder;
  const std::string path = folder.File("a.exr");
  ASSERT_EQ(WriteReadbackExr(path, written.View(), written.lights), absl::OkStatus());
  const std::string whole = testing::Bytes(path);
  for (const size_t num_bytes : {size_t{0}, size_t{100}, whole.size() / 2, whole.size() - 1}) {
    absl::Status status;
    {
      const FullDisk full(num_bytes);
      status = WriteReadbackExr(path, written.View(), written.lights);
    }
    EXPECT_THAT(status.message(), HasSubstr("a.exr: cannot be written")) << num_bytes;
    EXPECT_TRUE(testing::Bytes(path) == whole) << num_bytes;
    EXPECT_EQ(folder.num_files(), 1u) << num_bytes;
  }
}

TEST(WriteReadbackExr, RefusesWhatTheFileCannotHold) {
  const TemporaryFolder folder;
  const Case good(FarCamera());
  const auto expect_refused = [&folder](const Case& bad, const std::string& words) {
    const absl::Status status = WriteReadbackExr(folder.File("a.exr"), bad.View(), bad.lights);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(status.message(), HasSubstr(words));
  };
  Case bad = good;
  bad.depth.pop_back();
  expect_refused(bad, "readback.depth");
  bad = good;
  bad.lights[1].name = "sun";
  expect_refused(bad, "light \"sun\"");
  bad = good;
  bad.lights[1].name = std::string(300, 'x');
  expect_refused(bad, "300 bytes");
  bad = good;
  bad.lights[1].shadow_bit = 32;
  expect_refused(bad, "shadow_bit");
  bad = good;
  bad.camera.screen_from_camera(0, 1) = 0.5;
  expect_refused(bad, "skew");
  Readback ndc = good.View();
  ndc.depth_kind = DepthKind::kDistance;
  EXPECT_THAT(WriteReadbackExr(folder.File("a.exr"), ndc, good.lights).message(),
              HasSubstr("depth_kind"));
  EXPECT_EQ(folder.num_files(), 0u);
  EXPECT_THAT(WriteReadbackExr(folder.File("no/such/a.exr"), good.View(), good.lights).message(),
              HasSubstr("a.exr"));
}

}  // namespace
}  // namespace lightfit
