// methods/lispsm.h
//
// Light-space perspective shadow maps, with the simple and the general choice of n.
// In:   MethodInput; the choice of n.
// Out:  the map of a perspective frustum laid along the view in the light's image plane.
//
// Wimmer, Scherzer & Purgathofer 2004 (EGSR); Wimmer & Scherzer 2006 (ShaderX4). The frustum's
// centre lies n in front of the body on the viewer's side. With b along the view, texels per unit
// of b grow like 1 / (n + b)^2 and pixels per unit like 1 / z, z the camera depth at b. The choices
// make (n + b)^2 / z equal at both ends, z0 and z1 the camera depths there:
//
//   general:  n = (z0 + sqrt(z0 z1)) / sin(angle between light and view),  z1 = z0 + sin(angle) d,
//             z0 at the corner where the body begins along b, d the body's length along b;
//   simple:   n = (near + sqrt(near far)) / sin(angle), with the camera's clip planes.
//
// The body need not begin along b at its nearest corner. For a light within the cone of the view it
// is a corner of the far plane, and the nearest depth in its place would warp the map much too far:
// eleven times the texels that a light straight behind the viewer needs, instead of about two, for
// far = 1000 near. The authors' program takes the nearest corner's.
//
// n grows without bound as the light aligns with the view, and the map turns into the focused one
// with its sides along the view. A point light is set up in the image plane of its frustum (the
// paper's post-perspective light space): the slope of camera depth along b is taken at the light
// depth of the corner where the body begins.
//
// Edge cases: light along the view, or an orthographic view (whose pixels do not shrink with
// depth): the focused map, and the note says so.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "absl/status/statusor.h"
#include "methods/method.h"

namespace lightfit {

struct LispsmOptions {
  enum class Formula { kGeneral, kSimple };
  Formula formula = Formula::kGeneral;

  // n is multiplied by this, > 0. The papers have 1; engines weaken or strengthen the warp with it.
  double n_scale = 1.0;

  // Takes the place of the formula: distance in the light's image plane, > 0. World units for a
  // directional light; at unit distance for a point light.
  std::optional<double> n;

  // The frustum's axis goes through this world point as the light sees it. The eye if absent, which
  // keeps left and right alike; engines take a corner of the near plane.
  std::optional<Eigen::Vector3d> centre;
};

absl::StatusOr<MethodMap> LispsmMap(const MethodInput& input, const LispsmOptions& options = {});

}  // namespace lightfit
