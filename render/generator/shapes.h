// render/generator/shapes.h
//
// Tessellated solids and tubes: what the generator puts on the floor.
// In:   a shape's parameters and about how many triangles.
// Out:  its triangles in its own space, appended to a Scene.
//
// Only additions, multiplications, divisions and square roots, which round alike everywhere: the
// same vertices on every machine.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "scenes/scene.h"

namespace lightfit {

// A closed solid: an outline, seen from above, that is scaled along a profile.
struct Solid {
  enum class Outline { kCircle, kSquare, kHexagon, kStar };
  enum class Profile { kBall, kCylinder, kCone, kCapsule, kVase };

  Outline outline = Outline::kCircle;
  Profile profile = Profile::kBall;
  double height = 2.0;       // in radii of the outline; > 0, a capsule's >= 2
  double twist_turns = 0.0;  // of the outline from bottom to top
  double bump = 0.0;         // share of the radius by which smooth waves displace the surface
  Eigen::Vector3d bump_phase_turns = Eigen::Vector3d::Zero();
};

// A closed tube around a torus knot: `around` times around the vertical while `through` times
// through the hole. (1, 0) is a plain torus.
struct Tube {
  int around = 1;
  int through = 0;
  double winding_radius = 0.4;  // of the knot about the circle of radius 1
  double tube_radius = 0.15;
};

// Solids stand on y = 0 with an outline of radius 1; tubes are centred on the origin. Appends
// within a few of `num_triangles`, at least some dozen.
void AppendSolid(const Solid& solid, int64_t num_triangles, Scene* scene);
void AppendTube(const Tube& tube, int64_t num_triangles, Scene* scene);

// Sine and cosine of an angle in turns, within 1e-13.
double SinTurns(double turns);
double CosTurns(double turns);

}  // namespace lightfit
