#include "io/camera_file.h"

#include <gtest/gtest.h>

#include "tests/io/testing.h"
#include "wire/camera_proto.h"
#include "wire/matrix_proto.h"
#include "wire/proto_json.h"

namespace lightfit {
namespace {

using testing::HasAll;
using testing::LargestScreenDifference;

// JSON writes doubles so that they read back exactly; what is left is the inversion of a matrix.
constexpr double kRounding = 1e-10;

std::string Json(const v1::Camera& proto) {
  const auto json = ProtoToJson(proto);
  EXPECT_TRUE(json.ok()) << json.status();
  return json.value_or("");
}

TEST(CameraFile, ReadsBackWhatItWrote) {
  Camera camera = testing::StandardCamera(320, 180);
  camera.near = 0.1;
  camera.far = 250.0;
  camera.screen_from_camera(0, 1) = 0.01;  // skew
  for (const bool orthographic : {false, true}) {
    camera.orthographic = orthographic;
    const auto file = ParseCameraJson(Json(CameraToProto(camera, DepthKind::kNdcZeroToOne)));
    ASSERT_TRUE(file.ok()) << file.status();
    EXPECT_EQ(file->camera.width, 320);
    EXPECT_EQ(file->camera.height, 180);
    EXPECT_EQ(file->camera.orthographic, orthographic);
    EXPECT_EQ(file->camera.camera_from_world, camera.camera_from_world);
    EXPECT_EQ(file->camera.screen_from_camera, camera.screen_from_camera);
    EXPECT_EQ(file->camera.near, 0.1);
    EXPECT_EQ(file->camera.far, 250.0);
    EXPECT_EQ(file->depth_kind, DepthKind::kNdcZeroToOne);
  }
}

TEST(CameraFile, EveryDepthKindReadsBackAndNoneStaysNone) {
  const Camera camera = [] {
    Camera with_planes = testing::StandardCamera(16, 9);
    with_planes.near = 1.0;
    return with_planes;
  }();
  for (const DepthKind kind : {DepthKind::kCameraZ,
                               DepthKind::kDistance,
                               DepthKind::kNdcZeroToOne,
                               DepthKind::kNdcMinusOneToOne,
                               DepthKind::kNdcReversedZeroToOne}) {
    const auto file = CameraFromProto(CameraToProto(camera, kind));
    ASSERT_TRUE(file.ok()) << file.status();
    EXPECT_EQ(file->depth_kind, kind);
    EXPECT_TRUE(std::isinf(file->camera.far));
  }
  const auto file = CameraFromProto(CameraToProto(camera));
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_FALSE(file->depth_kind.has_value());
}

// The same camera as an engine has it: a view matrix that looks along -z and a projection.
v1::Camera OpenGlProto(const Camera& camera) {
  const Eigen::Vector4d flip(1.0, 1.0, -1.0, 1.0);
  Eigen::Matrix4d projection = Eigen::Matrix4d::Zero();
  projection(0, 0) = 2.0 * camera.screen_from_camera(0, 0) / camera.width;
  projection(1, 1) = -2.0 * camera.screen_from_camera(1, 1) / camera.height;
  projection.row(2) << 0.0, 0.0, -1.002, -0.2;
  projection.row(3) << 0.0, 0.0, -1.0, 0.0;
  v1::Camera proto;
  proto.set_width(camera.width);
  proto.set_height(camera.height);
  *proto.mutable_camera_from_world() = MatrixToProto(flip.asDiagonal() * camera.camera_from_world);
  *proto.mutable_clip_from_camera() = MatrixToProto(projection);
  *proto.mutable_clip() = ClipConventionToProto(ClipConvention::OpenGl());
  return proto;
}

TEST(CameraFile, ReadsEngineMatricesInEitherDirection) {
  const Camera camera = testing::StandardCamera(320, 180);
  v1::Camera proto = OpenGlProto(camera);
  const auto file = ParseCameraJson(Json(proto));
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_LE(LargestScreenDifference(camera, file->camera), kRounding);

  const auto matrix = MatrixFromProto(proto.camera_from_world(), "pose");
  ASSERT_TRUE(matrix.ok()) << matrix.status();
  *proto.mutable_world_from_camera() = MatrixToProto(matrix->inverse());
  const auto inverted = ParseCameraJson(Json(proto));
  ASSERT_TRUE(inverted.ok()) << inverted.status();
  EXPECT_LE(LargestScreenDifference(camera, inverted->camera), kRounding);
}

TEST(CameraFile, ErrorsNameTheField) {
  const v1::Camera good = OpenGlProto(testing::StandardCamera(320, 180));
  const auto refused = [&good](const auto& change) {
    v1::Camera proto = good;
    change(proto);
    return std::string(CameraFromProto(proto).status().message());
  };
  EXPECT_TRUE(HasAll(refused([](v1::Camera& p) { p.clear_pose(); }),
                     {"camera_from_world", "world_from_camera"}));
  EXPECT_TRUE(HasAll(refused([](v1::Camera& p) { p.clear_projection(); }),
                     {"clip_from_camera", "intrinsics"}));
  EXPECT_TRUE(HasAll(refused([](v1::Camera& p) { p.clear_clip(); }), {"camera.clip: depth_range"}));
  EXPECT_TRUE(HasAll(refused([](v1::Camera& p) { p.set_width(0); }), {"0x180"}));
  EXPECT_TRUE(HasAll(refused([](v1::Camera& p) { p.mutable_camera_from_world()->add_m(1.0); }),
                     {"camera.camera_from_world", "17 numbers", "want 16"}));
  EXPECT_TRUE(
      HasAll(refused([](v1::Camera& p) { p.mutable_camera_from_world()->set_m(0, std::nan("")); }),
             {"camera.camera_from_world", "not finite"}));
  EXPECT_TRUE(HasAll(refused([](v1::Camera& p) { p.mutable_camera_from_world()->set_m(0, 9.0); }),
                     {"camera.camera_from_world", "not rigid"}));
  EXPECT_TRUE(HasAll(refused([](v1::Camera& p) { p.mutable_camera_from_world()->set_m(12, 9.0); }),
                     {"camera.camera_from_world", "transpose"}));
  EXPECT_TRUE(HasAll(refused([](v1::Camera& p) { p.set_depth_kind(v1::DepthKind(99)); }),
                     {"depth_kind = 99"}));
  EXPECT_TRUE(HasAll(refused([](v1::Camera& p) {
                       p.mutable_intrinsics()->set_fx(100.0);  // fy is 0
                     }),
                     {"screen_from_camera"}));
}

TEST(CameraFile, ScenesGiveTheirFrames) {
  const std::string path = testing::RepositoryFile("examples/yard_180/scene.json");
  const auto file = ReadCameraFile(path);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->camera.width, 180);
  EXPECT_FALSE(file->depth_kind.has_value());
  // The camera's place: the last column of camera_to_world.
  const Eigen::Vector4d eye = file->camera.camera_from_world.inverse().col(3);
  EXPECT_TRUE(
      eye.isApprox(Eigen::Vector4d(-1.1203148365020752, -11.0, 1.3448190689086914, 1.0), 1e-6));
  for (const int frame : {-1, 1, 1000}) {
    EXPECT_TRUE(HasAll(ReadCameraFile(path, FrameNumber::Whole(frame)).status().message(),
                       {path, "frame " + std::to_string(frame), "it has 1"}));
  }
}

TEST(CameraFile, SceneErrorsNameTheFrameAndField) {
  const struct {
    const char* json;
    std::vector<std::string> parts;
  } cases[] = {
      {R"({"frames":[{}],"width":8,"height":6})", {"frames[0].camera_to_world"}},
      {R"({"frames":[{"camera_to_world":[1,2]}],"width":8,"height":6})",
       {"frames[0].camera_to_world", "2 numbers"}},
      {R"({"frames":[{"camera_to_world":[[[1]]]}],"width":8,"height":6})",
       {"frames[0].camera_to_world"}},
      {R"({"frames":[{}],"height":6})", {"width"}},
      {R"({"frames":[{}],"width":8.5,"height":6})", {"width = 8.5"}},
      {R"({"frames":{},"width":8,"height":6})", {"frames: none"}},
      {R"({"frames":[3],"width":8,"height":6})", {"frames[0]"}},
      {R"({})", {"no pose"}},
      {R"({"width":"wide"})", {"width", "wide"}},
      {"[]", {"JSON"}},
      {"", {"JSON"}},
  };
  for (const auto& c : cases) {
    const auto file = ParseCameraJson(c.json);
    ASSERT_EQ(file.status().code(), absl::StatusCode::kInvalidArgument) << c.json;
    EXPECT_TRUE(HasAll(file.status().message(), c.parts)) << c.json;
  }
}

TEST(ClipConventionNames, ReadBack) {
  for (const char* name : {"vulkan", "direct3d", "opengl", "reversed_z", "direct3d_reversed"}) {
    const auto clip = ParseClipConvention(name);
    ASSERT_TRUE(clip.ok()) << clip.status();
    EXPECT_STREQ(ClipConventionName(*clip), name);
    const auto copy = ClipConventionFromProto(ClipConventionToProto(*clip), "clip");
    ASSERT_TRUE(copy.ok()) << copy.status();
    EXPECT_EQ(copy->depth, clip->depth);
    EXPECT_EQ(copy->y_up, clip->y_up);
  }
  EXPECT_STREQ(ClipConventionName({ClipConvention::Depth::kMinusOneToOne, true}), "");
  EXPECT_TRUE(HasAll(ParseClipConvention("glide").status().message(), {"\"glide\"", "vulkan"}));
}

TEST(ClipConventionNames, AreReadAsPeopleWriteThem) {
  const std::pair<const char*, const char*> cases[] = {{"D3D12", "direct3d"},
                                                       {"Metal", "direct3d"},
                                                       {"WebGPU", "direct3d"},
                                                       {"OpenGL", "opengl"},
                                                       {"reversed-z", "reversed_z"},
                                                       {"vulkan-reversed", "reversed_z"},
                                                       {"webgpu-reversed", "direct3d_reversed"},
                                                       {"Direct3D Reversed", "direct3d_reversed"}};
  for (const auto& [written, name] : cases) {
    const auto clip = ParseClipConvention(written);
    ASSERT_TRUE(clip.ok()) << clip.status();
    EXPECT_STREQ(ClipConventionName(*clip), name) << written;
  }
}

}  // namespace
}  // namespace lightfit
