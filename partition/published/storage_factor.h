// partition/published/storage_factor.h
//
// How much wider a map's texels are than the image's pixels, and how many texels a plan needs so
// that none is, for any view and light.
// In:      a map or a plan; the view; the corners of what the map serves.
// Out:     BeamErrors {along u, along v}; the storage factor, texels per pixel of the image.
// Symbols: X ray, R = H^-1, w = h3.X, r1 column of R; z camera depth.  docs/published_plans.md
//
// Lloyd et al. 2006, 4.2 and 4.4: the error is the width of a texel's beam of light over that of a
// pixel's beam, whatever surface they meet, at its worst in each direction of the map. A plan whose
// every map had M_u W by M_v H texels would have no error above 1: that is its storage factor.
//
// Differs from the paper: for point lights too, widths are those at the receiver, across its ray;
// and pixels need not be square (the width is the root of their area).
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/camera.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "methods/method.h"
#include "partition/plan.h"

namespace lightfit {

// Largest errors over some points, for an image of one pixel.
struct BeamErrors {
  double u = 0.0;  // the side of a texel along u
  double v = 0.0;  // the texel's extent across that side
};

// Of a map of the light, in its own texels. Both errors are largest at corners of a convex body
// (of a quadratic over a linear function), exactly so for directional lights.
absl::StatusOr<BeamErrors> MaxBeamErrors(const Eigen::Matrix4d& map_from_world,
                                         const Light& light,
                                         const Camera& camera,
                                         absl::Span<const Eigen::Vector3d> corners);

// The sum over the maps of W M_u H M_v, each over what is in view of its half spaces. A map that
// serves nothing in view counts nothing.
absl::StatusOr<double> StorageFactor(const Plan& plan, const MethodInput& input);

}  // namespace lightfit
