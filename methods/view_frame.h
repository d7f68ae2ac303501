// methods/view_frame.h
//
// The light's image plane, turned along the view: where trapezoids and light-space perspective
// frusta are built.
// In:   LightBody, camera, the direction of the line from the eye.
// Out:  ViewFrame: axes across and along that line, the body's extent along it; a warp along it.
//
// Symbols: a across and b along the line, in the image plane X_3 = 1 (world units for a directional
// light, the tangent of an angle for a point light); b = 0 where the body begins on the viewer's
// side; n distance from the centre of the warp to b = 0.
//
// The light and the line span a plane, l = X(eye) x X(direction). As a covector on rays it is the
// row whose zero is the line itself, so a = l.X / (X_3 |l_xy|), for lights of both kinds and also
// when the eye is behind the light.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "geometry/camera.h"
#include "methods/light_body.h"

namespace lightfit {

struct ViewFrame {
  Eigen::RowVector3d across;  // a X_3 = across.X, 0 on the line
  Eigen::RowVector3d along;   // b X_3 = along.X, 0 ... length over the body
  double length = 0.0;        // of the body along b

  // Camera depth gained per unit of b on a plane of constant depth in front of the light that has
  // X_3 = 1, > 0: the sine of the angle between light and line for a directional light.
  double depth_slope = 0.0;

  // From the plane through the eye and the line, as a covector on rays, which has a direction in
  // the image plane; b begins at 0 there. The length and the slope are not known yet.
  static ViewFrame OfPlane(const Eigen::Vector3d& plane);

  // b grows the other way.
  void TurnAround();

  // Lets b run from 0 to the length over the body.
  void LayOver(const LightBody& body);

  // Frame with the projective centre n in front of b = 0, for `one_over_n` = 1/n >= 0; 0 is the
  // unwarped frame. Rows a, b, and w = X_3 (1 + b/n), so that w > 0 on the body.
  Eigen::Matrix3d Warped(double one_over_n) const;
};

// Nothing when the line has no direction in the image plane: the light is on it or along it to
// within kAligned, and every direction is as good as any other.
std::optional<ViewFrame> AlongView(const LightBody& body,
                                   const Camera& camera,
                                   const Eigen::Vector3d& direction);

// Sine of an angle.
inline constexpr double kAligned = 1e-7;

}  // namespace lightfit
