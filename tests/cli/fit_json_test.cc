// The JSON file of `lightfit fit`: matrices that hold what they promise.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "geometry/clip.h"
#include "io/lights_file.h"
#include "io/readback_exr.h"
#include "optimizer/figures/footprint_image.h"
#include "tests/cli/examples.h"
#include "tests/cli/summaries.h"
#include "tests/testing/process.h"
#include "wire/light_proto.h"

namespace lightfit {
namespace {

// Matrices in the file read back exactly; products of them are rounded.
constexpr double kMatrixTolerance = 1e-12;

// Receivers lie inside a map that has a margin of 1 %; the corners of the hull come from tiles, so
// only rounding can put one outside. Texels.
constexpr double kCoverTolerance_texels = 1e-6;

std::vector<Eigen::Vector3d> ReceiversOf(const std::string& readback, const std::string& lights) {
  const absl::StatusOr<std::vector<Light>> light_list = ReadLightsFile(lights);
  EXPECT_TRUE(light_list.ok()) << light_list.status();
  const absl::StatusOr<ReadbackFile> file = ReadReadbackExr(readback, *light_list);
  EXPECT_TRUE(file.ok()) << file.status();
  const absl::StatusOr<std::vector<Eigen::Vector3d>> receivers = ReceiverPositions(file->View());
  EXPECT_TRUE(receivers.ok()) << receivers.status();
  return *receivers;
}

// Every receiver lands in the map, with w > 0 and depth in [0, 1].
TEST(FitJson, WritesMatricesThatCoverTheReceivers) {
  const TemporaryFolder folder;
  const std::string json = folder.Path("out.json");
  const ProcessResult result = RunLightfit({"fit",
                                            kYard,
                                            "--lights",
                                            kYardLights,
                                            "--map",
                                            "1024x512",
                                            "--cover",
                                            "receivers",
                                            "--json",
                                            json});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const v1::FitResult fit = ReadResult(json);
  const std::vector<Eigen::Vector3d> receivers = ReceiversOf(kYard, kYardLights);
  ASSERT_GT(receivers.size(), 1000u);
  ASSERT_EQ(fit.lights_size(), 3);
  for (const v1::LightResult& light : fit.lights()) {
    SCOPED_TRACE(light.name());
    EXPECT_EQ(light.map().width(), 1024);
    EXPECT_EQ(light.map().height(), 512);
    const Eigen::Matrix4d map_from_world = MatrixOf(light.map_from_world());
    Eigen::Vector3d low = Eigen::Vector3d::Constant(1e30), high = -low;
    double least_w = 1e30;
    for (const Eigen::Vector3d& x_in_world : receivers) {
      const Eigen::Vector4d x_in_map = map_from_world * x_in_world.homogeneous();
      least_w = std::min(least_w, x_in_map.w());
      low = low.cwiseMin(x_in_map.hnormalized());
      high = high.cwiseMax(x_in_map.hnormalized());
    }
    EXPECT_GT(least_w, 0);
    EXPECT_GE(low.x(), -kCoverTolerance_texels);
    EXPECT_GE(low.y(), -kCoverTolerance_texels);
    EXPECT_LE(high.x(), 1024 + kCoverTolerance_texels);
    EXPECT_LE(high.y(), 512 + kCoverTolerance_texels);
    EXPECT_GE(low.z(), -1e-9);
    EXPECT_LE(high.z(), 1 + 1e-9);
  }
}

TEST(FitJson, ClipFromWorldFollowsTheChosenConvention) {
  const std::pair<const char*, ClipConvention> conventions[] = {
      {"vulkan", ClipConvention::Vulkan()},
      {"direct3d", ClipConvention::Direct3D()},
      {"opengl", ClipConvention::OpenGl()},
      {"reversed-z", ClipConvention::ReversedZ()},
      {"direct3d-reversed", ClipConvention::Direct3DReversed()}};
  for (const auto& [word, convention] : conventions) {
    SCOPED_TRACE(word);
    const TemporaryFolder folder;
    const std::string json = folder.Path("out.json");
    const ProcessResult result = RunLightfit({"fit",
                                              kYard,
                                              "--lights",
                                              kYardLights,
                                              "--only",
                                              "sun",
                                              "--clip",
                                              word,
                                              "--json",
                                              json,
                                              "--quiet"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const v1::FitResult fit = ReadResult(json);
    ASSERT_EQ(fit.lights_size(), 1);
    const Eigen::Matrix4d expected =
        ClipFromMap({1024, 1024}, convention) * MatrixOf(fit.lights(0).map_from_world());
    const Eigen::Matrix4d clip_from_world = MatrixOf(fit.lights(0).clip_from_world());
    EXPECT_LE((clip_from_world - expected).cwiseAbs().maxCoeff(),
              kMatrixTolerance * expected.cwiseAbs().maxCoeff())
        << clip_from_world << "\nwant\n"
        << expected;
  }
}

TEST(FitJson, NeverEndsAboveTheFocusedOrThePublishedEnergy) {
  const TemporaryFolder folder;
  for (const char* metric : {"l2", "l2-edge"}) {
    const std::string json = folder.Path(absl::StrCat(metric, ".json"));
    const ProcessResult result =
        RunLightfit({"fit", kYard, "--lights", kYardLights, "--metric", metric, "--json", json});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const v1::FitResult fit = ReadResult(json);
    for (const v1::LightResult& light : fit.lights()) {
      SCOPED_TRACE(absl::StrCat(metric, " ", light.name()));
      const v1::Energies& energies = light.energies();
      ASSERT_TRUE(energies.has_focused());
      ASSERT_TRUE(energies.has_as_published());
      EXPECT_GT(energies.final(), 0);
      EXPECT_LE(energies.final(), energies.focused());
      EXPECT_LE(energies.final(), energies.as_published());
      EXPECT_FALSE(light.has_time_ms());
      EXPECT_GT(light.trace_size(), 0);
    }
  }
}

TEST(FitJson, AsPublishedIsTheMethodOfThePublishedColumn) {
  const TemporaryFolder folder;
  const std::string json = folder.Path("out.json");
  const ProcessResult result =
      RunLightfit({"fit", kYard, "--lights", kYardLights, "--as-published", "--json", json});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const v1::FitResult fit = ReadResult(json);
  for (const v1::LightResult& light : fit.lights()) {
    // The one as summed by the fit, the other by the judge of all columns.
    EXPECT_NEAR(light.energies().final_over_as_published(), 1.0, 1e-9) << light.name();
  }
}

TEST(FitJson, LightsOfTheCommandLineCountLikeThoseOfAFile) {
  const TemporaryFolder folder;
  const absl::StatusOr<std::vector<Light>> lights = ReadLightsFile(kYardLights);
  ASSERT_TRUE(lights.ok()) << lights.status();
  const Eigen::Vector3d& d = lights->front().direction;
  const std::string sun = absl::StrFormat("sun=sun:%.17g,%.17g,%.17g", d.x(), d.y(), d.z());
  ASSERT_EQ(lights->front().name, "sun");
  ASSERT_EQ(
      RunLightfit({"fit", kYard, "--light", sun, "--json", folder.Path("line.json")}).exit_code, 0);
  ASSERT_EQ(RunLightfit({"fit",
                         kYard,
                         "--lights",
                         kYardLights,
                         "--only",
                         "sun",
                         "--json",
                         folder.Path("file.json")})
                .exit_code,
            0);
  EXPECT_EQ(ReadFile(folder.Path("line.json")), ReadFile(folder.Path("file.json")));
}

TEST(FitJson, ALightOfTheCommandLineReplacesItsNamesake) {
  const TemporaryFolder folder;
  const std::string json = folder.Path("out.json");
  ASSERT_EQ(
      RunLightfit(
          {"fit", kYard, "--lights", kYardLights, "--light", "sun=sun:0,0,-1", "--json", json})
          .exit_code,
      0);
  const v1::FitResult fit = ReadResult(json);
  ASSERT_EQ(fit.lights_size(), 3);
  const absl::StatusOr<Light> sun = LightFromProto(fit.lights(0).light());
  ASSERT_TRUE(sun.ok()) << sun.status();
  EXPECT_EQ(sun->name, "sun");
  EXPECT_EQ(sun->direction, Eigen::Vector3d(0, 0, -1));
}

// The light's own, in words that a renderer can go by, and what was asked for.
TEST(FitJson, SaysTheBorderOfEveryLight) {
  const TemporaryFolder folder;
  const std::string json = folder.Path("out.json");
  const auto fit = [&](const Arguments& more) {
    const Arguments arguments = {"fit", kYard, "--lights", kYardLights, "--json", json};
    EXPECT_EQ(RunLightfit(Joined(arguments, more)).exit_code, 0);
    return ReadResult(json);
  };
  // This read-back does not tell which surfaces face a light, so there is nothing to choose.
  for (const auto& [more, choice] :
       {std::pair(Arguments{}, v1::BORDER_CHOICE_AUTOMATIC),
        std::pair(Arguments{"--border", "lit"}, v1::BORDER_CHOICE_LIT),
        std::pair(Arguments{"--as-published"}, v1::BORDER_CHOICE_LIT)}) {
    const v1::FitResult result = fit(more);
    EXPECT_EQ(result.options().border(), choice);
    for (const v1::LightResult& light : result.lights()) {
      EXPECT_EQ(light.border(), v1::BORDER_LIT) << light.name();
      EXPECT_EQ(light.facing(), v1::FACING_SOURCE_GUESSED) << light.name();
    }
  }
}

// The header's camera and Blender's own, which the scene file holds, are the same camera.
TEST(FitJson, TheCameraMayComeFromTheSceneFile) {
  const TemporaryFolder folder;
  const std::string header = folder.Path("header.json"), scene = folder.Path("scene.json");
  ASSERT_EQ(RunLightfit({"fit", kYard, "--lights", kYardLights, "--json", header}).exit_code, 0);
  ASSERT_EQ(
      RunLightfit({"fit", kYard, "--lights", kYardLights, "--camera", kYardLights, "--json", scene})
          .exit_code,
      0);
  const v1::FitResult a = ReadResult(header), b = ReadResult(scene);
  ASSERT_EQ(a.lights_size(), b.lights_size());
  for (int i = 0; i < a.lights_size(); ++i) {
    // Single-precision matrices in the header: about 1e-6 of relative difference, amplified.
    EXPECT_NEAR(b.lights(i).energies().final() / a.lights(i).energies().final(), 1, 1e-2)
        << a.lights(i).name();
  }
}

}  // namespace
}  // namespace lightfit
