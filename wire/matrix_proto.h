// wire/matrix_proto.h
//
// Matrices, clip conventions and borders from and to lightfit.v1.
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "geometry/border.h"
#include "geometry/clip.h"
#include "lightfit/v1/matrix.pb.h"

namespace lightfit {

// 16 finite numbers, row-major; `field` names the matrix in the error.
absl::StatusOr<Eigen::Matrix4d> MatrixFromProto(const v1::Matrix4x4& proto,
                                                absl::string_view field);
v1::Matrix4x4 MatrixToProto(const Eigen::Matrix4d& matrix);

// The depth range must be one that this version knows.
absl::StatusOr<ClipConvention> ClipConventionFromProto(const v1::ClipConvention& proto,
                                                       absl::string_view field);
v1::ClipConvention ClipConventionToProto(const ClipConvention& clip);

// "vulkan", "direct3d", "opengl", "reversed_z", "direct3d_reversed", and back, there in any case,
// with - for _, and by other names too ("metal", "d3d12"); "" for other combinations.
const char* ClipConventionName(const ClipConvention& clip);
absl::StatusOr<ClipConvention> ParseClipConvention(absl::string_view name);

// Unspecified is lit.
absl::StatusOr<Border> BorderFromProto(v1::Border proto, absl::string_view field);
v1::Border BorderToProto(Border border);

}  // namespace lightfit
