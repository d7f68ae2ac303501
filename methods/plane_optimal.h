// methods/plane_optimal.h
//
// Plane-optimal maps: on one plane of the scene, map and screen are the same image.
// In:   MethodInput with its plane; how much the map covers.
// Out:  the map in which the plane has a constant number of texels per pixel.
//
// Chong & Gortler 2004 (EGSR), "A lixel for every pixel". A receiver x casts the shadow point
//
//   x' = (plane . light) x - (plane . x) light
//
// along its light ray onto the plane, linear in x and homogeneous. The rows of the screen,
// (x w, y w, w) = pixel_from_world x', are then a map of the light's rays, w the camera depth of
// x'. On the plane x' is x: the map is the screen, up to the two scales of the rectangle.
//
// Off the plane nothing is promised. A light in front of the viewer sends the shadow points of what
// stands high and near behind the camera, where w < 0, and such a receiver is in no map that is
// optimal on the plane. The paper maps the plane alone; so does kScreen, and the note says when
// receivers are left out. kReceivers covers the whole body, or falls back to the focused map.
//
// The light or the camera in the plane: the focused map, and the note says so. A light on the other
// side of the plane than the camera gives a mirrored screen, which is turned over.
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "absl/status/statusor.h"
#include "methods/method.h"

namespace lightfit {

struct PlaneOptimalOptions {
  enum class Cover {
    kReceivers,  // the rectangle, sides along the screen's, around the whole body
    kScreen      // as published: the map is the screen, seen on the plane
  };
  Cover cover = Cover::kReceivers;
};

absl::StatusOr<MethodMap> PlaneOptimalMap(const MethodInput& input,
                                          const PlaneOptimalOptions& options = {});

// The face of the receivers' box that covers most of the screen, looking into the box as into a
// room, among those whose inner side the light falls on. Nothing if none is in view.
std::optional<Eigen::Hyperplane<double, 3>> MostVisibleFace(const MethodInput& input);

}  // namespace lightfit
