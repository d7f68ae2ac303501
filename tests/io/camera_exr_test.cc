#include "io/camera_exr.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>

#include "absl/strings/str_format.h"
#include "io/camera_file.h"
#include "tests/io/camera_conventions.h"
#include "tests/io/exr_file.h"
#include "tests/io/testing.h"

namespace lightfit {
namespace {

using testing::Convention;
using testing::ConventionOfBits;
using testing::HasAll;
using testing::kDoublePrecision;
using testing::kHeight;
using testing::kWidth;
using testing::LargestScreenDifference;
using testing::Read;
using testing::StandardMatrices;
using testing::WrittenAs;

// Attributes are single precision: 1e-7 of numbers around 10, times a focal length around 1.
constexpr double kSinglePrecision = 1e-6;

// An orthographic standard pair: the frame is 8 by 4.5 world units.
StandardMatrices StandardOrthographic() {
  const Eigen::Matrix4d camera_from_world = testing::StandardCameraFromWorld();
  Eigen::Matrix4d ndc_from_camera = Eigen::Matrix4d::Identity();
  ndc_from_camera.row(0) << 1.0 / 8.0, 0.0, 0.0, 0.5;
  ndc_from_camera.row(1) << 0.0, -1.0 / 4.5, 0.0, 0.5;
  ndc_from_camera.row(2) << 0.0, 0.0, 0.01, 0.0;
  return {camera_from_world.transpose(), (ndc_from_camera * camera_from_world).transpose()};
}

TEST(CameraExr, ReadsTheStandard) {
  const auto camera = Read(testing::Standard(kWidth, kHeight));
  ASSERT_TRUE(camera.ok()) << camera.status();
  EXPECT_FALSE(camera->orthographic);
  const double difference =
      LargestScreenDifference(testing::StandardCamera(kWidth, kHeight), *camera);
  EXPECT_GE(difference, 0.0);
  EXPECT_LE(difference, kDoublePrecision);
}

TEST(CameraExr, UpperLeftOfNdcIsUpperLeftOfTheImage) {
  const StandardMatrices standard = testing::Standard(kWidth, kHeight);
  const auto camera = Read(standard);
  ASSERT_TRUE(camera.ok()) << camera.status();
  // A point up and to the left of the camera's axis, 5 units in front.
  const Eigen::Vector4d world =
      standard.world_to_camera.transpose().inverse() * Eigen::Vector4d(-1.0, 0.5, 5.0, 1.0);
  const Eigen::Vector4d screen = camera->ScreenFromWorld() * world;
  EXPECT_LT(screen.x() / screen.w(), 0.5 * kWidth);
  EXPECT_LT(screen.y() / screen.w(), 0.5 * kHeight);
  EXPECT_NEAR(screen.z() / screen.w(), 1.0 / 5.0, kDoublePrecision);
}

TEST(CameraExr, ReadsOrthographicCameras) {
  const auto camera = Read(StandardOrthographic());
  ASSERT_TRUE(camera.ok()) << camera.status();
  EXPECT_TRUE(camera->orthographic);
  EXPECT_NEAR(camera->screen_from_camera(0, 0), kWidth / 8.0, kDoublePrecision);
  EXPECT_NEAR(camera->screen_from_camera(1, 1), -kHeight / 4.5, kDoublePrecision);
  EXPECT_NEAR(camera->screen_from_camera(0, 2), 0.5 * kWidth, kDoublePrecision);
  EXPECT_NEAR(camera->screen_from_camera(1, 2), 0.5 * kHeight, kDoublePrecision);
}

TEST(CameraExr, EveryConventionReadsBackWhenStated) {
  for (const StandardMatrices& standard :
       {testing::Standard(kWidth, kHeight), StandardOrthographic()}) {
    const auto expected = Read(standard);
    ASSERT_TRUE(expected.ok()) << expected.status();
    for (int bits = 0; bits < 64; ++bits) {
      const Convention convention = ConventionOfBits(bits);
      const auto camera = Read(WrittenAs(convention, standard, kWidth, kHeight), convention);
      ASSERT_TRUE(camera.ok()) << CameraConventionWords(convention) << ": " << camera.status();
      EXPECT_EQ(camera->orthographic, expected->orthographic);
      const double difference = LargestScreenDifference(*expected, *camera);
      EXPECT_GE(difference, 0.0) << CameraConventionWords(convention);
      EXPECT_LE(difference, kDoublePrecision) << CameraConventionWords(convention);
    }
  }
}

// A camera that looks along -z and writes a w that is negative in front of it is, number for
// number, a standard camera that looks the other way: the one pair that no check can tell apart.
TEST(CameraExr, EveryOtherConventionIsRefusedByTheStandard) {
  for (const StandardMatrices& standard :
       {testing::Standard(kWidth, kHeight), StandardOrthographic()}) {
    for (int bits = 1; bits < 64; ++bits) {
      const Convention convention = ConventionOfBits(bits);
      const Convention backwards = ConventionOfBits(8 + 16);
      if (convention == backwards) continue;
      const auto camera = Read(WrittenAs(convention, standard, kWidth, kHeight));
      ASSERT_FALSE(camera.ok()) << CameraConventionWords(convention);
      EXPECT_EQ(camera.status().code(), absl::StatusCode::kInvalidArgument);
      EXPECT_TRUE(HasAll(camera.status().message(), {"worldTo", "--camera-convention"}));
    }
  }
}

TEST(CameraExr, RefusalNamesTheWordsThatHoldTogether) {
  const struct {
    Convention convention;
    const char* words;
  } cases[] = {{ConventionOfBits(1), "\"column-vectors\""},
               {ConventionOfBits(2), "--camera-convention ndc-minus-1-1"},
               {ConventionOfBits(4), "\"y-up\""},
               {ConventionOfBits(8), "\"looks-minus-z\""},
               {ConventionOfBits(16), "\"w-negative\""},
               {ConventionOfBits(32), "\"shorter-side\""},
               {ConventionOfBits(7), "\"column-vectors,ndc-minus-1-1,y-up\""},
               {Convention::Pbrt(), "\"column-vectors,y-up,shorter-side\""}};
  for (const auto& c : cases) {
    const auto camera =
        Read(WrittenAs(c.convention, testing::Standard(kWidth, kHeight), kWidth, kHeight));
    EXPECT_TRUE(HasAll(camera.status().message(), {c.words}));
  }
}

// Houdini Mantra: worldToCamera as the standard, camera to NDC diag(2.414, 4.292) with w = -z.
TEST(CameraExr, MantraIsRefusedWithBothReadingsAndReadWhenStated) {
  const Eigen::Matrix4d camera_from_world = testing::StandardCameraFromWorld();
  Eigen::Matrix4d ndc_from_camera = Eigen::Matrix4d::Zero();
  ndc_from_camera(0, 0) = 2.414;
  ndc_from_camera(1, 1) = 2.414 * kWidth / kHeight;
  ndc_from_camera.row(2) << 0.0, 0.0, -1.0, -0.002;
  ndc_from_camera(3, 2) = -1.0;
  const StandardMatrices mantra{camera_from_world.transpose(),
                                (ndc_from_camera * camera_from_world).transpose()};
  const auto refused = Read(mantra);
  ASSERT_FALSE(refused.ok());
  EXPECT_TRUE(HasAll(refused.status().message(),
                     {"w is negative",
                      "\"ndc-minus-1-1,y-up,w-negative\"",
                      "\"ndc-minus-1-1,y-up,looks-minus-z\""}));

  const auto camera = Read(mantra, Convention::Mantra());
  ASSERT_TRUE(camera.ok()) << camera.status();
  EXPECT_NEAR(camera->screen_from_camera(0, 0), 2.414 * kWidth / 2.0, kDoublePrecision);
  EXPECT_NEAR(camera->screen_from_camera(1, 1), -2.414 * kWidth / 2.0, kDoublePrecision);
  // It looks along +z of worldToCamera.
  const Eigen::Vector3d forward = camera->camera_from_world.row(2).head<3>();
  EXPECT_TRUE(forward.isApprox(camera_from_world.row(2).head<3>().transpose()));
}

TEST(CameraExr, PbrtReadsBackInPortraitFrames) {
  const StandardMatrices standard = testing::Standard(kHeight, kWidth);
  const StandardMatrices pbrt = WrittenAs(Convention::Pbrt(), standard, kHeight, kWidth);
  CameraExrOptions options;
  EXPECT_FALSE(
      CameraFromExrMatrices(pbrt.world_to_camera, pbrt.world_to_ndc, kHeight, kWidth, options)
          .ok());
  options.convention = Convention::Pbrt();
  const auto camera =
      CameraFromExrMatrices(pbrt.world_to_camera, pbrt.world_to_ndc, kHeight, kWidth, options);
  ASSERT_TRUE(camera.ok()) << camera.status();
  EXPECT_LE(LargestScreenDifference(testing::StandardCamera(kHeight, kWidth), *camera),
            kDoublePrecision);
}

TEST(CameraExr, RefusesCameraToWorldStoredAsWorldToCamera) {
  StandardMatrices matrices = testing::Standard(kWidth, kHeight);
  matrices.world_to_camera = matrices.world_to_camera.inverse().eval();
  const auto camera = Read(matrices);
  ASSERT_FALSE(camera.ok());
  EXPECT_TRUE(HasAll(camera.status().message(),
                     {"does not belong to worldToCamera", "give the camera as a file"}));
}

TEST(CameraExr, RefusesScaledCameras) {
  StandardMatrices matrices = testing::Standard(kWidth, kHeight);
  matrices.world_to_camera.leftCols<3>() *= 0.01;
  const auto camera = Read(matrices);
  ASSERT_FALSE(camera.ok());
  EXPECT_TRUE(HasAll(camera.status().message(), {"not rigid", "0.01"}));
}

TEST(CameraExr, RefusesMatricesOfTwoFrames) {
  StandardMatrices matrices = testing::Standard(kWidth, kHeight);
  matrices.world_to_camera(3, 0) += 0.1;  // the camera moved between the two
  const auto camera = Read(matrices);
  ASSERT_FALSE(camera.ok());
  EXPECT_TRUE(HasAll(camera.status().message(), {"does not belong to worldToCamera"}));
}

TEST(CameraExr, RefusesNonFiniteAndSingularMatrices) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    StandardMatrices matrices = testing::Standard(kWidth, kHeight);
    matrices.world_to_ndc(2, 1) = bad;
    EXPECT_TRUE(HasAll(Read(matrices).status().message(), {"worldToNDC", "not finite"}));
    matrices = testing::Standard(kWidth, kHeight);
    matrices.world_to_camera(0, 0) = bad;
    EXPECT_TRUE(HasAll(Read(matrices).status().message(), {"worldToCamera", "not finite"}));
  }
  StandardMatrices matrices = testing::Standard(kWidth, kHeight);
  matrices.world_to_ndc.setZero();
  EXPECT_EQ(Read(matrices).status().code(), absl::StatusCode::kInvalidArgument);
  matrices.world_to_camera.setZero();
  EXPECT_EQ(Read(matrices).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(CameraExr, NonSquarePixelsMustBeStated) {
  // An anamorphic frame: pixels twice as wide as high.
  StandardMatrices matrices = testing::Standard(2 * kWidth, kHeight);
  const auto refused = Read(matrices);
  ASSERT_FALSE(refused.ok());
  EXPECT_TRUE(HasAll(refused.status().message(), {"--pixel-aspect 2"}));
  CameraExrOptions options;
  options.pixel_aspect = 2.0;
  const auto camera = Read(matrices, options);
  ASSERT_TRUE(camera.ok()) << camera.status();
  EXPECT_NEAR(camera->screen_from_camera(0, 0), 1.2 * kHeight / 2.0, kDoublePrecision);
}

// Cameras far from the origin lose digits in single precision, and must not be refused for it.
TEST(CameraExr, AcceptsSinglePrecisionFarFromTheOrigin) {
  std::mt19937 random(testing::kSeed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::cout << "seed " << testing::kSeed << "\n";
  for (int i = 0; i < 300; ++i) {
    const double distance = std::pow(10.0, 5.0 * std::abs(unit(random)));
    const double focal_heights = std::pow(10.0, 1.5 * unit(random));
    StandardMatrices matrices = testing::Standard(kWidth, kHeight, focal_heights);
    Eigen::Matrix4d moved = Eigen::Matrix4d::Identity();
    moved.topRightCorner<3, 1>() =
        distance * Eigen::Vector3d(unit(random), unit(random), unit(random));
    moved.topLeftCorner<3, 3>() =
        Eigen::AngleAxisd(3.0 * unit(random), Eigen::Vector3d::Random().normalized())
            .toRotationMatrix();
    matrices.world_to_camera = moved.transpose() * matrices.world_to_camera;
    matrices.world_to_ndc = moved.transpose() * matrices.world_to_ndc;
    matrices.world_to_camera = matrices.world_to_camera.cast<float>().cast<double>().eval();
    matrices.world_to_ndc = matrices.world_to_ndc.cast<float>().cast<double>().eval();
    const auto camera = Read(matrices);
    ASSERT_TRUE(camera.ok()) << "case " << i << ", distance " << distance << ", focal "
                             << focal_heights << ": " << camera.status();
    EXPECT_NEAR(camera->screen_from_camera(1, 1) / kHeight, -focal_heights, 1e-3 * focal_heights);
  }
}

TEST(CameraExr, MissingAttributesNameWhatIsThere) {
  const testing::TemporaryFolder folder;
  testing::ExrPart part;
  part.channels = {{"Z", Imf::FLOAT, [](int, int) { return 3.0; }}};
  part.matrices = {{"cameraTransform", Eigen::Matrix4d::Identity()}};
  testing::WriteExr(folder.File("vray.exr"), {part});
  const auto camera = ReadCameraExr(folder.File("vray.exr"));
  ASSERT_EQ(camera.status().code(), absl::StatusCode::kNotFound);
  EXPECT_TRUE(HasAll(camera.status().message(),
                     {"vray.exr", "worldToNDC", "\"cameraTransform\"", "camera as a file"}));
}

TEST(CameraExr, PixelAspectComesFromTheFile) {
  const testing::TemporaryFolder folder;
  testing::ExrPart part;
  const StandardMatrices matrices = testing::Standard(2 * part.width, part.height);
  part.channels = {{"Z", Imf::FLOAT, [](int, int) { return 3.0; }}};
  part.matrices = {{"worldToCamera", matrices.world_to_camera},
                   {"worldToNDC", matrices.world_to_ndc}};
  part.pixel_aspect = 2.0F;
  testing::WriteExr(folder.File("anamorphic.exr"), {part});
  const auto camera = ReadCameraExr(folder.File("anamorphic.exr"));
  EXPECT_TRUE(camera.ok()) << camera.status();
}

// Two independent roads to one camera: the EXR attributes, and Blender's own matrices.
void ExpectSameCamera(const std::string& exr, const std::string& scene, int frame) {
  const auto from_exr = ReadCameraExr(exr);
  ASSERT_TRUE(from_exr.ok()) << from_exr.status();
  const auto from_scene = ReadCameraFile(scene, FrameNumber::Whole(frame));
  ASSERT_TRUE(from_scene.ok()) << from_scene.status();
  EXPECT_EQ(from_exr->width, from_scene->camera.width);
  EXPECT_EQ(from_exr->height, from_scene->camera.height);
  const double difference = LargestScreenDifference(from_scene->camera, *from_exr);
  EXPECT_GE(difference, 0.0) << exr;
  EXPECT_LE(difference, kSinglePrecision) << exr;
}

TEST(CameraExr, AgreesWithTheSceneFileOfTheExamples) {
  for (const std::string set : {"yard_180", "room_180"}) {
    const std::string folder = testing::RepositoryFile("examples/" + set);
    ExpectSameCamera(folder + "/0001.exr", folder + "/scene.json", 0);
  }
}

TEST(CameraExr, AgreesWithTheSceneFileOfAllReadbacks) {
  const std::string root = testing::RepositoryFile("../shared/readbacks");
  if (!std::filesystem::exists(root)) {
    GTEST_SKIP() << "no " << root << ": the larger read-backs are not on this machine";
  }
  for (const std::string set : {"yard_180", "room_180", "yard_640", "room_1080p", "shot_walk"}) {
    const std::string folder = root + "/" + set;
    for (int frame = 0; frame < (set == "shot_walk" ? 24 : 1); ++frame) {
      const std::string exr = absl::StrFormat("%s/%04d.exr", folder, frame + 1);
      ExpectSameCamera(exr, folder + "/scene.json", frame);
    }
  }
}

}  // namespace
}  // namespace lightfit
