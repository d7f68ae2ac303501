// methods/light_body.h
//
// The body that a map must cover, as its light sees it, and the last steps that all methods share.
// In:   MethodInput; a homography of the light's rays, up to the rectangle around the body.
// Out:  LightBody {rays}; map_from_world with the rectangle around the body as its map.
//
// A method is a *warped frame* of the rays: rows (x, y, w), points of the plane (x/w, y/w) in which
// a rectangle is fitted. Whatever the rows, points of one ray share one texel.   math.md 1
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "methods/method.h"

namespace lightfit {

struct LightBody {
  Light light;
  MapSize map;

  // Light space. The third axis of a point light goes to the middle of the body; X_3 = 1 is the
  // light's image plane.
  Eigen::Matrix<double, 3, 4> ray_from_world;

  std::vector<Eigen::Vector3d> points;  // corners of the body, world
  std::vector<Eigen::Vector3d> rays;    // ray_from_world times each; the third coordinate is > 0

  // False when the camera sees nothing of the receivers, or nothing that the light sees as an area:
  // then the body is the whole box.
  bool in_view = true;
};

// Checks light, camera, clip planes, box and map size; the message names the field.
absl::Status ValidateMethodInput(const MethodInput& input);

// The whole box; or what the camera sees of it, within the input's cuts. InvalidArgument as above;
// FailedPrecondition when the body surrounds a point light, which has no single map.
absl::StatusOr<LightBody> WholeBody(const MethodInput& input);
absl::StatusOr<LightBody> BodyInView(const MethodInput& input);

enum class RectangleTurn {
  kMinArea,   // the rectangle of least area, its longer side along the map's longer side
  kAlongRows  // sides along the rows x and y of the frame, u along x and v along y
};

// The map of a warped frame. FailedPrecondition unless w > 0 on the body and the body has an area.
absl::StatusOr<MethodMap> FitBody(const LightBody& body,
                                  const Eigen::Matrix3d& warped_from_ray,
                                  RectangleTurn turn);

// The map of a homography that has its texels already: turned over where it was mirrored as seen
// from the light, with the depth row over the body where w > 0, which is somewhere.
absl::StatusOr<MethodMap> CompleteMap(const LightBody& body, Eigen::Matrix3d map_from_ray);

// H of rows 1, 2 and 4 of a world matrix whose rays leave the light: rows = H ray_from_world.
Eigen::Matrix3d HomographyOfRows(const LightBody& body, const Eigen::Matrix<double, 3, 4>& rows);

// Least and greatest w over the body.
struct WRange {
  double least = 0.0;
  double greatest = 0.0;
};
WRange RangeOfW(const LightBody& body, const Eigen::Vector3d& axis);

}  // namespace lightfit
