#include "optimizer/energy/summary.h"

#include <Eigen/LU>

#include "optimizer/energy/summary_kernel.h"

namespace lightfit {

namespace {

constexpr int kRow[6] = {0, 0, 0, 1, 1, 2};
constexpr int kColumn[6] = {0, 1, 2, 1, 2, 2};
// How often an entry stands in the full 3x3 matrix.
constexpr double kMultiplicity[6] = {1, 2, 2, 1, 2, 1};
// Where entry (a, b) of the full matrix stands among the six.
constexpr int kIndex[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};

// The contraction of a symmetric matrix with p p' as a dot product with its six entries.
SymmetricVector OuterSquare(const Eigen::Vector3d& p) {
  SymmetricVector outer;
  for (int i = 0; i < 6; ++i) outer(i) = kMultiplicity[i] * p(kRow[i]) * p(kColumn[i]);
  return outer;
}

}  // namespace

SymmetricVector ToSymmetricVector(const Eigen::Matrix3d& symmetric) {
  SymmetricVector entries;
  for (int i = 0; i < 6; ++i) entries(i) = symmetric(kRow[i], kColumn[i]);
  return entries;
}

Eigen::Matrix3d FromSymmetricVector(const SymmetricVector& entries) {
  Eigen::Matrix3d symmetric;
  for (int i = 0; i < 6; ++i) {
    symmetric(kRow[i], kColumn[i]) = symmetric(kColumn[i], kRow[i]) = entries(i);
  }
  return symmetric;
}

Eigen::Matrix3d EnergyTensor::AtAxis(const Eigen::Vector3d& p) const {
  return FromSymmetricVector(entries_.transpose() * OuterSquare(p));
}

double EnergyTensor::Energy(const Eigen::Matrix3d& map_from_ray) const {
  const Eigen::Matrix3d R = map_from_ray.inverse();
  const SymmetricVector r = OuterSquare(R.col(0)) + OuterSquare(R.col(1));
  return OuterSquare(map_from_ray.row(2)).dot(entries_ * r);
}

EnergyGradient EnergyTensor::EnergyAndGradient(const Eigen::Matrix3d& map_from_ray) const {
  const Eigen::Vector3d p = map_from_ray.row(2);
  const Eigen::Matrix3d R = map_from_ray.inverse();
  const SymmetricVector r = OuterSquare(R.col(0)) + OuterSquare(R.col(1));
  EnergyGradient result;
  result.energy = OuterSquare(p).dot(entries_ * r);
  const Eigen::Matrix3d rays = FromSymmetricVector(entries_ * r);  // T_abcd r_ic r_id
  const Eigen::Matrix3d G = AtAxis(p);                             // T_efcd p_e p_f
  result.dE_dp = 2.0 * (rays * p - R.col(0).dot(G * R.col(2)) * R.col(0) -
                        R.col(1).dot(G * R.col(2)) * R.col(1));
  return result;
}

Eigen::Matrix<double, 6, 6> SymmetricCongruence(const Eigen::Matrix3d& m) {
  constexpr int kRow[6] = {0, 0, 0, 1, 1, 2};
  constexpr int kColumn[6] = {0, 1, 2, 1, 2, 2};
  Eigen::Matrix<double, 6, 6> congruence;
  for (int i = 0; i < 6; ++i) {
    const int a = kRow[i], b = kColumn[i];
    for (int j = 0; j < 6; ++j) {
      const int c = kRow[j], d = kColumn[j];
      congruence(i, j) = m(a, c) * m(b, d);
      if (c != d) congruence(i, j) += m(a, d) * m(b, c);
    }
  }
  return congruence;
}

EnergyTensor EnergyTensor::Transformed(const Eigen::Matrix3d& new_from_old) const {
  const Eigen::Matrix3d contragredient = new_from_old.inverse().transpose();
  return EnergyTensor(SymmetricCongruence(new_from_old) * entries_ *
                      SymmetricCongruence(contragredient).transpose());
}

Eigen::Matrix<double, 9, 9> EnergyTensor::AsQuadraticForm() const {
  Eigen::Matrix<double, 9, 9> form;
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      for (int c = 0; c < 3; ++c) {
        for (int d = 0; d < 3; ++d) {
          form(3 * a + c, 3 * b + d) = entries_(kIndex[a][b], kIndex[c][d]);
        }
      }
    }
  }
  return form;
}

Summary SummarizeSamples(const Samples& samples,
                         const RayCover& cover,
                         const MetricWeights& metric) {
  Summary summary;
  summary.metric = metric;
  summary.counts = samples.counts;
  summary.cover = cover;
  for (const double weight : samples.weight) summary.total_weight += weight;
  summary.tensor = EnergyTensor(internal::AccumulateTensor(samples, metric));
  return summary;
}

}  // namespace lightfit
