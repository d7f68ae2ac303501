// tests/io/camera_conventions.h
//
// The attributes of a camera as renderers of every convention write them.
// In:   a standard pair of matrices; a convention, of which there are 64.
// Out:  the pair as that renderer writes it; the camera that is read from a pair.
#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "absl/status/statusor.h"
#include "geometry/camera.h"
#include "io/camera_exr.h"
#include "tests/io/testing.h"

namespace lightfit::testing {

using Convention = CameraConvention;

inline constexpr int kWidth = 160;
inline constexpr int kHeight = 90;

inline constexpr double kDoublePrecision = 1e-10;

// Each bit is one of its choices.
inline Convention ConventionOfBits(int bits) {
  return {static_cast<Convention::Layout>(bits & 1),
          static_cast<Convention::NdcRange>(bits >> 1 & 1),
          static_cast<Convention::NdcY>(bits >> 2 & 1),
          static_cast<Convention::ViewAxis>(bits >> 3 & 1),
          static_cast<Convention::NdcW>(bits >> 4 & 1),
          static_cast<Convention::NdcSpan>(bits >> 5 & 1)};
}

// What a renderer of the given convention writes for the camera of `standard`.
inline StandardMatrices WrittenAs(const Convention& convention,
                                  const StandardMatrices& standard,
                                  int width,
                                  int height) {
  Eigen::Matrix4d camera = standard.world_to_camera.transpose();
  Eigen::Matrix4d ndc = standard.world_to_ndc.transpose();
  const Eigen::RowVector4d w = ndc.row(3);
  if (convention.ndc_span == Convention::NdcSpan::kShorterSide) {
    const int longer = width > height ? 0 : 1;
    const double ratio = static_cast<double>(std::max(width, height)) / std::min(width, height);
    ndc.row(longer) = 0.5 * w + (ndc.row(longer) - 0.5 * w) * ratio;
  }
  if (convention.ndc_y == Convention::NdcY::kUp) ndc.row(1) = w - ndc.row(1);
  if (convention.ndc_range == Convention::NdcRange::kMinusOneToOne) {
    ndc.row(0) = 2.0 * ndc.row(0) - w;
    ndc.row(1) = 2.0 * ndc.row(1) - w;
  }
  if (convention.ndc_w == Convention::NdcW::kNegative) ndc.row(3) = -w;
  if (convention.view_axis == Convention::ViewAxis::kMinusZ) camera.row(2) = -camera.row(2);
  if (convention.layout == Convention::Layout::kColumnVectors) return {camera, ndc};
  return {camera.transpose(), ndc.transpose()};
}

inline absl::StatusOr<Camera> Read(const StandardMatrices& matrices,
                                   const CameraExrOptions& options = {}) {
  return CameraFromExrMatrices(
      matrices.world_to_camera, matrices.world_to_ndc, kWidth, kHeight, options);
}

inline absl::StatusOr<Camera> Read(const StandardMatrices& matrices, const Convention& convention) {
  CameraExrOptions options;
  options.convention = convention;
  return Read(matrices, options);
}

}  // namespace lightfit::testing
