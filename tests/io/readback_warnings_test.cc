#include "io/notes/readback_warnings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "io/lights_file.h"
#include "io/notes/readback_notes.h"
#include "io/readback_exr.h"
#include "io/readback_exr_write.h"
#include "tests/io/exr_file.h"
#include "tests/io/testing.h"
#include "tests/testing/box_scene.h"
#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"

namespace lightfit {
namespace {

using testing::HasAll;

// Boxes on a floor, written with the lights in the header.
struct BoxFile {
  testing::TemporaryFolder folder;
  std::string path = folder.File("a.exr");
  BoxScene scene = MakeBoxScene(5);
  std::vector<Light> lights = {RandomLight(scene, 5, RandomLightKind::kSun, 0),
                               RandomLight(scene, 5, RandomLightKind::kNearPoint, 1)};
  SyntheticReadback image;

  BoxFile() {
    lights[0].name = "sun";
    lights[1].name = "lamp";
    image = Render(scene, RandomCamera(scene, 5, 160, 120), lights);
    EXPECT_EQ(WriteReadbackExr(path, image.View(), lights), absl::OkStatus());
  }

  std::vector<ReadbackWarning> WarningsWith(const std::vector<Light>& other,
                                            const ReadbackExrOptions& options = {}) const {
    const auto file = ReadReadbackExr(path, other, options);
    EXPECT_THAT(file, testing::IsOk());
    return file.ok() ? file->warnings : std::vector<ReadbackWarning>();
  }
};

TEST(ReadbackWarnings, OfTheSameLightsThereAreNone) {
  const BoxFile file;
  EXPECT_THAT(file.WarningsWith(file.lights), ::testing::IsEmpty());
  // As a lights file of a few digits has them.
  std::vector<Light> rounded = file.lights;
  rounded[0].direction = (1e4 * rounded[0].direction).array().round() / 1e4 * 3.0;
  rounded[1].position = (1e3 * rounded[1].position).array().round() / 1e3;
  EXPECT_THAT(file.WarningsWith(rounded), ::testing::IsEmpty());
}

TEST(ReadbackWarnings, LightsOfAnotherSceneAreToldByTheHeader) {
  const BoxFile file;
  std::vector<Light> other = file.lights;
  other[0].direction = Eigen::Vector3d(1, 2, -3);
  other[1] = Light::Directional("lamp", {0, 0, -1}, 1);
  const std::vector<ReadbackWarning> warnings = file.WarningsWith(other);
  ASSERT_GE(warnings.size(), 2U);
  EXPECT_TRUE(HasAll(warnings[0].text, {"light \"sun\"", "direction (1, 2, -3)", "header"}));
  EXPECT_TRUE(HasAll(warnings[1].text, {"light \"lamp\"", "direction (0, 0, -1)", "position ("}));
}

TEST(ReadbackWarnings, LightsThatTheHeaderDoesNotHaveAreFine) {
  const BoxFile file;
  EXPECT_THAT(LightWarnings({Light::Directional("rim", {1, 0, 0})}, file.lights, file.image.camera),
              ::testing::IsEmpty());
}

TEST(ReadbackWarnings, ACameraThatContradictsTheFilesOwnIsTold) {
  const BoxFile file;
  ReadbackExrOptions options;
  options.camera = file.image.camera;
  EXPECT_THAT(file.WarningsWith(file.lights, options), ::testing::IsEmpty());
  options.camera = RandomCamera(file.scene, 6, 160, 120);
  const std::vector<ReadbackWarning> warnings = file.WarningsWith(file.lights, options);
  ASSERT_FALSE(warnings.empty());
  EXPECT_TRUE(HasAll(warnings[0].text, {"--camera", "it stands at", "--frame"}));
}

TEST(ReadbackWarnings, AShiftedLensIsToldUnlessStated) {
  Camera camera = testing::StandardCamera(160, 120);
  EXPECT_THAT(ShiftWarnings(camera), ::testing::IsEmpty());
  camera.screen_from_camera(0, 2) = 0.95 * 160;
  const std::vector<ReadbackWarning> warnings = ShiftWarnings(camera);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_TRUE(HasAll(warnings[0].text, {"(0.95, 0.5)", "--camera-convention shifted"}));
}

TEST(ReadbackWarnings, DepthsThatAreNoDistancesAreTold) {
  const Camera camera = testing::FloorCamera(60, 40);
  const auto warnings_of = [&](DepthKind kind, const std::function<float(float)>& value) {
    testing::PlaneReadback floor(camera, kind, Eigen::Vector3d::UnitZ(), 0.0);
    for (float& depth : floor.depth) depth = value(depth);
    Readback view = floor.View();
    view.depth_kind = DepthKind::kCameraZ;
    return PixelWarnings({}, WarningWords::kCommandLine, &view);
  };
  EXPECT_THAT(warnings_of(DepthKind::kCameraZ, [](float z) { return z; }), ::testing::IsEmpty());
  // A scene that is small in its units: kilometres.
  EXPECT_THAT(warnings_of(DepthKind::kCameraZ, [](float z) { return 1e-3F * z; }),
              ::testing::IsEmpty());
  const auto inverse = warnings_of(DepthKind::kCameraZ, [](float z) { return 1.0F / z; });
  ASSERT_EQ(inverse.size(), 1U);
  EXPECT_TRUE(HasAll(inverse[0].text, {"0 ... 1", "1/z", "--depth-kind ndc-0-1"}));
  for (const DepthKind kind : {DepthKind::kNdcZeroToOne, DepthKind::kNdcReversedZeroToOne}) {
    EXPECT_EQ(warnings_of(kind, [](float z) { return z; }).size(), 1U) << DepthKindName(kind);
  }
  // From the nearest to the furthest.
  const testing::PlaneReadback floor(camera, DepthKind::kCameraZ, Eigen::Vector3d::UnitZ(), 0.0);
  const auto [near, far] = std::minmax_element(floor.depth.begin(), floor.depth.end());
  const float least = *near, most = *far;
  const auto normalized =
      warnings_of(DepthKind::kCameraZ, [&](float z) { return (z - least) / (most - least); });
  ASSERT_EQ(normalized.size(), 1U);
  EXPECT_TRUE(HasAll(normalized[0].text, {"0 ... 1", "normalised"}));
}

TEST(ReadbackWarnings, PixelsOfATransposedOrSquareImageAreTold) {
  for (const auto& [shape, word] :
       {std::pair{1.5 * 1.5, "40 x 60"}, {1.5, "square"}, {1.0, ""}, {2.0, ""}, {4.0 / 3.0, ""}}) {
    testing::PlaneReadback floor(
        testing::FloorCamera(60, 40), DepthKind::kCameraZ, Eigen::Vector3d::UnitZ(), 0.0);
    Readback view = floor.View();
    view.camera.screen_from_camera.row(1) *= shape;
    const std::vector<ReadbackWarning> warnings =
        PixelWarnings({}, WarningWords::kCommandLine, &view);
    EXPECT_EQ(warnings.empty(), std::string(word).empty()) << shape;
    if (!warnings.empty()) EXPECT_TRUE(HasAll(warnings[0].text, {word}));
  }
}

TEST(ReadbackNotes, SayOnceWhatManyFilesHave) {
  ReadbackNotes notes;
  EXPECT_EQ(notes.OriginText(), "");
  ReadbackFile file;
  file.origin.depth_channel = "Z";
  file.warnings = {{"background", "one"}};
  notes.Add(2, "c.exr", file);
  notes.Add(0, "a.exr", file);
  notes.Add(1, "b.exr", file);
  EXPECT_EQ(notes.OriginText(), "depth \"Z\"");
  EXPECT_THAT(notes.Warnings(),
              ::testing::ElementsAre("a.exr: one (likewise 2 more of 3 read-backs)"));
  file.origin.depth_channel = "depth.V";
  file.warnings = {{"camera", "two"}};
  notes.Add(3, "d.exr", file);
  EXPECT_TRUE(HasAll(notes.OriginText(), {"depth \"Z\"", "1 of 4", "\"depth.V\"", "d.exr"}));
  EXPECT_THAT(notes.Warnings(),
              ::testing::ElementsAre("a.exr: one (likewise 2 more of 4 read-backs)", "d.exr: two"));
}

}  // namespace
}  // namespace lightfit
