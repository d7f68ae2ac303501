// tests/cli/shots/numbered_shot.h
//
// A walk past boxes whose frames have numbers of their own, for files that speak of them by number.
// In:   frame numbers.
// Out:  read-backs on disk, and the camera of each frame as scene files write it.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "geometry/clip.h"
#include "io/readback_exr_write.h"
#include "tests/testing/box_scene.h"
#include "tests/testing/process.h"

namespace lightfit::testing {

class NumberedShot {
 public:
  static constexpr int kWidth = 48, kHeight = 32;
  static constexpr uint64_t kSeed = 11;

  // Frames 0 ... num_frames - 1 of the walk.
  explicit NumberedShot(int num_frames) : scene_(MakeBoxScene(kSeed)) {
    lights_ = {Light::Directional("sun", {-0.6, 0.35, -0.72}),
               Light::Point("lamp", {6.0, -5.0, 12.0})};
    lights_[1].shadow_bit = 1;
    for (int i = 0; i < num_frames; ++i) {
      views_.push_back(Render(scene_, CameraOf(i), lights_));
      Write(i, views_.back(), lights_);
    }
  }

  static Eigen::Matrix4d WorldFromCamera(int frame) {
    const Eigen::Vector3d eye(-9.0 + 0.9 * frame, -24.0, 7.0);
    const Eigen::Vector3d back = (eye - Eigen::Vector3d(0.0, 0.0, 0.5)).normalized();
    const Eigen::Vector3d right = Eigen::Vector3d::UnitZ().cross(back).normalized();
    Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
    pose.block<3, 1>(0, 0) = right;
    pose.block<3, 1>(0, 1) = back.cross(right);
    pose.block<3, 1>(0, 2) = back;
    pose.block<3, 1>(0, 3) = eye;
    return pose;
  }
  static Eigen::Matrix4d Projection() {
    Eigen::Matrix4d projection = Eigen::Matrix4d::Zero();
    projection(0, 0) = 1.6;
    projection(1, 1) = 2.4;
    projection(2, 2) = -1.002;
    projection(2, 3) = -0.2002;
    projection(3, 2) = -1.0;
    return projection;
  }
  static Camera CameraOf(int frame) {
    const absl::StatusOr<Camera> camera = MakeCamera(
        InverseOf(WorldFromCamera(frame)), Projection(), ClipConvention::OpenGl(), kWidth, kHeight);
    EXPECT_TRUE(camera.ok()) << camera.status();
    return *camera;
  }

  // "camera_to_world": [...], "projection": [...]
  static std::string CameraJson(int frame) {
    return absl::StrCat("\"camera_to_world\": ",
                        MatrixJson(WorldFromCamera(frame)),
                        ", \"projection\": ",
                        MatrixJson(Projection()));
  }
  static std::string SceneJson(const std::string& frames, const std::string& more = "") {
    return absl::StrFormat(
        R"({"width": %d, "height": %d, %s"frames": %s})", kWidth, kHeight, more, frames);
  }

  const std::vector<Light>& lights() const { return lights_; }
  const SyntheticReadback& view(int frame) const { return views_[frame]; }
  const BoxScene& scene() const { return scene_; }

  std::string LightsJson() const {
    return R"({"lights": [{"name": "sun", "direction": [-0.6, 0.35, -0.72]},
                          {"name": "lamp", "position": [6, -5, 12]}]})";
  }

  // Puts the frame's file where it is wanted, without a copy.
  void Link(int frame, const std::string& path) const {
    std::filesystem::create_directories(std::filesystem::path(path).parent_path());
    std::filesystem::create_hard_link(Original(frame), path);
  }

 private:
  static Eigen::Matrix4d InverseOf(const Eigen::Matrix4d& pose) {
    return Eigen::Isometry3d(pose).inverse().matrix();
  }
  static std::string MatrixJson(const Eigen::Matrix4d& m) {
    std::vector<std::string> numbers;
    for (int i = 0; i < 16; ++i) numbers.push_back(absl::StrFormat("%.17g", m(i / 4, i % 4)));
    return absl::StrCat("[", absl::StrJoin(numbers, ", "), "]");
  }

  std::string Original(int frame) const { return folder_.Path(absl::StrCat("frame", frame)); }
  void Write(int frame, const SyntheticReadback& view, absl::Span<const Light> lights) const {
    const absl::Status status = WriteReadbackExr(Original(frame), view.View(), lights);
    EXPECT_TRUE(status.ok()) << status;
  }

  TemporaryFolder folder_;
  BoxScene scene_;
  std::vector<Light> lights_;
  std::vector<SyntheticReadback> views_;
};

}  // namespace lightfit::testing
