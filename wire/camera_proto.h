// wire/camera_proto.h
//
// Camera from and to lightfit.v1.Camera.
// In:   a camera; or a message that may come from anywhere.
// Out:  the message; or a camera that is valid, and the depth kind if the message states one.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "geometry/camera.h"
#include "lightfit/v1/camera.pb.h"

namespace lightfit {

struct StatedCamera {
  Camera camera;
  std::optional<DepthKind> depth_kind;
};

absl::StatusOr<StatedCamera> CameraFromProto(const v1::Camera& proto);

// Writes the pose and the intrinsics; reading them back gives the same camera.
v1::Camera CameraToProto(const Camera& camera, std::optional<DepthKind> depth_kind = {});

// Unspecified becomes absent; a number that this version does not know is an error.
absl::StatusOr<std::optional<DepthKind>> DepthKindFromProto(v1::DepthKind kind);
v1::DepthKind DepthKindToProto(DepthKind kind);

// A pose as it comes from outside: InvalidArgument, naming `field`, unless it is rigid or mirrored
// without scale. On return its last row is exact.
absl::StatusOr<Eigen::Matrix4d> RigidPose(const Eigen::Matrix4d& pose, absl::string_view field);
Eigen::Matrix4d InverseOfPose(const Eigen::Matrix4d& pose);

}  // namespace lightfit
