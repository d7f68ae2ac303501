// tests/testing/plane_readback.h
//
// The read-back of one plane, in any kind of depth, with shadow bits set by hand.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <cstdint>
#include <vector>

#include "geometry/camera.h"
#include "optimizer/readback/readback.h"
#include "tests/testing/random_cases.h"

namespace lightfit::testing {

struct PlaneReadback {
  Camera camera;
  DepthKind kind;
  std::vector<float> depth;
  std::vector<uint32_t> shadow_bits;

  // The plane n.x = offset fills the image; it must be in front of the camera everywhere.
  PlaneReadback(const Camera& plane_camera,
                DepthKind depth_kind,
                const Eigen::Vector3d& normal,
                double offset)
      : camera(plane_camera), kind(depth_kind) {
    const Eigen::Vector3d corner = DepthOnPlane(camera, normal, offset, {0.0, 0.0});
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const double d = corner(0) + corner(1) * (x + 0.5) + corner(2) * (y + 0.5);
        depth.push_back(static_cast<float>(DepthValue(x, y, camera.orthographic ? d : 1.0 / d)));
      }
    }
    shadow_bits.assign(depth.size(), 0);
  }

  double DepthValue(int x, int y, double z) const {
    const double near = camera.near, far = camera.far;
    const double share = camera.orthographic ? (z - near) / (far - near)
                                             : (1.0 / near - 1.0 / z) / (1.0 / near - 1.0 / far);
    switch (kind) {
      case DepthKind::kCameraZ:
        break;
      case DepthKind::kDistance: {
        const Eigen::Vector3d ray =
            camera.screen_from_camera.inverse() * Eigen::Vector3d(x + 0.5, y + 0.5, 1.0);
        return camera.orthographic ? z : z * ray.norm();
      }
      case DepthKind::kNdcZeroToOne:
        return share;
      case DepthKind::kNdcMinusOneToOne:
        return 2.0 * share - 1.0;
      case DepthKind::kNdcReversedZeroToOne:
        return 1.0 - share;
    }
    return z;
  }

  // Sets a bit wherever shadow(x, y) of the pixel's column and row says so.
  template <typename Shadow>
  void Cast(int bit, const Shadow& shadow) {
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        if (shadow(x, y)) shadow_bits[Index(x, y)] |= uint32_t{1} << bit;
      }
    }
  }

  size_t Index(int x, int y) const { return static_cast<size_t>(y) * camera.width + x; }
  Readback View() const { return {camera, depth, kind, shadow_bits}; }
};

// Looks at the floor z = 0 from 3 metres up, 45 degrees down. The whole image is floor.
inline Camera FloorCamera(int width = 40, int height = 30, double vertical_fov_rad = 0.7) {
  Camera camera = *LookAtCamera(
      {0.0, -3.0, 3.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, vertical_fov_rad, width, height);
  camera.near = 0.5;
  camera.far = 50.0;
  return camera;
}

inline PlaneReadback FloorReadback(const Camera& camera = FloorCamera()) {
  return PlaneReadback(camera, DepthKind::kCameraZ, Eigen::Vector3d::UnitZ(), 0.0);
}

}  // namespace lightfit::testing
