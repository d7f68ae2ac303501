// optimizer/readback/cover.h
//
// What one light's map must cover: the cone of rays to all receivers, or to those that the border
// would answer wrongly.
// In:   Surfaces, Light, Cover, Border.
// Out:  coordinates that fit the rays, their convex hull, their mean, and the range of depth.
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/border.h"
#include "geometry/homography.h"
#include "geometry/light.h"
#include "geometry/polygon.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

// What the map must have room for.
enum class Cover {
  kReceivers,  // every surface in view: nothing that comes to be shadowed is outside
  kShadowed    // every surface in view that the border would answer wrongly: with a lit border the
             // shadowed ones, as what is lit may lie outside the map, where a look-up finds light;
             // with a dark border the lit ones. Every surface where there are none
};

struct RayCover {
  // Normalised rays X' = N X of light-space rays X (RayFromWorld with its default frame).
  // See NormalizeRays in geometry/ray_cone.h.
  Eigen::Matrix3d normalized_from_ray = Eigen::Matrix3d::Identity();

  // The covered rays as (X'_1, X'_2) / X'_3: their convex hull, the origin strictly inside.
  Polygon hull;

  // Mean of the covered receivers' unit rays in light space, each tile's by its middle: the axis of
  // a focused shadow map. For a directional light always (0, 0, 1).
  Eigen::Vector3d mean_ray = Eigen::Vector3d::UnitZ();

  // Bounds, world units. Far is over all receivers whose rays run close to the covered ones: what
  // lies behind would be cut. Near is over the covered ones, as what is nearer to the light is lit;
  // with a dark border over all, as what is nearer may be dark. Point light: of X'_3, the depth
  // along the third row of N, which is a unit vector. Directional light: of the depth along the
  // direction of travel.
  DepthRange depth;

  Border border = Border::kLit;

  // Cover::kShadowed where the border is right about everything: all receivers are covered for want
  // of any.
  bool nothing_to_cover = false;
};

// The hull is that of the rays through the centres of all pixels to cover, exactly: tiles are
// bounded by the corners of their depth boxes, and only those that reach out of the hull found so
// far are looked into, coarse tiles before fine ones before pixels.
//
// `use_fine_cover`: and through the centres of the cells of Readback::fine_cover, if there is one,
// that have any such surface, at its nearest and furthest depth; left out where a point light has
// them all around.
//
// Of surfaces that are in one plane with the light (one pixel, two of them, a row) kShadowed covers
// what is a pixel around them. Without any, or with all seen edge-on, it covers every receiver.
//
// FailedPrecondition when the receivers to cover surround a point light, or all lie in one plane
// with the light; CancelledError once a StopScope says so.
absl::StatusOr<RayCover> CoverReceivers(const Surfaces& surfaces,
                                        const Light& light,
                                        Cover cover = Cover::kReceivers,
                                        Border border = Border::kLit,
                                        bool use_fine_cover = false);

// The cover of rays that are known by their hull alone: `rays` in light space, `depth` as in
// RayCover for a directional light, distances from a point light. `mean_ray` is not used where it
// is zero. FailedPrecondition as CoverReceivers().
absl::StatusOr<RayCover> CoverRays(absl::Span<const Eigen::Vector3d> rays,
                                   DepthRange depth,
                                   const Eigen::Vector3d& mean_ray,
                                   const Light& light);

// FailedPrecondition: receivers all around the light. For those who find out by other means.
absl::Status SurroundedError(const Light& light);

}  // namespace lightfit
