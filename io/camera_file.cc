#include "io/camera_file.h"

#include <google/protobuf/struct.pb.h>

#include <Eigen/Dense>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "geometry/clip.h"
#include "io/matrix_proto.h"
#include "io/proto_json.h"
#include "io/text_file.h"

namespace lightfit {

namespace {

using google::protobuf::Struct;
using google::protobuf::Value;

constexpr double kRigidTolerance = 1e-3;

// A pose without scale, given as the camera's or as the world's; its last row is exact on return.
absl::StatusOr<Eigen::Matrix4d> Pose(const Eigen::Matrix4d& pose, absl::string_view field) {
  const Eigen::Matrix3d axes = pose.topLeftCorner<3, 3>();
  const Eigen::RowVector4d last = pose.row(3);
  if ((last - Eigen::RowVector4d::UnitW()).cwiseAbs().maxCoeff() > kRigidTolerance) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s: last row = (%g, %g, %g, %g), want (0, 0, 0, 1); is it meant for row "
                        "vectors? Then transpose it",
                        field,
                        last(0),
                        last(1),
                        last(2),
                        last(3)));
  }
  if ((axes * axes.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() >
      kRigidTolerance) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s: is not rigid, its axes have the lengths %g, %g, %g: want a rotation or "
        "mirror without scale",
        field,
        axes.col(0).norm(),
        axes.col(1).norm(),
        axes.col(2).norm()));
  }
  Eigen::Matrix4d result = pose;
  result.row(3) = Eigen::RowVector4d::UnitW();
  return result;
}

Eigen::Matrix4d InverseOfPose(const Eigen::Matrix4d& pose) {
  Eigen::Matrix4d inverse = Eigen::Matrix4d::Identity();
  inverse.topLeftCorner<3, 3>() = pose.topLeftCorner<3, 3>().inverse();
  inverse.topRightCorner<3, 1>() = -inverse.topLeftCorner<3, 3>() * pose.topRightCorner<3, 1>();
  return inverse;
}

// Appends numbers and, one level down, lists of numbers: 16 numbers or 4 rows of 4.
bool AppendNumbers(const google::protobuf::ListValue& list, int depth, v1::Matrix4x4& matrix) {
  for (const Value& value : list.values()) {
    if (value.has_number_value()) {
      matrix.add_m(value.number_value());
    } else if (depth > 1 || !value.has_list_value() ||
               !AppendNumbers(value.list_value(), depth + 1, matrix)) {
      return false;
    }
  }
  return true;
}

absl::StatusOr<Eigen::Matrix4d> SceneMatrix(const Struct& frame,
                                            const char* field,
                                            absl::string_view where) {
  v1::Matrix4x4 matrix;
  const auto found = frame.fields().find(field);
  if (found == frame.fields().end() || !found->second.has_list_value() ||
      !AppendNumbers(found->second.list_value(), 1, matrix)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s.%s: want a 4x4 matrix, as 4 rows of 4 numbers", where, field));
  }
  return MatrixFromProto(matrix, absl::StrCat(where, ".", field));
}

absl::StatusOr<int> SceneSize(const Struct& scene, const char* field) {
  const auto found = scene.fields().find(field);
  const double value = found == scene.fields().end() ? 0.0 : found->second.number_value();
  if (!(value >= 1.0) || value > 1e9 || value != std::floor(value)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s = %g, want the image's size in pixels", field, value));
  }
  return static_cast<int>(value);
}

