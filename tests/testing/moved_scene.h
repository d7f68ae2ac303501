// tests/testing/moved_scene.h
//
// A scene in other units and at another place: x' = scale x + offset. Whatever is fitted to it has
// the same texels on the same surfaces.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "geometry/affine_depth.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "optimizer/readback/readback.h"
#include "tests/testing/box_scene.h"
#include "tests/testing/random_cases.h"

namespace lightfit::testing {

struct Move {
  double scale = 1.0;  // a power of two leaves depths, which are single precision, what they were
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();

  // Of the origin, in units of the scene.
  double Distance() const { return offset.norm() / scale; }

  Camera Of(Camera camera) const {
    const Eigen::Matrix3d axes = camera.camera_from_world.topLeftCorner<3, 3>();
    camera.camera_from_world.topRightCorner<3, 1>() *= scale;
    camera.camera_from_world.topRightCorner<3, 1>() -= axes * offset;
    if (camera.orthographic) camera.screen_from_camera.topLeftCorner<2, 2>() /= scale;
    camera.near *= scale;
    camera.far *= scale;
    return camera;
  }
  Light Of(Light light) const {
    light.position = scale * light.position + offset;
    return light;
  }
  std::vector<Light> Of(std::vector<Light> lights) const {
    for (Light& light : lights) light = Of(light);
    return lights;
  }
  SyntheticReadback Of(SyntheticReadback readback) const {
    readback.camera = Of(readback.camera);
    for (float& depth : readback.depth) {
      if (depth != kSyntheticBackground) depth = static_cast<float>(scale * depth);
    }
    return readback;
  }
  Eigen::Matrix4d MovedFromWorld() const {
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    matrix.topLeftCorner<3, 3>() *= scale;
    matrix.topRightCorner<3, 1>() = offset;
    return matrix;
  }
};

// 1e3 to 1e8 of the scene's units away, in units of 2^-10 to 2^13 of them.
inline Move RandomMove(Random& random) {
  Move move;
  move.scale = std::ldexp(1.0, random.Int(-10, 13));
  move.offset = move.scale * random.LogUniform(1e3, 1e8) * random.UnitVector();
  return move;
}

// How far apart a surface lands in two maps at most.
struct Apart {
  double texels = 0.0;
  double depth = 0.0;  // of z, 0 ... 1
};

// Over the surfaces that the first map holds: `matrix` in the scene, `moved` in the moved one.
inline Apart HowFarApart(const Readback& readback,
                         const Eigen::Matrix4d& matrix,
                         MapSize map,
                         const Readback& moved_readback,
                         const Eigen::Matrix4d& moved) {
  const AffineDepth here(readback.camera, readback.depth_kind);
  const AffineDepth there(moved_readback.camera, moved_readback.depth_kind);
  const Eigen::Matrix4d from_screen = matrix * readback.camera.WorldFromScreen();
  const Eigen::Matrix4d from_moved_screen = moved * moved_readback.camera.WorldFromScreen();
  Apart apart;
  for (int y = 0; y < readback.height(); ++y) {
    for (int x = 0; x < readback.width(); ++x) {
      const size_t pixel = readback.Index(x, y);
      if (!here.IsSurface(readback.depth[pixel])) continue;
      const double d = here.At(x, y, readback.depth[pixel]);
      const double moved_d = there.At(x, y, moved_readback.depth[pixel]);
      const Eigen::Vector4d at = from_screen * Eigen::Vector4d(x + 0.5, y + 0.5, d, 1.0);
      const Eigen::Vector3d first = at.hnormalized();
      if (!(at.w() > 0.0) || first.x() < 0.0 || first.y() < 0.0 || first.x() > map.width ||
          first.y() > map.height) {
        continue;
      }
      const Eigen::Vector3d second =
          (from_moved_screen * Eigen::Vector4d(x + 0.5, y + 0.5, moved_d, 1.0)).hnormalized();
      const Eigen::Vector3d difference = (first - second).cwiseAbs();
      apart.texels = std::max({apart.texels, difference.x(), difference.y()});
      apart.depth = std::max(apart.depth, difference.z());
    }
  }
  return apart;
}

}  // namespace lightfit::testing
