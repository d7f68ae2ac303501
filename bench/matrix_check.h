// bench/matrix_check.h
//
// Judges a finished matrix by the read-back alone, whatever the fit says about it.
// In:   a read-back, a light, which samples count, map_from_world.
// Out:  its energy, sample by sample, and how far receivers stick out of the map.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "optimizer/fit_options.h"
#include "optimizer/readback/readback.h"
#include "optimizer/readback/samples.h"

namespace lightfit {

struct MatrixQuality {
  double energy = 0.0;          // metric kL2
  double outside_texels = 0.0;  // of the receiver furthest outside; infinite where w <= 0
};

class MatrixCheck {
 public:
  static absl::StatusOr<MatrixCheck> Create(const Readback& readback,
                                            const Light& light,
                                            const SampleOptions& options);

  MatrixQuality Measure(const Eigen::Matrix4d& map_from_world, MapSize map) const;

 private:
  Eigen::Matrix<double, 4, 3> world_from_ray_;
  Samples samples_;  // in light space
  std::vector<Eigen::Vector3d> receivers_;
};

}  // namespace lightfit
