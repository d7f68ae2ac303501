// tests/optimizer/figures/floor_crawl.h
//
// A floor in two frames, and maps of it: what crawl is measured on.
// In:   sizes of images, moves in texels.
// Out:  cameras, read-backs, matrices, and the Crawl between two.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "geometry/light.h"
#include "optimizer/figures/stability.h"
#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"

namespace lightfit::testing {

inline const Light kSun = Light::Directional("sun", {0.3, 0.2, -1.0});

inline Crawl Measured(const MappedFrame& before,
                      const MappedFrame& after,
                      const Light& light = kSun) {
  const absl::StatusOr<Crawl> crawl = MeasureCrawl(before, after, light);
  EXPECT_THAT(crawl, IsOk());
  return crawl.ok() ? *crawl : Crawl();
}

// A map of the floor around the origin, whose texels are smaller on one side than on the other.
inline constexpr MapSize kMap = {2000, 2000};
inline Eigen::Matrix4d FloorMap() {
  Eigen::Matrix3d map_from_ray;
  map_from_ray << 160.0, 30.0, 1000.0,  //
      -20.0, 170.0, 1000.0,             //
      0.02, -0.03, 1.0;
  const Eigen::Matrix<double, 3, 4> rows = map_from_ray * RayFromWorld(kSun);
  Eigen::Matrix4d map_from_world = Eigen::Matrix4d::Zero();
  map_from_world << rows.topRows<2>(), Eigen::RowVector4d::Zero(), rows.row(2);
  return map_from_world;
}

// The same map, all of it moved by so many texels.
inline Eigen::Matrix4d Shifted(Eigen::Matrix4d map_from_world, const Eigen::Vector2d& texels) {
  map_from_world.topRows<2>() += texels * map_from_world.row(3);
  return map_from_world;
}

// The floor with a shadow whose edge runs down the image, between columns `edge` - 1 and `edge`.
inline PlaneReadback ShadowedFloor(const Camera& camera, int edge) {
  PlaneReadback readback = FloorReadback(camera);
  readback.Cast(0, [edge](int x, int) { return x < edge; });
  return readback;
}

// FloorCamera() a step further on: most of the floor is in view of both.
inline Camera Stepped(int width = 40, int height = 30) {
  Camera camera = FloorCamera(width, height);
  camera.camera_from_world.topRightCorner<3, 1>() -= Eigen::Vector3d(0.05, -0.02, 0.2);
  return camera;
}

}  // namespace lightfit::testing
