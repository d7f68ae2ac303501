// geometry/enclosing_parallelogram.h
//
// The enclosing parallelogram of least energy: the exact affine part of a light matrix.
// In:   a convex polygon, a 2x2 metric M, the two divisors of the energy.
// Out:  the parallelogram that minimises   edge_u' M edge_u / width^2 + edge_v' M edge_v / height^2
//       and the polygon vertices that it touches.   math.md 5 and (9)
//
// In coordinates whitened by M the parallelogram is the intersection of two strips with unit
// normals n_a, n_b. With W(n) the polygon's width along n, the energy is
//
//   E(a, b) = ( W(n_a)^2 / width^2 + W(n_b)^2 / height^2 ) / sin^2(a, b).
//
// Let K be the polygon. Rows a = n_a / W(n_a) run over the boundary of the polar of K - K, a
// centrally symmetric convex polygon with one vertex per edge direction of K and one edge per
// antipodal vertex pair c of K. For a fixed second strip the energy of the first is quasi-convex
// along that boundary, with a closed form on each edge, so the best first strip is found by walking
// downhill. What is left is a function of the second strip alone, of one variable. It is sampled
// around the boundary, at the vertices and between, and its local minima are found to rounding by
// the zeros of the slope. Alternating the two strips, or trying hull edges only, is not enough: the
// optimum need not be flush with any edge of K, and alternation sticks where the energy has a
// crease.
#pragma once

#include <Eigen/Core>
#include <array>

#include "geometry/polygon.h"

namespace lightfit {

// The vertices of the polygon that lie on the two sides of a strip, as indices. A strip touches one
// vertex on each side, or an edge (two vertices) on one of them. `low_vertex` is where the strip's
// coordinate is 0, `high_vertex` where it is 1.
struct StripContacts {
  int low_vertex = -1;
  int high_vertex = -1;
  int flush_vertex = -1;       // the third one, or -1 when the strip lies along no edge
  bool flush_on_high = false;  // which side the third one is on
};

struct EnclosingParallelogram {
  Parallelogram shape;
  double energy = 0.0;
  std::array<StripContacts, 2> contacts;  // of the strips that edge_u and edge_v span
};

// Requires a polygon with at least three vertices and area, M symmetric positive definite, and
// positive divisors.
EnclosingParallelogram MinEnergyParallelogram(const Polygon& polygon,
                                              const Eigen::Matrix2d& metric,
                                              double width,
                                              double height);

// The energy above of any parallelogram.
double ParallelogramEnergy(const Parallelogram& shape,
                           const Eigen::Matrix2d& metric,
                           double width,
                           double height);

}  // namespace lightfit
