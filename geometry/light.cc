#include "geometry/light.h"

#include <Eigen/Geometry>
#include <utility>

#include "absl/strings/str_format.h"
#include "base/stop.h"

namespace lightfit {

namespace {

std::string VectorText(const Eigen::Vector3d& v) {
  return absl::StrFormat("(%g, %g, %g)", v.x(), v.y(), v.z());
}

}  // namespace

Light Light::Point(std::string name, const Eigen::Vector3d& position, int shadow_bit) {
  Light light;
  light.name = std::move(name);
  light.kind = Kind::kPoint;
  light.position = position;
  light.shadow_bit = shadow_bit;
  return light;
}

Light Light::Directional(std::string name, const Eigen::Vector3d& direction, int shadow_bit) {
  Light light;
  light.name = std::move(name);
  light.kind = Kind::kDirectional;
  light.direction = direction;
  light.shadow_bit = shadow_bit;
  return light;
}

Eigen::Vector4d Light::HomogeneousPosition() const {
  if (kind == Kind::kPoint) return position.homogeneous();
  Eigen::Vector4d at_infinity;
  at_infinity << -direction.stableNormalized(), 0.0;
  return at_infinity;
}

absl::Status ValidateLight(const Light& light) {
  if (light.shadow_bit < 0 || light.shadow_bit >= kMaxLights) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "light \"%s\": shadow_bit = %d, want 0 ... %d: the bit of the read-back's shadow words",
        light.name,
        light.shadow_bit,
        kMaxLights - 1));
  }
  if (light.kind == Light::Kind::kPoint) {
    constexpr double kMaxCoordinate = 1e18;  // fourth powers of it are summed
    if (!(light.position.array().abs() <= kMaxCoordinate).all()) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "light \"%s\": position = %s, want finite world coordinates of at most %g",
          light.name,
          VectorText(light.position),
          kMaxCoordinate));
    }
    return absl::OkStatus();
  }
  const double length = light.direction.norm();
  if (!(length > 0.0) || !std::isfinite(length)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "light \"%s\": direction = %s, want finite and non-zero: the way the light travels, in "
        "world space",
        light.name,
        VectorText(light.direction)));
  }
  return absl::OkStatus();
}

Eigen::Matrix3d FrameAlong(const Eigen::Vector3d& third) {
  const Eigen::Vector3d z = third.stableNormalized();
  // Cross with the coordinate axis furthest from z, so that the product is well conditioned.
  Eigen::Index least = 0;
  z.cwiseAbs().minCoeff(&least);
  const Eigen::Vector3d x = Eigen::Vector3d::Unit(least).cross(z).normalized();
  Eigen::Matrix3d frame;
  frame.row(0) = x;
  frame.row(1) = z.cross(x);
  frame.row(2) = z;
  return frame;
}

Eigen::Matrix<double, 3, 4> RayFromWorld(const Light& light, const Eigen::Vector3d& forward) {
  Eigen::Matrix<double, 3, 4> ray_from_world;
  if (light.kind == Light::Kind::kPoint) {
    const Eigen::Matrix3d axes = FrameAlong(forward);
    ray_from_world << axes, -axes * light.position;
  } else {
    const Eigen::Matrix3d axes = FrameAlong(light.direction);
    ray_from_world.setZero();
    ray_from_world.topLeftCorner<2, 3>() = axes.topRows<2>();
    ray_from_world(2, 3) = 1.0;
  }
  return ray_from_world;
}

absl::Status CheckStop(const Light& light) {
  if (!StopRequested()) return absl::OkStatus();
  return CheckStop(absl::StrFormat("light \"%s\"", light.name));
}

}  // namespace lightfit
