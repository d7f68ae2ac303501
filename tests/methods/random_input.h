// tests/methods/random_input.h
//
// Random views of random boxes under random lights.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <string>
#include <vector>

#include "methods/method.h"
#include "methods/view_body.h"
#include "tests/testing/random_cases.h"

namespace lightfit::testing {

// A box of any proportions, a camera inside or around it, and a light: directional, or a lamp
// anywhere around. Not every one of them has a map.
inline MethodInput RandomInput(Random& random) {
  MethodInput input;
  const double size = random.LogUniform(1e-2, 1e3);
  const Eigen::Vector3d centre = random.InCube(3.0 * size);
  Eigen::Vector3d half;
  for (int axis = 0; axis < 3; ++axis) half(axis) = size * random.LogUniform(0.02, 1.0);
  input.receivers = Eigen::AlignedBox3d(centre - half, centre + half);
  const Eigen::Vector3d eye =
      random.Coin()
          ? Eigen::Vector3d(centre + half.cwiseProduct(random.InCube(0.9)))
          : Eigen::Vector3d(centre + random.Uniform(0.5, 3.0) * size * random.UnitVector());
  const Eigen::Vector3d target = centre + half.cwiseProduct(random.InCube(0.8));
  input.camera = *LookAtCamera(eye,
                               target,
                               random.UnitVector(),
                               random.Uniform(0.4, 1.6),
                               random.Int(16, 640),
                               random.Int(16, 640));
  input.camera.near = size * random.LogUniform(1e-3, 0.3);
  input.camera.far = input.camera.near + size * random.LogUniform(0.5, 20.0);
  if (random.Coin()) {
    input.light = Light::Directional("sun", random.LogUniform(0.1, 10.0) * random.UnitVector());
  } else {
    input.light =
        Light::Point("lamp", centre + size * random.LogUniform(0.03, 300.0) * random.UnitVector());
  }
  input.map = {random.Int(1, 2048), random.Int(1, 2048)};
  return input;
}

// A random point of the convex body: a mean of its corners with random weights.
inline Eigen::Vector3d PointIn(Random& random, const std::vector<Eigen::Vector3d>& corners) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weight = 0.0;
  for (const Eigen::Vector3d& corner : corners) {
    const double share = std::pow(random.Uniform(0.0, 1.0), 8.0);
    sum += share * corner;
    weight += share;
  }
  return sum / weight;
}

// A camera at `eye` that looks level along -z, square, with its whole frustum inside the receivers,
// 1 <= depth <= 20, half of its field of view 0.5 rad; and a sun.
inline MethodInput LevelView(const Eigen::Vector3d& sun) {
  MethodInput input;
  input.light = Light::Directional("sun", sun);
  input.camera = *LookAtCamera(
      Eigen::Vector3d::Zero(), -Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY(), 1.0, 256, 256);
  input.camera.near = 1.0;
  input.camera.far = 20.0;
  input.receivers = {Eigen::Vector3d::Constant(-100.0), Eigen::Vector3d::Constant(100.0)};
  input.map = {512, 512};
  return input;
}

// Place in the map, texels.
inline Eigen::Vector2d Texel(const MethodMap& map, const Eigen::Vector3d& point) {
  return (map.map_from_world * point.homogeneous()).hnormalized().head<2>();
}

}  // namespace lightfit::testing
