// tests/testing/metric_of.h
//
// A metric of a finished matrix, recomputed from its rows and the samples' own footprints.
#pragma once

#include <Eigen/Dense>
#include <cmath>

#include "geometry/light.h"
#include "optimizer/energy/footprint.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_matrix.h"
#include "optimizer/readback/samples.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit::testing {

// H of the matrix, by least squares: rows 1, 2 and 4 are H ray_from_world.
inline Eigen::Matrix3d MapFromRayOf(const LightMatrix& matrix, const Light& light) {
  const Eigen::Matrix<double, 3, 4> ray_from_world = RayFromWorld(light);
  Eigen::Matrix<double, 3, 4> rows;
  rows << matrix.map_from_world.topRows<2>(), matrix.map_from_world.row(3);
  return rows * ray_from_world.transpose() *
         (ray_from_world * ray_from_world.transpose()).inverse();
}

// The sum over the samples that `options` take, in the terms of options.metric.
inline double MetricOf(const LightMatrix& matrix,
                       const Readback& readback,
                       const Light& light,
                       const FitOptions& options) {
  const Surfaces surfaces = *FindSurfaces(readback, 1u << light.shadow_bit, options.samples);
  const Samples samples =
      SelectSamples(surfaces, light, surfaces.options, Eigen::Matrix3d::Identity(), true);
  const Eigen::Matrix3d map_from_ray = MapFromRayOf(matrix, light);
  const bool across =
      options.metric == Metric::kL2AcrossEdge || options.metric == Metric::kL1AcrossEdge;
  const bool root = options.metric == Metric::kL1 || options.metric == Metric::kL1AcrossEdge;
  double sum = 0.0;
  for (size_t i = 0; i < samples.size(); ++i) {
    const Sample sample = samples.At(i);
    const Eigen::Matrix2d J = Footprint(map_from_ray, sample);
    double squared = J.squaredNorm();
    if (across) {
      squared = options.along_edge_share * squared +
                (sample.edge_normal.isZero() ? squared
                                             : (sample.edge_normal.transpose() * J).squaredNorm());
    }
    sum += root ? std::sqrt(squared) : squared;
  }
  return sum;
}

}  // namespace lightfit::testing
