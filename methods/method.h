// methods/method.h : the published ways to set up a shadow map, under one signature.
//
// In:      MethodInput {light, view camera with clip planes, box of the receivers, map size}.
// Out:     MethodMap {map_from_world, note}.
// Flow:    view frustum and box -> body of what must be covered -> the method's homography of the
//          light's rays -> enclosing rectangle -> map.
// Symbols: as in optimizer/; n, f near and far distances in the warped frame.
// Errors:  InvalidArgument: an input is wrong. FailedPrecondition: there is no such map (a point
//          light among its receivers, all of them edge-on to the light); the message says why.
//
// A map covers all receivers in view, w > 0 on them, and sends each light ray to one texel.
// docs/methods.md compares the methods; each has a file of its own, with its options.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "geometry/camera.h"
#include "geometry/light.h"
#include "geometry/map_size.h"

namespace lightfit {

struct MethodInput {
  Light light;
  Camera camera;  // of the view; near and far are finite, 0 < near < far, world units
  Eigen::AlignedBox3d receivers;  // around everything that receives shadow, world
  MapSize map;

  // PlaneOptimalMap: the plane that gets one texel per pixel (methods/dominant_plane.h finds one).
  // Absent: the lit inner face of `receivers` that the camera sees most of.
  std::optional<Eigen::Hyperplane<double, 3>> plane;

  // What is in view counts only where cut.(x, 1) >= 0 for every one of them, world: a part of the
  // view, one map of several. kStandard has the whole box all the same.
  std::vector<Eigen::Vector4d> cuts = {};
};

struct MethodMap {
  // Homogeneous (u w, v w, z w, w) as LightMatrix::map_from_world: texels, (0, 0) at the corner.
  Eigen::Matrix4d map_from_world = Eigen::Matrix4d::Identity();

  // Empty, or how the method fell back as its paper says: "focused: the light is along the view".
  std::string note;
};

enum class Method {
  kStandard,      // the whole light frustum: all receivers, in view or not
  kFocused,       // tight around what is in view
  kTrapezoidal,   // TSM: Martin & Tan 2004, 80 % line
  kLispsmSimple,  // LiSPSM: Wimmer et al. 2004, n = (near + sqrt(near far)) / sin of the angle
  kLispsm,        // ... with the general formula for n
  kPerspective,   // PSM: Stamminger & Drettakis 2002, with Kozlov's pull-back for lights behind
  kPlaneOptimal   // Chong & Gortler 2004
};

const std::vector<Method>& AllMethods();

// "standard", "focused", "tsm", "lispsm-simple", "lispsm", "psm", "plane-optimal".
const char* MethodName(Method method);
absl::StatusOr<Method> ParseMethod(const std::string& name);

absl::StatusOr<MethodMap> SetUpMap(Method method, const MethodInput& input);

}  // namespace lightfit
