#include "geometry/sized_camera.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"

namespace lightfit {

double FrameRatio(const Camera& camera) {
  const double lens_x = std::abs(camera.screen_from_camera(0, 0));
  return lens_x > 0.0 ? std::abs(camera.screen_from_camera(1, 1)) / lens_x : 0.0;
}

absl::StatusOr<Camera> SizedCamera(const Camera& camera, int width, int height) {
  constexpr double kRatioTolerance = 0.01;  // sizes are rounded to pixels
  if (HasSize(camera)) return camera;
  const double ratio = FrameRatio(camera);
  const double wanted = static_cast<double>(width) / height;
  if (ratio > 0.0 && !(std::abs(wanted / ratio - 1.0) <= kRatioTolerance)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "camera: its frame is %.4g times as wide as high, the image is %dx%d: want the same ratio, "
        "such as %dx%d",
        ratio,
        width,
        height,
        width,
        std::max(1, static_cast<int>(std::lround(width / ratio)))));
  }
  Camera sized = camera;
  sized.width = width;
  sized.height = height;
  Eigen::Matrix3d& lens = sized.screen_from_camera;
  lens(1, 1) = camera.screen_from_camera(1, 1) * height;
  lens(0, 0) = ratio > 0.0 ? camera.screen_from_camera(0, 0) * width : std::abs(lens(1, 1));
  lens(0, 2) = (camera.screen_from_camera(0, 2) + 0.5) * width;
  lens(1, 2) = (camera.screen_from_camera(1, 2) + 0.5) * height;
  return sized;
}

Camera ResizedCamera(const Camera& camera, int width, int height) {
  Camera resized = camera;
  resized.width = width;
  resized.height = height;
  const Eigen::Vector3d scale(
      static_cast<double>(width) / camera.width, static_cast<double>(height) / camera.height, 1.0);
  resized.screen_from_camera = scale.asDiagonal() * camera.screen_from_camera;
  return resized;
}

}  // namespace lightfit
