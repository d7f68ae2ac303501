// methods/view_body.h
//
// What a shadow map must cover: the part of the receivers' box that the camera can see.
// In:   a camera with clip planes, 0 < near < far; a box, world.
// Out:  corners of the convex body  view frustum ∩ box, or of a part of it, world; the view's own
//       directions.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "absl/types/span.h"
#include "geometry/camera.h"

namespace lightfit {

// The near face first, then the far one, each around its outline and beginning at the same corner.
std::array<Eigen::Vector3d, 8> FrustumCorners(const Camera& camera);

// The face of least z first, then that of greatest, each around its outline.
std::array<Eigen::Vector3d, 8> BoxCorners(const Eigen::AlignedBox3d& box);

// Inside is plane.(x, 1) >= 0.
std::array<Eigen::Vector4d, 6> FrustumPlanes(const Camera& camera);

// The part of a convex polygon in space that lies inside all planes. Empty when none does.
std::vector<Eigen::Vector3d> ClipPolygon(std::vector<Eigen::Vector3d> polygon,
                                         absl::Span<const Eigen::Vector4d> planes);

// All corners of the intersection, some of them more than once; empty when the camera sees nothing
// of the box. Each corner lies on a face of the frustum that is inside the box, or the other way
// around, so the faces of both are clipped by the other's planes. `cuts` are more planes, inside as
// above: those of a plane's own face lie on edges of the body, and so on other faces too.
std::vector<Eigen::Vector3d> ViewBody(const Camera& camera,
                                      const Eigen::AlignedBox3d& box,
                                      absl::Span<const Eigen::Vector4d> cuts = {});

Eigen::Vector3d EyePosition(const Camera& camera);
Eigen::Vector3d ViewDirection(const Camera& camera);  // unit, along camera z

// Planar distance in front of the camera, world units.
double CameraDepth(const Camera& camera, const Eigen::Vector3d& point);

// Range of CameraDepth() over the points, of which there is at least one.
struct ViewDepths {
  double least = 0.0;
  double greatest = 0.0;
};
ViewDepths ViewDepthsOf(const Camera& camera, absl::Span<const Eigen::Vector3d> points);

// Rows x, y and w of the screen point in pixels, (x w, y w, w), of a homogeneous world point. w is
// the camera depth, or 1 for an orthographic camera.
Eigen::Matrix<double, 3, 4> PixelFromWorld(const Camera& camera);

}  // namespace lightfit
