// tests/io/testing.h
//
// Files and cameras for the tests of io/ and of what uses it.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/string_view.h"
#include "geometry/camera.h"
#include "tests/testing/process.h"

namespace lightfit::testing {

inline constexpr uint32_t kSeed = 20240611;

// Succeeds when `message` has all of `parts`.
inline ::testing::AssertionResult HasAll(absl::string_view message,
                                         const std::vector<std::string>& parts) {
  for (const std::string& part : parts) {
    if (!absl::StrContains(message, part)) {
      return ::testing::AssertionFailure() << "no \"" << part << "\" in: " << message;
    }
  }
  return ::testing::AssertionSuccess();
}

// A folder that goes away with the object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "lightfit_io_XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string File(const std::string& name) const { return (path_ / name).string(); }

  std::string Write(const std::string& name, absl::string_view bytes) const {
    std::ofstream(File(name), std::ios::binary) << bytes;
    return File(name);
  }

  size_t num_files() const {
    return std::distance(std::filesystem::directory_iterator(path_),
                         std::filesystem::directory_iterator());
  }

 private:
  std::filesystem::path path_;
};

// `name` relative to the root of the repository.
inline std::string RepositoryFile(const std::string& name) { return RepositoryPath(name); }

inline std::string Bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// A standard perspective camera for a frame of that size: worldToCamera and worldToNDC as the
// OpenEXR standard has them, as stored (row vectors).
struct StandardMatrices {
  Eigen::Matrix4d world_to_camera, world_to_ndc;
};

// camera_from_world with +x right, +y up, +z forward (left-handed), from eye (3, -7, 2).
inline Eigen::Matrix4d StandardCameraFromWorld() {
  const Eigen::Vector3d eye(3.0, -7.0, 2.0);
  const Eigen::Vector3d forward = Eigen::Vector3d(-0.3, 0.9, -0.2).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix4d camera_from_world = Eigen::Matrix4d::Identity();
  camera_from_world.row(0).head<3>() = right;
  camera_from_world.row(1).head<3>() = right.cross(forward);
  camera_from_world.row(2).head<3>() = forward;
  camera_from_world.topRightCorner<3, 1>() = -camera_from_world.topLeftCorner<3, 3>() * eye;
  return camera_from_world;
}

inline StandardMatrices Standard(int width, int height, double focal_heights = 1.2) {
  const Eigen::Matrix4d camera_from_world = StandardCameraFromWorld();
  Eigen::Matrix4d ndc_from_camera = Eigen::Matrix4d::Zero();
  ndc_from_camera.row(0) << focal_heights * height / width, 0.0, 0.5, 0.0;
  ndc_from_camera.row(1) << 0.0, -focal_heights, 0.5, 0.0;
  ndc_from_camera.row(2) << 0.0, 0.0, 1.001, -0.1001;
  ndc_from_camera.row(3) << 0.0, 0.0, 1.0, 0.0;
  return {camera_from_world.transpose(), (ndc_from_camera * camera_from_world).transpose()};
}

// The same camera in the library's terms.
inline Camera StandardCamera(int width, int height, double focal_heights = 1.2) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.camera_from_world = StandardCameraFromWorld();
  camera.screen_from_camera << focal_heights * height, 0.0, 0.5 * width,  //
      0.0, -focal_heights * height, 0.5 * height,                         //
      0.0, 0.0, 1.0;
  return camera;
}

// Largest distance between the two cameras' images of random world points 2 to 42 units in front,
// as a share of the frame's width and height (and of 1 for affine depth).
inline double LargestScreenDifference(const Camera& a, const Camera& b, int num_points = 1000) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const Eigen::Matrix4d world_from_screen = a.WorldFromScreen();
  const Eigen::Matrix4d screen_from_world = b.ScreenFromWorld();
  double largest = -1.0;
  for (int i = 0; i < num_points; ++i) {
    const double z = 2.0 + 40.0 * unit(random);
    const Eigen::Vector4d screen(
        a.width * unit(random), a.height * unit(random), a.orthographic ? z : 1.0 / z, 1.0);
    const Eigen::Vector4d other = screen_from_world * (world_from_screen * screen);
    if (!(other.w() > 0.0)) return 1e30;  // behind the other camera
    largest = std::max(largest,
                       (other.head<3>() / other.w() - screen.head<3>())
                           .cwiseQuotient(Eigen::Vector3d(a.width, a.height, 1.0))
                           .cwiseAbs()
                           .maxCoeff());
  }
  return largest;
}

}  // namespace lightfit::testing