absl::StatusOr<CameraFile> CameraFromScene(const Struct& scene, int frame) {
  const auto& frames = scene.fields().at("frames").list_value().values();
  if (frame < 0 || frame >= frames.size() || !frames[frame].has_struct_value()) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "frame %d is not in the file: it has %d, counted from 0", frame, frames.size()));
  }
  const std::string where = absl::StrFormat("frames[%d]", frame);
  const Struct& cameras = frames[frame].struct_value();
  const absl::StatusOr<int> width = SceneSize(scene, "width");
  if (!width.ok()) return width.status();
  const absl::StatusOr<int> height = SceneSize(scene, "height");
  if (!height.ok()) return height.status();
  const absl::StatusOr<Eigen::Matrix4d> matrix = SceneMatrix(cameras, "camera_to_world", where);
  if (!matrix.ok()) return matrix.status();
  const absl::StatusOr<Eigen::Matrix4d> world_from_camera =
      Pose(*matrix, where + ".camera_to_world");
  if (!world_from_camera.ok()) return world_from_camera.status();
  const absl::StatusOr<Eigen::Matrix4d> projection = SceneMatrix(cameras, "projection", where);
  if (!projection.ok()) return projection.status();
  absl::StatusOr<Camera> camera = MakeCamera(
      InverseOfPose(*world_from_camera), *projection, ClipConvention::OpenGl(), *width, *height);
  if (!camera.ok()) return camera.status();
  return CameraFile{*std::move(camera), absl::nullopt};
}

absl::StatusOr<Eigen::Matrix4d> CameraFromWorld(const v1::Camera& proto) {
  const bool inverted = proto.has_world_from_camera();
  if (!inverted && !proto.has_camera_from_world()) {
    return absl::InvalidArgumentError(
        "camera: has no pose, want camera_from_world or world_from_camera");
  }
  const char* field = inverted ? "camera.world_from_camera" : "camera.camera_from_world";
  const absl::StatusOr<Eigen::Matrix4d> matrix =
      MatrixFromProto(inverted ? proto.world_from_camera() : proto.camera_from_world(), field);
  if (!matrix.ok()) return matrix.status();
  absl::StatusOr<Eigen::Matrix4d> pose = Pose(*matrix, field);
  if (pose.ok() && inverted) return InverseOfPose(*pose);
  return pose;
}

absl::StatusOr<Camera> CameraOfProto(const v1::Camera& proto) {
  const absl::StatusOr<Eigen::Matrix4d> camera_from_world = CameraFromWorld(proto);
  if (!camera_from_world.ok()) return camera_from_world.status();
  if (proto.has_clip_from_camera()) {
    const absl::StatusOr<Eigen::Matrix4d> projection =
        MatrixFromProto(proto.clip_from_camera(), "camera.clip_from_camera");
    if (!projection.ok()) return projection.status();
    const absl::StatusOr<ClipConvention> clip =
        ClipConventionFromProto(proto.clip(), "camera.clip");
    if (!clip.ok()) return clip.status();
    return MakeCamera(*camera_from_world, *projection, *clip, proto.width(), proto.height());
  }
  if (!proto.has_intrinsics()) {
    return absl::InvalidArgumentError(
        "camera: has no projection, want clip_from_camera or intrinsics");
  }
  const v1::Intrinsics& intrinsics = proto.intrinsics();
  Camera camera;
  camera.width = proto.width();
  camera.height = proto.height();
  camera.camera_from_world = *camera_from_world;
  camera.orthographic = intrinsics.orthographic();
  camera.screen_from_camera << intrinsics.fx(), intrinsics.skew(), intrinsics.cx(),  //
      0.0, intrinsics.fy(), intrinsics.cy(),                                         //
      0.0, 0.0, 1.0;
  if (proto.has_near()) camera.near = proto.near();
  if (proto.has_far()) camera.far = proto.far();
  return camera;
}

}  // namespace

absl::StatusOr<CameraFile> CameraFromProto(const v1::Camera& proto) {
  const absl::StatusOr<absl::optional<DepthKind>> depth_kind =
      DepthKindFromProto(proto.depth_kind());
  if (!depth_kind.ok()) return depth_kind.status();
  absl::StatusOr<Camera> camera = CameraOfProto(proto);
  if (!camera.ok()) return camera.status();
  if (absl::Status status = ValidateCamera(*camera, depth_kind->value_or(DepthKind::kCameraZ));
      !status.ok()) {
    return status;
  }
  return CameraFile{*std::move(camera), *depth_kind};
}

