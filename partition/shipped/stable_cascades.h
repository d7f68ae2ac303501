// partition/shipped/stable_cascades.h : cascaded shadow maps that do not crawl, as engines ship
// them.
//
// In:   a directional light, the camera with its clip planes, texels of all maps.
// Out:  a Plan of equal squares, one for each part of the view in depth.
//
// The view is cut by depth (practical split). A part's map is a square around the smallest sphere
// about that slice of the view, so that its size depends on the camera's lens alone; and it moves
// by whole texels of the light's frame, so that every texel stays where it is in the world however
// the camera moves and turns. What that costs is the room between slice and sphere.
//
// The technique: Valient 2008 (ShaderX6), Engel 2006 (ShaderX5).   docs/published_plans.md
//
// Edge cases: a light along the view is nothing special, as the sphere looks the same from
// everywhere. The split of an orthographic view is as asked, although its pixels do not shrink.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "absl/status/statusor.h"
#include "geometry/camera.h"
#include "geometry/light.h"
#include "partition/plan.h"

namespace lightfit {

struct StableCascadesOptions {
  int num_maps = 4;     // 1 ... kMaxPlanMaps
  double lambda = 0.5;  // 0: parts of equal length, 1: parts of equal ratio

  // Texels around the sphere on each side, for a filter. >= 0.
  double margin_texels = 0.0;
};

// FailedPrecondition for a point light. InvalidArgument for a light, camera or option out of range
// (0 < near < far, both finite), and when the budget leaves less than 2 texels to a side.
absl::StatusOr<Plan> StableCascades(const Light& light,
                                    const Camera& camera,
                                    int64_t max_texels,
                                    const StableCascadesOptions& options = {});

// The sphere around the part of the view between two depths, in camera space: the smallest of those
// with their centre on the line through the middles of the part's near and far faces, and of all
// spheres where the middle of the image is on the optical axis.
struct SliceSphere {
  Eigen::Vector3d centre;
  double radius;  // world units
};
SliceSphere SphereAroundSlice(const Camera& camera, double near, double far);

}  // namespace lightfit
