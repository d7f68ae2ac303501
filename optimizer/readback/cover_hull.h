// optimizer/readback/cover_hull.h
//
// The convex hull of the rays that one light's map must cover.
// In:   CoveredSurfaces, a frame.
// Out:  the hull, seen along the frame's third axis.
#pragma once

#include "geometry/polygon.h"
#include "optimizer/readback/covered_surfaces.h"

namespace lightfit {

// That of the rays through the centres of all pixels to cover, exactly, as (x/z, y/z). All must
// have z > 0. Looks only into tiles whose box reaches out of the hull found so far. Of no use once
// a StopScope says so.
Polygon ExactHull(const CoveredSurfaces& covered, const Matrix34d& frame_from_screen);

// The same with a pixel all around each centre, at its affine depth, as an edge lies anywhere
// between a centre and the next: for one pixel or a row of them, whose centres have no area. Empty
// where they are no row, but a surface that is edge-on to the light; and where any has z <= 0.
Polygon HullOfSurroundings(const CoveredSurfaces& covered, const Matrix34d& frame_from_screen);

}  // namespace lightfit
