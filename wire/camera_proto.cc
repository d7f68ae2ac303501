#include "wire/camera_proto.h"

#include <Eigen/Dense>
#include <cmath>
#include <utility>

#include "absl/strings/str_format.h"
#include "geometry/clip.h"
#include "wire/matrix_proto.h"

namespace lightfit {

namespace {

constexpr double kRigidTolerance = 1e-3;

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
  absl::StatusOr<Eigen::Matrix4d> pose = RigidPose(*matrix, field);
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

absl::StatusOr<Eigen::Matrix4d> RigidPose(const Eigen::Matrix4d& pose, absl::string_view field) {
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

absl::StatusOr<StatedCamera> CameraFromProto(const v1::Camera& proto) {
  const absl::StatusOr<std::optional<DepthKind>> depth_kind =
      DepthKindFromProto(proto.depth_kind());
  if (!depth_kind.ok()) return depth_kind.status();
  absl::StatusOr<Camera> camera = CameraOfProto(proto);
  if (!camera.ok()) return camera.status();
  if (absl::Status status = ValidateCamera(*camera, depth_kind->value_or(DepthKind::kCameraZ));
      !status.ok()) {
    return status;
  }
  return StatedCamera{*std::move(camera), *depth_kind};
}

v1::Camera CameraToProto(const Camera& camera, std::optional<DepthKind> depth_kind) {
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

absl::StatusOr<std::optional<DepthKind>> DepthKindFromProto(v1::DepthKind kind) {
  switch (kind) {
    case v1::DEPTH_KIND_UNSPECIFIED:
      return std::optional<DepthKind>();
    case v1::DEPTH_KIND_CAMERA_Z:
      return std::optional<DepthKind>(DepthKind::kCameraZ);
    case v1::DEPTH_KIND_DISTANCE:
      return std::optional<DepthKind>(DepthKind::kDistance);
    case v1::DEPTH_KIND_NDC_ZERO_TO_ONE:
      return std::optional<DepthKind>(DepthKind::kNdcZeroToOne);
    case v1::DEPTH_KIND_NDC_MINUS_ONE_TO_ONE:
      return std::optional<DepthKind>(DepthKind::kNdcMinusOneToOne);
    case v1::DEPTH_KIND_NDC_REVERSED_ZERO_TO_ONE:
      return std::optional<DepthKind>(DepthKind::kNdcReversedZeroToOne);
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

}  // namespace lightfit
