#include "jobs/compare/camera_step.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"

namespace lightfit {
namespace {

// Turns `from` towards `to` (both unit, at right angles) and leaves what is across both.
Eigen::Matrix3d Turn(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double angle_deg) {
  const double angle_rad = angle_deg * M_PI / 180.0;
  // By the outer products, as the camera's axes may be left-handed.
  return Eigen::Matrix3d::Identity() +
         (std::cos(angle_rad) - 1.0) * (from * from.transpose() + to * to.transpose()) +
         std::sin(angle_rad) * (to * from.transpose() - from * to.transpose());
}

}  // namespace

absl::StatusOr<CameraStep> ParseCameraStep(const std::string& text) {
  const std::vector<std::string> words = absl::StrSplit(text, ',');
  double values[5] = {};
  bool good = words.size() >= 3 && words.size() <= 5;
  for (size_t i = 0; good && i < words.size(); ++i) {
    good = absl::SimpleAtod(words[i], &values[i]) && std::isfinite(values[i]);
  }
  if (!good) {
    return absl::InvalidArgumentError(
        absl::StrCat("\"",
                     text,
                     "\" is no step, want FORWARD,RIGHT,UP[,YAW_DEG[,PITCH_DEG]] such as "
                     "0.1,0,0,0.5"));
  }
  return CameraStep{values[0], values[1], values[2], values[3], values[4]};
}

std::string CameraStepText(const CameraStep& step) {
  std::vector<std::string> parts;
  const auto add = [&parts](double value, const char* ahead, const char* back) {
    if (value == 0.0) return;
    parts.push_back(absl::StrFormat("%.3g %s", std::abs(value), value > 0.0 ? ahead : back));
  };
  add(step.forward, "forward", "back");
  add(step.right, "right", "left");
  add(step.up, "up", "down");
  add(step.yaw_deg, "deg to the right", "deg to the left");
  add(step.pitch_deg, "deg upwards", "deg downwards");
  return parts.empty() ? "none" : absl::StrJoin(parts, ", ");
}

CameraStep DefaultCameraStep(const SurfaceImage& image) {
  constexpr double kShareOfDistance = 0.01;
  std::vector<double> distances;
  distances.reserve(image.num_surface);
  for (const SurfacePoint& pixel : image.pixels) {
    if (pixel.is_surface()) distances.push_back(pixel.camera_z);
  }
  CameraStep step;
  step.yaw_deg = 0.5;
  if (distances.empty()) return step;
  const auto median = distances.begin() + static_cast<ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), median, distances.end());
  step.forward = kShareOfDistance * *median;
  return step;
}

Camera Stepped(const Camera& camera, const CameraStep& step) {
  // Right and up are what the image's x and y say, in camera space; z is forward.
  const Eigen::Matrix3d camera_from_screen = camera.screen_from_camera.inverse();
  const Eigen::Vector3d forward = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d right = camera_from_screen.col(0).normalized();
  const Eigen::Vector3d skewed_up = -camera_from_screen.col(1);
  const Eigen::Vector3d up = (skewed_up - skewed_up.dot(right) * right).normalized();
  Eigen::Matrix4d before_from_after = Eigen::Matrix4d::Identity();
  before_from_after.topLeftCorner<3, 3>() =
      Turn(forward, right, step.yaw_deg) * Turn(forward, up, step.pitch_deg);
  before_from_after.topRightCorner<3, 1>() =
      step.forward * forward + step.right * right + step.up * up;
  Camera stepped = camera;
  stepped.camera_from_world = before_from_after.inverse() * camera.camera_from_world;
  stepped.camera_from_world.row(3) = Eigen::RowVector4d::UnitW();  // without rounding
  return stepped;
}

}  // namespace lightfit
