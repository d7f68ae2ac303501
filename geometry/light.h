// geometry/light.h
//
// Lights, and the rays that their shadow map samples.
// In:   a point light's position or a directional light's direction of travel, world space.
// Out:  ray_from_world, 3x4: homogeneous rays X of homogeneous world points.   math.md 1
#pragma once

#include <Eigen/Core>
#include <string>

#include "absl/status/status.h"
#include "base/stop.h"

namespace lightfit {

// The shadow bits of a read-back are 32 to a pixel: one read-back serves up to 32 lights.
inline constexpr int kMaxLights = 32;

struct Light {
  enum class Kind { kPoint, kDirectional };

  std::string name;
  Kind kind = Kind::kDirectional;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();     // kPoint: world units
  Eigen::Vector3d direction = -Eigen::Vector3d::UnitZ();  // kDirectional: the way light travels
  int shadow_bit = 0;  // which bit of Readback::shadow_bits tells this light's shadow, 0 ... 31

  static Light Point(std::string name, const Eigen::Vector3d& position, int shadow_bit = 0);
  static Light Directional(std::string name, const Eigen::Vector3d& direction, int shadow_bit = 0);

  // The light as a homogeneous world point: (position, 1) or (-direction, 0), direction unit.
  Eigen::Vector4d HomogeneousPosition() const;
};

// Checks that the values are finite, the direction is not zero and the bit is in range.
absl::Status ValidateLight(const Light& light);

// As CheckStop() of base/stop.h, in the name of the light.
absl::Status CheckStop(const Light& light);

// Light space: X = A (x - l) for a point light, (e1.x, e2.x, 1) for a directional one, with an
// arbitrary but fixed right-handed orthonormal frame whose third axis is `forward` (a point light)
// or the direction of travel (a directional one; `forward` is ignored). Homogeneous scale of the
// world point carries over, so points in front of the camera keep the light's own sign.
Eigen::Matrix<double, 3, 4> RayFromWorld(const Light& light,
                                         const Eigen::Vector3d& forward = Eigen::Vector3d::UnitZ());

// Rows are an orthonormal right-handed frame with `third` (non-zero) as its last axis.
Eigen::Matrix3d FrameAlong(const Eigen::Vector3d& third);

}  // namespace lightfit
