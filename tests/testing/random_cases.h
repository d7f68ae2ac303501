// tests/testing/random_cases.h
//
// Random numbers with a fixed, printed seed, and random cameras, lights, polygons and samples.
// Scales are drawn logarithmically. Samples lie on random planes, where the derivatives of affine
// depth are exact.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <random>

#include "geometry/camera.h"
#include "geometry/light.h"
#include "geometry/polygon.h"
#include "optimizer/readback/samples.h"

namespace lightfit::testing {

// The same sequence on every platform, unlike the distributions of <random>.
class Random {
 public:
  explicit Random(uint64_t seed) : engine_(seed) {
    std::printf("[   seed   ] %llu\n", static_cast<unsigned long long>(seed));
  }

  double Uniform(double low, double high) {
    return low + (high - low) * 0x1p-53 * static_cast<double>(engine_() >> 11);
  }
  double LogUniform(double low, double high) {
    return std::exp(Uniform(std::log(low), std::log(high)));
  }
  int Int(int first, int last) {
    return first + static_cast<int>(engine_() % static_cast<uint64_t>(last - first + 1));
  }
  bool Coin() { return Int(0, 1) == 1; }
  uint32_t Bits() { return static_cast<uint32_t>(engine_() >> 32); }

  Eigen::Vector3d InCube(double half_side) {
    const double x = Uniform(-half_side, half_side), y = Uniform(-half_side, half_side);
    return {x, y, Uniform(-half_side, half_side)};
  }
  Eigen::Vector3d UnitVector() {
    while (true) {
      const Eigen::Vector3d v = InCube(1.0);
      if (v.norm() > 0.1 && v.norm() < 1.0) return v.normalized();
    }
  }
  Eigen::Matrix3d Rotation() {
    const Eigen::Vector3d axis = UnitVector();
    return Eigen::AngleAxisd(Uniform(0.0, 2.0 * M_PI), axis).toRotationMatrix();
  }
  // Rotation, scales with the given greatest ratio, rotation; determinant positive or negative.
  Eigen::Matrix2d Matrix2(double max_condition) {
    const Eigen::Rotation2Dd left(Uniform(0.0, 2.0 * M_PI)), right(Uniform(0.0, 2.0 * M_PI));
    const Eigen::Vector2d scales(1.0, (Coin() ? 1.0 : -1.0) * LogUniform(1.0 / max_condition, 1.0));
    return left.toRotationMatrix() * scales.asDiagonal() * right.toRotationMatrix();
  }

 private:
  std::mt19937_64 engine_;
};

// A camera that looks at a scene of extent `size` around the origin, from outside of it.
Camera CameraAround(Random& random, double size, bool orthographic);

// The affine depth and its screen derivatives at a screen position on the plane n.x = offset.
Eigen::Vector3d DepthOnPlane(const Camera& camera,
                             const Eigen::Vector3d& normal,
                             double offset,
                             const Eigen::Vector2d& screen);

// Samples on random planar patches, in light space and in normalised rays.
struct PatchCase {
  Camera camera;
  Light light;
  Eigen::Matrix3d normalized_from_ray;
  Polygon hull;        // of the samples' rays, normalised
  Samples raw;         // X in light space
  Samples normalized;  // X in normalised rays
};

// `distance` of a point light in scene sizes, 0 for a directional light.
PatchCase RandomPatchCase(Random& random, double distance, int num_samples);

// A point inside the polygon, which has the origin inside: `share` of the way from the origin out.
Eigen::Vector2d PointInPolygon(Random& random, const Polygon& polygon, double share);

// A map of normalised rays with its axis inside the polar polygon and a well-conditioned affine
// part: w >= 0.05 on all rays.
Eigen::Matrix3d RandomMap(Random& random, const Polygon& hull);

// A convex polygon of at most `num_points` vertices around the origin, possibly a sliver.
Polygon RandomPolygon(Random& random, int num_points, double max_aspect);

}  // namespace lightfit::testing
