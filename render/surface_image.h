// render/surface_image.h
//
// What a camera sees: the surface at every pixel's centre.
// In:   a RayCaster, a Camera (its clip planes do not cut).
// Out:  SurfaceImage, row-major, top row first.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "geometry/camera.h"
#include "render/ray_caster.h"

namespace lightfit {

struct SurfacePoint {
  int triangle = -1;                                   // -1: background
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // world
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    // of the triangle, unit, towards the eye
  double camera_z = 0.0;                               // planar distance, world units

  bool is_surface() const { return triangle >= 0; }
};

struct SurfaceImage {
  Camera camera;
  std::vector<SurfacePoint> pixels;  // camera.width x camera.height
  int64_t num_surface = 0;
};

// InvalidArgument for a camera that cannot be used. An image without any surface is a result.
absl::StatusOr<SurfaceImage> RenderSurfaces(const RayCaster& caster, const Camera& camera);

}  // namespace lightfit
