#include "optimizer/summary.h"

#include <Eigen/LU>
#include <utility>

#include "optimizer/summary_kernel.h"

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

// The 6x6 matrix that maps the entries of a symmetric A to those of M A M'.
Eigen::Matrix<double, 6, 6> CongruenceMatrix(const Eigen::Matrix3d& m) {
  Eigen::Matrix<double, 6, 6> congruence;
  for (int i = 0; i < 6; ++i) {
    const int a = kRow[i], b = kColumn[i];
    for (int j = 0; j < 6; ++j) {
      const int c = kRow[j], d = kColumn[j];
      congruence(i, j) = m(a, c) * m(b, d) + (c == d ? 0.0 : m(a, d) * m(b, c));
    }
  }
  return congruence;
}

SampleCounts AddCounts(const SampleCounts& a, const SampleCounts& b) {
  SampleCounts sum;
  sum.receivers = a.receivers + b.receivers;
  sum.invalid_depth = a.invalid_depth + b.invalid_depth;
  sum.candidates = a.candidates + b.candidates;
  sum.background = a.background + b.background;
  sum.discontinuity = a.discontinuity + b.discontinuity;
  sum.facing_away = a.facing_away + b.facing_away;
  sum.edge_on = a.edge_on + b.edge_on;
  sum.used = a.used + b.used;
  return sum;
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

EnergyTensor EnergyTensor::Transformed(const Eigen::Matrix3d& new_from_old) const {
  const Eigen::Matrix3d contragredient = new_from_old.inverse().transpose();
  return EnergyTensor(CongruenceMatrix(new_from_old) * entries_ *
                      CongruenceMatrix(contragredient).transpose());
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

absl::StatusOr<Summary> MergeSummaries(const Summary& a, const Summary& b, const Light& light) {
  if (a.metric.across_edge != b.metric.across_edge || a.metric.whole != b.metric.whole) {
    return absl::InvalidArgumentError(
        "summaries of different metrics do not add: summarise both with the same FitOptions");
  }
  const bool both_have_samples = a.counts.used > 0 && b.counts.used > 0;
  if (both_have_samples && (a.footprint_sum > 0.0) != (b.footprint_sum > 0.0)) {
    return absl::InvalidArgumentError(
        "summaries of an L1 and a squared metric do not add: summarise both with the same "
        "FitOptions");
  }
  absl::StatusOr<RayCover> cover = MergeCovers(a.cover, b.cover, light);
  if (!cover.ok()) return cover.status();
  Summary merged;
  merged.metric = a.metric;
  merged.footprint_sum = a.footprint_sum + b.footprint_sum;
  merged.total_weight = a.total_weight + b.total_weight;
  merged.counts = AddCounts(a.counts, b.counts);
  const auto moved = [&cover](const Summary& summary) {
    return summary.tensor
        .Transformed(cover->normalized_from_ray * summary.cover.normalized_from_ray.inverse())
        .entries();
  };
  merged.tensor = EnergyTensor(moved(a) + moved(b));
  merged.cover = *std::move(cover);
  return merged;
}

}  // namespace lightfit
