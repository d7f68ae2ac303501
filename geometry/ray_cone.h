// geometry/ray_cone.h
//
// The cone of rays that a map must cover.
// In:   homogeneous rays X of the receivers, in any linear coordinates.
// Out:  whether one map can cover them, coordinates that fit them, and the set of usable axes.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "absl/functional/function_ref.h"
#include "absl/types/span.h"
#include "geometry/polygon.h"

namespace lightfit {

// A cone of rays must leave this much of a half space free on every side (the sine of the angle,
// about a degree), or its rays count as surrounding the light: a map that covered them would spend
// nearly all its texels on grazing rays.
inline constexpr double kMinConeMargin = 0.02;

// A unit vector p with p.X > 0 on every ray, or nothing when there is none by kMinConeMargin
// (receivers all around a point light). The mean of the unit rays when that has room to spare, else
// the axis of the smallest cone around them (the point of their hull nearest to the origin, by
// Wolfe's algorithm). No rays give nothing. Of no use once a StopScope says so.
std::optional<Eigen::Vector3d> FeasibleAxis(absl::Span<const Eigen::Vector3d> rays);

// The same of rays that are too many to keep.
struct UnitRaySum {
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int64_t count = 0;

  void Add(const Eigen::Vector3d& unit_ray) {
    if (count++ == 0) first = unit_ray;
    sum += unit_ray;
  }
};
// Of all unit rays the one lowest along an axis, that is with the least dot product.
using LowestUnitRay = absl::FunctionRef<Eigen::Vector3d(const Eigen::Vector3d& axis)>;
std::optional<Eigen::Vector3d> FeasibleAxis(const UnitRaySum& rays, LowestUnitRay lowest);

// Coordinates N in which the rays fill a square of side 2 around the origin at X_3 = 1. `hull` is
// the convex hull of the rays seen along the third axis of `frame_from_ray`, as (x/z, y/z). Its
// enclosing minimum-area rectangle gives the scale and the orientation, its centroid the origin, as
// the rectangle's own centre may lie outside the hull and would leave the axes unbounded.
//
// Returns normalized_from_ray = N frame_from_ray, det N > 0, or nothing if the hull has no area:
// all receivers in one plane through the light. `hull` is replaced by its image, less vertices that
// only rounding keeps apart.
std::optional<Eigen::Matrix3d> NormalizeRays(const Eigen::Matrix3d& frame_from_ray, Polygon* hull);

// A hull thinner than this share of its length has no area: single-precision depth leaves about as
// much of a plane that is seen exactly edge-on.
inline constexpr double kMinHullAspect = 1e-6;

// The axes p = (a, b, 1) with w = p.X >= min_w on every ray of the hull (normalised: X = (x, y,
// 1)): a polygon around the origin, bounded because the hull has the origin inside. Requires that
// and min_w < 1.   math.md 1
Polygon PolarPolygon(const Polygon& hull, double min_w);

}  // namespace lightfit
