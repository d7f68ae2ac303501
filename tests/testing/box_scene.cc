#include "tests/testing/box_scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>

namespace lightfit {

namespace {

constexpr double kPi = 3.14159265358979323846;

// Uniform in [low, high); std::uniform_real_distribution differs between standard libraries.
double Uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

double LogUniform(std::mt19937_64& random, double low, double high) {
  return std::exp(Uniform(random, std::log(low), std::log(high)));
}

// Whether the point is inside the box or within `clearance` of it.
bool IsNear(const Eigen::Vector3d& point, const Box& box, double clearance) {
  const Eigen::Rotation2Dd box_from_world(-box.turn_rad);
  Eigen::Vector3d local = point - box.center;
  local.head<2>() = box_from_world * Eigen::Vector2d(local.head<2>());
  return (local.cwiseAbs() - box.half_size).maxCoeff() < clearance;
}

}  // namespace

BoxScene MakeBoxScene(uint64_t seed, const BoxSceneOptions& options) {
  std::mt19937_64 random(seed);
  BoxScene scene;
  scene.floor_half_size = options.floor_half_size;
  for (int i = 0; i < options.num_boxes; ++i) {
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
      box.half_size[axis] = 0.5 * LogUniform(random, options.min_size, options.max_size);
    }
    const double reach = 0.8 * options.floor_half_size;
    box.center.x() = Uniform(random, -reach, reach);
    box.center.y() = Uniform(random, -reach, reach);
    box.center.z() = box.half_size.z();
    box.turn_rad = Uniform(random, 0.0, kPi);
    scene.max_height = std::max(scene.max_height, 2.0 * box.half_size.z());
    scene.boxes.push_back(box);
  }
  return scene;
}

Light RandomLight(const BoxScene& scene, uint64_t seed, RandomLightKind kind, int shadow_bit) {
  std::mt19937_64 random(seed);
  const double size = scene.floor_half_size;
  const double azimuth = Uniform(random, 0.0, 2.0 * kPi);
  // Uniform on the hemisphere, but for the last 3 degrees above the horizon.
  const double up = Uniform(random, 0.05, 1.0);
  const double out = std::sqrt(1.0 - up * up);
  const Eigen::Vector3d to_light(out * std::cos(azimuth), out * std::sin(azimuth), up);
  const std::string number = std::to_string(shadow_bit);
  switch (kind) {
    case RandomLightKind::kNearPoint: {
      const double height = scene.max_height + LogUniform(random, 0.05 * size, size);
      return Light::Point("near" + number,
                          {Uniform(random, -size, size), Uniform(random, -size, size), height},
                          shadow_bit);
    }
    case RandomLightKind::kFarPoint:
      return Light::Point("far" + number,
                          Eigen::Vector3d(0.0, 0.0, scene.max_height) +
                              LogUniform(random, 5.0, 50.0) * size * to_light,
                          shadow_bit);
    case RandomLightKind::kSun:
      break;
  }
  return Light::Directional("sun" + number, -to_light, shadow_bit);
}

std::vector<Light> RandomLights(const BoxScene& scene, uint64_t seed, int num_lights) {
  constexpr RandomLightKind kKinds[] = {
      RandomLightKind::kSun, RandomLightKind::kNearPoint, RandomLightKind::kFarPoint};
  std::mt19937_64 random(seed);
  std::vector<Light> lights;
  lights.reserve(num_lights);
  for (int i = 0; i < num_lights; ++i) {
    lights.push_back(RandomLight(scene, random(), kKinds[i % 3], i));
  }
  return lights;
}

Camera RandomCamera(const BoxScene& scene, uint64_t seed, int width, int height) {
  std::mt19937_64 random(seed);
  const double size = scene.floor_half_size;
  while (true) {
    // One by one: compilers evaluate arguments in an order of their own.
    Eigen::Vector3d eye, target;
    eye.z() = LogUniform(random, 1.0, 8.0);
    eye.y() = Uniform(random, -size, size);
    eye.x() = Uniform(random, -size, size);
    target.z() = 0.5;
    target.y() = Uniform(random, -0.5 * size, 0.5 * size);
    target.x() = Uniform(random, -0.5 * size, 0.5 * size);
    const double vertical_fov_rad = Uniform(random, 35.0, 65.0) * kPi / 180.0;
    const auto blocks = [&](const Box& box) { return IsNear(eye, box, /*clearance=*/0.2); };
    if ((target - eye).norm() < 0.5 * size ||
        std::any_of(scene.boxes.begin(), scene.boxes.end(), blocks)) {
      continue;
    }
    absl::StatusOr<Camera> camera =
        LookAtCamera(eye, target, Eigen::Vector3d::UnitZ(), vertical_fov_rad, width, height);
    if (camera.ok()) return *std::move(camera);
    // Only a bad size brings us here: do not look for a camera for ever.
    return Camera();
  }
}

}  // namespace lightfit
