// optimizer/search/affine.h
//
// The affine part of the map, once the axis is known.
// In:   a summary's tensor and hull, the axis p, a fitter.
// Out:  map_from_ray (H) that covers the hull, its energy, and the rays it touches.   math.md 5
#pragma once

#include <Eigen/Core>
#include <array>

#include "absl/status/statusor.h"
#include "geometry/enclosing_parallelogram.h"
#include "geometry/map_size.h"
#include "geometry/polygon.h"
#include "optimizer/search/search_options.h"

namespace lightfit {

// What the enclosing shape is fitted for: the map's size and how much the shape is grown.
struct AffineProblem {
  MapSize map;
  Affine affine = Affine::kMinEnergyParallelogram;
  RaySpace ray_space = RaySpace::kNormalized;
  Eigen::Matrix3d normalized_from_ray;  // for shapes that are rectangles in light space
  double margin_percent = 0.0;
  double margin_texels = 0.0;
};

struct AffineFit {
  Eigen::Matrix3d map_from_ray;  // from normalised rays; rows h1, h2, p
  double energy = 0.0;
  std::array<StripContacts, 2> contacts;  // kMinEnergyParallelogram only
};

// Fits around `hull` (normalised rays (x, y, 1), convex, counter-clockwise) seen along `axis`,
// which must have w = p.X > 0 on it. `metric_at_axis` is EnergyTensor::AtAxis(axis). Fails when the
// shape has no area, or the fitter is not in this build.
absl::StatusOr<AffineFit> FitAffine(const AffineProblem& problem,
                                    const Polygon& hull,
                                    const Eigen::Matrix3d& metric_at_axis,
                                    const Eigen::Vector3d& axis);

// Shares of the map, from its lower to its upper limit, that the ungrown shape occupies.
struct InnerInterval {
  double low, high;
};
InnerInterval InnerTexels(double size, double margin_percent, double margin_texels);

}  // namespace lightfit
