// optimizer/readback/cover.h
//
// What one light's map must cover: the cone of rays to all receivers, or to the shadowed ones.
// In:   Surfaces, Light, Cover.
// Out:  coordinates that fit the rays, their convex hull, their mean, and the range of depth.
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/homography.h"
#include "geometry/light.h"
#include "geometry/polygon.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

// What the map must have room for.
enum class Cover {
  kReceivers,  // every surface in view: nothing that comes to be shadowed is outside
  kShadowed  // every shadowed surface in view: what is lit may lie outside the map, where a look-up
             // finds light. Every surface where the shadow has no area
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

  // Bounds, world units: near over the covered receivers, far over all whose rays run close to
  // theirs. Point light: of X'_3, the depth along the third row of N, which is a unit vector.
  // Directional light: of the depth along the direction of travel.
  DepthRange depth;

  // Cover::kShadowed where nothing is shadowed: all receivers are covered for want of any.
  bool nothing_shadowed = false;
};

// The hull is that of the rays through the centres of all pixels to cover, exactly: tiles are
// bounded by the corners of their depth boxes, and only those that reach out of the hull found so
// far are looked into, coarse tiles before fine ones before pixels.
//
// Without any shadowed surface, or with all of them in one plane with the light (one pixel, a row
// of them), kShadowed covers every receiver.
//
// FailedPrecondition when the receivers to cover surround a point light, or all lie in one plane
// with the light; CancelledError once a StopScope says so.
absl::StatusOr<RayCover> CoverReceivers(const Surfaces& surfaces,
                                        const Light& light,
                                        Cover cover = Cover::kReceivers);

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
