// methods/perspective.h
//
// Perspective shadow maps: a uniform map of the camera's post-perspective space.
// In:   MethodInput; the pull-back of the virtual camera.
// Out:  the map that a plain perspective map of the unit cube, seen from the light's image, is.
//
// Stamminger & Drettakis 2002 (SIGGRAPH); Kozlov 2004 (GPU Gems, 14). With clip_from_world of a
// virtual camera, the light becomes L' = (v, omega) = clip_from_world L, a point v / omega or, for
// omega = 0, a direction. Seen from there, towards the middle of the cube, the map's plane of w = 0
// and its axes b1, b2 perpendicular to v are, as rows on clip space,
//
//   (b1, 0),  (b2, 0),  (-omega v / |v|^2, 1):      none moves along a ray, all times L' is 0,
//
// which has no break where omega changes its sign. The virtual camera's near and far planes enclose
// the body. w is the camera's depth for a light from straight above: n' = n of Lloyd 2006, 4.1.
//
// Lights behind the viewer have omega < 0: in clip space their rays run towards L' and not away
// from it. Published maps then reverse the depth order; here the depth row is made from the light
// itself (math.md 8) and keeps its order. A point light behind the viewer pulls the virtual camera
// back until the light is beside it (Kozlov's way to have all casters in front of the camera).
// More can be asked for: the warp fades as the pull-back grows.
//
// Where the cube would fill more than half a space as seen from L', the axis is turned towards that
// of the focused map, as little as will do, and the note says so. A lamp at the eye gives a
// uniform map of the screen. The focused map takes over for an orthographic view, for a lamp in
// the middle of the cube, and where that middle lies behind the lamp so that no turn helps.
#pragma once

#include "absl/status/statusor.h"
#include "methods/method.h"

namespace lightfit {

struct PerspectiveOptions {
  // How far the virtual camera moves back along the view, world units, >= 0; further if a point
  // light is behind it.
  double pull_back = 0.0;
};

absl::StatusOr<MethodMap> PerspectiveMap(const MethodInput& input,
                                         const PerspectiveOptions& options = {});

}  // namespace lightfit
