// optimizer/energy/summary.h
//
// Thirty-six numbers replace the samples: energy and gradient of any map in O(1).
// In:   Samples and their RayCover.
// Out:  Summary {tensor, weight, counts, cover}, about a kilobyte.
//       math.md 4, (6)-(8)
//
// Summaries add: optimizer/energy/summary_total.h.
//
// Symbols: T tensor, X normalised ray, G = D'D, p axis, [r1 r2 r3] = H^-1.
#pragma once

#include <Eigen/Core>

#include "optimizer/energy/footprint.h"
#include "optimizer/readback/cover.h"
#include "optimizer/readback/samples.h"

namespace lightfit {

// Entries (0,0), (0,1), (0,2), (1,1), (1,2), (2,2) of a symmetric 3x3 matrix.
using SymmetricVector = Eigen::Matrix<double, 6, 1>;
SymmetricVector ToSymmetricVector(const Eigen::Matrix3d& symmetric);
Eigen::Matrix3d FromSymmetricVector(const SymmetricVector& entries);

// The 6x6 matrix that maps the entries of a symmetric A to those of M A M'.
Eigen::Matrix<double, 6, 6> SymmetricCongruence(const Eigen::Matrix3d& m);

// T_(ab)(cd) = sum of weight X_a X_b G_cd: rows run over (ab), columns over (cd).   math.md (6)
class EnergyTensor {
 public:
  EnergyTensor() : entries_(Eigen::Matrix<double, 6, 6>::Zero()) {}
  explicit EnergyTensor(const Eigen::Matrix<double, 6, 6>& entries) : entries_(entries) {}

  const Eigen::Matrix<double, 6, 6>& entries() const { return entries_; }

  // sum of weight w^2 G with w = p.X: what every energy at this axis is made of.
  Eigen::Matrix3d AtAxis(const Eigen::Vector3d& p) const;

  // math.md (7) and (8): as Energy() and EnergyAndGradient() of optimizer/energy/footprint.h.
  double Energy(const Eigen::Matrix3d& map_from_ray) const;
  EnergyGradient EnergyAndGradient(const Eigen::Matrix3d& map_from_ray) const;

  // The tensor in coordinates X' = N X: G' = N^-T G N^-1.
  EnergyTensor Transformed(const Eigen::Matrix3d& new_from_old) const;

  // Q = sum of weight (X X') (x) G as a 9x9 matrix on z = p (x) r, index 3 a + c, so that
  // Energy = z1'Q z1 + z2'Q z2.
  Eigen::Matrix<double, 9, 9> AsQuadraticForm() const;

 private:
  Eigen::Matrix<double, 6, 6> entries_;
};

struct Summary {
  EnergyTensor tensor;  // in the cover's normalised rays
  MetricWeights metric;
  double total_weight = 0.0;
  // L1 metrics: the weighted sum of what the samples were weighted by one over, their footprints,
  // so that sqrt(energy * footprint_sum) bounds the sum of footprints from above, and equals it
  // where they are all in proportion (Cauchy & Schwarz). Else 0.
  double footprint_sum = 0.0;
  SampleCounts counts;
  FacingSource facing = FacingSource::kGuessed;  // of every read-back that is in it
  RayCover cover;
};

// One vectorised pass over the samples, whose rays must be in the cover's coordinates. The result
// does not depend on the processor's vector width. Of no use once a StopScope says so.
Summary SummarizeSamples(const Samples& samples,
                         const RayCover& cover,
                         const MetricWeights& metric);

}  // namespace lightfit
