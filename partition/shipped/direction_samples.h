// partition/shipped/direction_samples.h
//
// The samples of a point light as directions from it, for maps of the sphere around the light.
// In:   Samples in light space, the metric's weights.
// Out:  DirectionSample {direction, G}: the footprint of any texel there is a product with G.
//
// Ray and tensor of math.md (3) are those of the ray of length 1 here, in world axes. A texel that
// spans the vectors a and b on the sphere has the squared footprint (a'Ga + b'Gb) / 2.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/light.h"
#include "optimizer/energy/metric.h"
#include "optimizer/readback/samples.h"

namespace lightfit {

struct DirectionSample {
  Eigen::Vector3d direction;  // unit, world
  Eigen::Matrix3d G;          // world; G direction = 0
  double weight = 1.0;
};

// `samples` in light space, as SelectSamples() gives them with the identity. Those that are not
// finite are left out.
std::vector<DirectionSample> DirectionSamples(const Light& light,
                                              const Samples& samples,
                                              const MetricWeights& weights = {});

}  // namespace lightfit
