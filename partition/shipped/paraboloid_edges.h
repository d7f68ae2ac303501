// partition/shipped/paraboloid_edges.h : how finely casters must be tessellated for a paraboloid.
//
// In:      the ends of an edge as the light sees them; or a mesh's longest edge and its distance.
// Out:     how far its chord is off its arc, and the longest edge that a map of some size bears.
// Symbols: m unit normal of the plane through light and edge, R = 1 / |m_z| radius of the arc, c
//          chord, phi angle of the edge seen from the light.
//
// A rasteriser draws an edge straight between its ends, where the paraboloid has an arc of a circle
// through two opposite points of the rim. Osman et al. 2006 (3) call for tessellation
// by the size of triangles in the map; how far an edge is off is known:
//   s = R - sqrt(R^2 - c^2 / 4),   s <= phi^2 / 8,   in radii of the disc.
// docs/published_plans.md
#pragma once

#include <Eigen/Core>

namespace lightfit {

// s of an edge that is seen in one half, in radii of the disc (size / 2 texels). `from` and `to`:
// unit, in the half's frame, of z >= 0 and not opposite. 0 for an edge towards the light.
double ChordError(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

// The widest angle, radians, at which an edge is off by at most `max_error_texels` in maps of
// `size` texels a side: sqrt(16 max_error_texels / size). 5.1 degrees for half a texel of 1024.
double WidestEdge(int size, double max_error_texels);

// The widest angle, radians, at which the light can see an edge of `length` that is nowhere nearer
// than `distance`, > 0: 2 atan(length / (2 distance)).
double EdgeAngleBound(double length, double distance);

// Into how many equal parts the edges of a mesh must be cut, so that none is off by more than
// `max_error_texels`, > 0: by its longest edge, and its distance from the light, which is > 0. At
// most kMostEdgeParts.
int EdgeParts(double longest_edge, double distance, int size, double max_error_texels);
inline constexpr int kMostEdgeParts = 1 << 20;

}  // namespace lightfit
