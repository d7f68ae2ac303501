// geometry/enclosing_rectangle.h
//
// Rectangles and sheared rectangles around a convex polygon.
// In:   a counter-clockwise convex polygon (ConvexHull gives one).
// Out:  an enclosing Parallelogram. A polygon without area gives one without area.
#pragma once

#include "absl/status/statusor.h"
#include "geometry/polygon.h"

namespace lightfit {

// The enclosing rectangle of least area, by rotating calipers: one of its sides lies along an edge
// of the polygon (Freeman & Shapira 1975), so the edges are all there is to try.
Parallelogram MinAreaRectangle(const Polygon& polygon);

// The same from CGAL (min_rectangle_2, GPL). Unimplemented in builds with LIGHTFIT_WITH_CGAL=OFF.
absl::StatusOr<Parallelogram> MinAreaRectangleCgal(const Polygon& polygon);

// MinAreaRectangle with the shear heuristic of Chong & Gortler, Fig. 3: where all other vertices
// overhang an edge to the same side, they are sheared back over it. Never larger in area.
Parallelogram MinAreaSkewedRectangle(const Polygon& polygon);

}  // namespace lightfit