v1::Camera CameraToProto(const Camera& camera, absl::optional<DepthKind> depth_kind) {
  v1::Camera proto;
  proto.set_width(camera.width);
  proto.set_height(camera.height);
  *proto.mutable_camera_from_world() = MatrixToProto(camera.camera_from_world);
  v1::Intrinsics& intrinsics = *proto.mutable_intrinsics();
  intrinsics.set_fx(camera.screen_from_camera(0, 0));
  intrinsics.set_skew(camera.screen_from_camera(0, 1));
  intrinsics.set_cx(camera.screen_from_camera(0, 2));
  intrinsics.set_fy(camera.screen_from_camera(1, 1));
  intrinsics.set_cy(camera.screen_from_camera(1, 2));
  intrinsics.set_orthographic(camera.orthographic);
  if (std::isfinite(camera.near) && camera.near != 0.0) proto.set_near(camera.near);
  if (std::isfinite(camera.far)) proto.set_far(camera.far);
  if (depth_kind) proto.set_depth_kind(DepthKindToProto(*depth_kind));
  return proto;
}

absl::StatusOr<absl::optional<DepthKind>> DepthKindFromProto(v1::DepthKind kind) {
  switch (kind) {
    case v1::DEPTH_KIND_UNSPECIFIED:
      return absl::optional<DepthKind>();
    case v1::DEPTH_KIND_CAMERA_Z:
      return absl::optional<DepthKind>(DepthKind::kCameraZ);
    case v1::DEPTH_KIND_DISTANCE:
      return absl::optional<DepthKind>(DepthKind::kDistance);
    case v1::DEPTH_KIND_NDC_ZERO_TO_ONE:
      return absl::optional<DepthKind>(DepthKind::kNdcZeroToOne);
    case v1::DEPTH_KIND_NDC_MINUS_ONE_TO_ONE:
      return absl::optional<DepthKind>(DepthKind::kNdcMinusOneToOne);
    case v1::DEPTH_KIND_NDC_REVERSED_ZERO_TO_ONE:
      return absl::optional<DepthKind>(DepthKind::kNdcReversedZeroToOne);
    default:
      return absl::InvalidArgumentError(
          absl::StrFormat("depth_kind = %d, want one of lightfit.v1.DepthKind", kind));
  }
}

v1::DepthKind DepthKindToProto(DepthKind kind) {
  switch (kind) {
    case DepthKind::kCameraZ:
      return v1::DEPTH_KIND_CAMERA_Z;
    case DepthKind::kDistance:
      return v1::DEPTH_KIND_DISTANCE;
    case DepthKind::kNdcZeroToOne:
      return v1::DEPTH_KIND_NDC_ZERO_TO_ONE;
    case DepthKind::kNdcMinusOneToOne:
      return v1::DEPTH_KIND_NDC_MINUS_ONE_TO_ONE;
    case DepthKind::kNdcReversedZeroToOne:
      return v1::DEPTH_KIND_NDC_REVERSED_ZERO_TO_ONE;
  }
  return v1::DEPTH_KIND_UNSPECIFIED;
}

absl::StatusOr<CameraFile> ParseCameraJson(absl::string_view json, int frame) {
  Struct scene;
  if (absl::Status status = JsonToProto(json, scene); !status.ok()) return status;
  if (scene.fields().contains("frames")) return CameraFromScene(scene, frame);
  if (frame != 0) {
    return absl::InvalidArgumentError(
        absl::StrFormat("frame %d is not in the file: it holds one camera, frame 0", frame));
  }
  v1::Camera proto;
  if (absl::Status status = JsonToProto(json, proto); !status.ok()) return status;
  return CameraFromProto(proto);
}

absl::StatusOr<CameraFile> ReadCameraFile(const std::string& path, int frame) {
  const absl::StatusOr<std::string> json = ReadTextFile(path);
  if (!json.ok()) return json.status();
  absl::StatusOr<CameraFile> camera = ParseCameraJson(*json, frame);
  if (!camera.ok()) return InFile(path, camera.status());
  return camera;
}

}  // namespace lightfit
