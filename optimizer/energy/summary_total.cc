#include "optimizer/energy/summary_total.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <optional>
#include <utility>

#include "absl/strings/str_format.h"
#include "geometry/ray_hull.h"
#include "optimizer/readback/cover.h"

namespace lightfit {

namespace {

// Fine enough for what three doubles hold, and for lights at a million times the scene's size.
using Wide = boost::multiprecision::number<boost::multiprecision::cpp_bin_float_100::backend_type,
                                           boost::multiprecision::et_off>;

// Plain loops over arrays: Eigen on such numbers took longer to compile than any other source.
template <size_t n>
using WideMatrix = std::array<std::array<Wide, n>, n>;

template <size_t n>
WideMatrix<n> ToWide(const Eigen::Matrix<double, static_cast<int>(n), static_cast<int>(n)>& m) {
  WideMatrix<n> wide;
  for (size_t i = 0; i < n; ++i) {
    for (size_t j = 0; j < n; ++j) wide[i][j] = m(static_cast<int>(i), static_cast<int>(j));
  }
  return wide;
}

WideMatrix<3> Inverse(const WideMatrix<3>& m) {
  WideMatrix<3> adjugate;
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) {
      const size_t r = (j + 1) % 3, s = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
      adjugate[i][j] = m[r][c] * m[s][d] - m[r][d] * m[s][c];
    }
  }
  const Wide determinant =
      m[0][0] * adjugate[0][0] + m[0][1] * adjugate[1][0] + m[0][2] * adjugate[2][0];
  for (auto& row : adjugate) {
    for (Wide& entry : row) entry /= determinant;
  }
  return adjugate;
}

// SymmetricCongruence() of optimizer/energy/summary.h, with `transposed` that of the transposed.
WideMatrix<6> Congruence(const WideMatrix<3>& m, bool transposed) {
  constexpr size_t kRow[6] = {0, 0, 0, 1, 1, 2};
  constexpr size_t kColumn[6] = {0, 1, 2, 1, 2, 2};
  const auto at = [&](size_t i, size_t j) { return transposed ? m[j][i] : m[i][j]; };
  WideMatrix<6> congruence;
  for (size_t i = 0; i < 6; ++i) {
    const size_t a = kRow[i], b = kColumn[i];
    for (size_t j = 0; j < 6; ++j) {
      const size_t c = kRow[j], d = kColumn[j];
      congruence[i][j] = at(a, c) * at(b, d);
      if (c != d) congruence[i][j] += at(a, d) * at(b, c);
    }
  }
  return congruence;
}

// The nearest sum of so many doubles.
void AddWide(Wide value, int num_parts, ExactSum* sum) {
  for (int part = 0; part < num_parts; ++part) {
    const auto rounded = value.convert_to<double>();
    sum->Add(rounded);
    value -= rounded;
  }
}

Wide ToWide(const ExactSum& sum) {
  Wide value = 0;
  for (const double part : sum.Parts()) value += part;
  return value;
}

// How many doubles hold what the way to light space and back takes, which is the fourth power of
// the frame's condition: two for lights within some ten scene sizes, three up to a million.
int NumParts(const Eigen::Matrix3d& normalized_from_ray) {
  constexpr double kMostForTwo = 1e3;
  const double condition = normalized_from_ray.norm() * normalized_from_ray.inverse().norm();
  return condition <= kMostForTwo ? 2 : 3;
}

// The tensor in coordinates X' = N X, math.md 4: N acts on the first pair of indices, its
// contragredient on the second.
WideMatrix<6> Transformed(const WideMatrix<6>& tensor,
                          const WideMatrix<3>& new_from_old,
                          const WideMatrix<3>& old_from_new) {
  const WideMatrix<6> on_rays = Congruence(new_from_old, /*transposed=*/false);
  const WideMatrix<6> on_metric = Congruence(old_from_new, /*transposed=*/true);
  WideMatrix<6> half = {}, result = {};
  for (size_t i = 0; i < 6; ++i) {
    for (size_t j = 0; j < 6; ++j) {
      for (size_t k = 0; k < 6; ++k) half[i][j] += on_rays[i][k] * tensor[k][j];
    }
  }
  for (size_t i = 0; i < 6; ++i) {
    for (size_t j = 0; j < 6; ++j) {
      for (size_t k = 0; k < 6; ++k) result[i][j] += half[i][k] * on_metric[j][k];
    }
  }
  return result;
}

// Whether samples may sum to it: no energy of theirs is negative, math.md (7).
bool IsSumOfSamples(const EnergyTensor& tensor) {
  constexpr double kRounding = 1e-9;  // share of the largest eigenvalue
  const Eigen::Matrix<double, 9, 9> form = tensor.AsQuadraticForm();
  if (!form.allFinite()) return false;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> solver(form,
                                                                          Eigen::EigenvaluesOnly);
  const auto& eigenvalues = solver.eigenvalues();  // in ascending order
  return eigenvalues(0) >= -kRounding * eigenvalues(8);
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
  sum.beyond_map = a.beyond_map + b.beyond_map;
  sum.used = a.used + b.used;
  return sum;
}

// A point light's depths along the cover's axis as distances from the light. The far one holds for
// all rays that RayCover::depth speaks of, up to four times the square around the covered ones.
DepthRange DistancesOf(const RayCover& cover) {
  constexpr double kCloseBy = 4.0;
  const Eigen::Matrix3d ray_from_normalized = cover.normalized_from_ray.inverse();
  double most = 1.0;
  for (const double x : {-kCloseBy, kCloseBy}) {
    for (const double y : {-kCloseBy, kCloseBy}) {
      most = std::max(most, (ray_from_normalized * Eigen::Vector3d(x, y, 1.0)).norm());
    }
  }
  return {cover.depth.near, cover.depth.far * most};
}

bool SameLight(const Light& a, const Light& b) {
  if (a.name != b.name || a.kind != b.kind) return false;
  return a.kind == Light::Kind::kPoint ? a.position == b.position : a.direction == b.direction;
}

std::string PlaceText(const Light& light) {
  const bool is_point = light.kind == Light::Kind::kPoint;
  const Eigen::Vector3d& place = is_point ? light.position : light.direction;
  return absl::StrFormat("\"%s\" with %s (%.17g, %.17g, %.17g)",
                         light.name,
                         is_point ? "position" : "direction",
                         place.x(),
                         place.y(),
                         place.z());
}

}  // namespace

SummaryTotal TotalOf(const Summary& summary, const Light& light) {
  const RayCover& cover = summary.cover;
  SummaryTotal total;
  total.light = light;
  total.metric = summary.metric;
  total.border = cover.border;
  total.facing = summary.facing;
  total.is_l1 = summary.footprint_sum > 0.0;
  total.num_frames = 1;
  const WideMatrix<3> normalized_from_ray = ToWide<3>(cover.normalized_from_ray);
  const WideMatrix<3> ray_from_normalized = Inverse(normalized_from_ray);
  const WideMatrix<6> tensor =
      Transformed(ToWide<6>(summary.tensor.entries()), ray_from_normalized, normalized_from_ray);
  const int num_parts = NumParts(cover.normalized_from_ray);
  for (int i = 0; i < 36; ++i) AddWide(tensor[i / 6][i % 6], num_parts, &total.tensor[i]);
  total.total_weight.Add(summary.total_weight);
  total.footprint_sum.Add(summary.footprint_sum);
  total.counts = summary.counts;
  if (cover.nothing_to_cover) return total;
  const bool is_point = light.kind == Light::Kind::kPoint;
  Eigen::Matrix3d rounded_ray_from_normalized;
  for (int i = 0; i < 9; ++i) {
    rounded_ray_from_normalized(i / 3, i % 3) =
        ray_from_normalized[i / 3][i % 3].convert_to<double>();
  }
  std::vector<Eigen::Vector3d> rays;
  for (const Eigen::Vector2d& vertex : cover.hull) {
    const Eigen::Vector3d ray = rounded_ray_from_normalized * vertex.homogeneous();
    rays.push_back(is_point ? ray.normalized() : Eigen::Vector3d(ray / ray.z()));
  }
  std::optional<std::vector<Eigen::Vector3d>> hull = ExtremeRays(std::move(rays));
  total.surrounded = !hull.has_value();
  if (hull.has_value()) total.hull = *std::move(hull);
  for (int i = 0; i < 3; ++i) total.mean_ray[i].Add(cover.mean_ray(i));
  total.depth = is_point ? DistancesOf(cover) : cover.depth;
  return total;
}

absl::Status AddToTotal(const SummaryTotal& other, SummaryTotal* total) {
  if (!SameLight(other.light, total->light)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("summaries of different lights do not add: %s, and %s. A light that moves "
                        "needs a map for each of its places",
                        PlaceText(total->light),
                        PlaceText(other.light)));
  }
  if (other.metric.across_edge != total->metric.across_edge ||
      other.metric.whole != total->metric.whole) {
    return absl::InvalidArgumentError(
        absl::StrFormat("light \"%s\": summaries of different metrics do not add: summarise all "
                        "frames with the same FitOptions",
                        total->light.name));
  }
  if (other.border != total->border) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "light \"%s\": summaries for a lit and for a dark border do not add: summarise all frames "
        "with the same FitOptions",
        total->light.name));
  }
  const bool both_have_samples = other.counts.used > 0 && total->counts.used > 0;
  if (both_have_samples && other.is_l1 != total->is_l1) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "light \"%s\": summaries of an L1 and a squared metric do not add: summarise all frames "
        "with the same FitOptions",
        total->light.name));
  }
  total->is_l1 = total->is_l1 || other.is_l1;
  if (other.facing == FacingSource::kGuessed) total->facing = FacingSource::kGuessed;
  total->num_frames += other.num_frames;
  for (int i = 0; i < 36; ++i) total->tensor[i].Add(other.tensor[i]);
  total->total_weight.Add(other.total_weight);
  total->footprint_sum.Add(other.footprint_sum);
  total->counts = AddCounts(total->counts, other.counts);
  for (int i = 0; i < 3; ++i) total->mean_ray[i].Add(other.mean_ray[i]);
  total->depth = {std::min(total->depth.near, other.depth.near),
                  std::max(total->depth.far, other.depth.far)};
  std::vector<Eigen::Vector3d> rays = std::move(total->hull);
  rays.insert(rays.end(), other.hull.begin(), other.hull.end());
  std::optional<std::vector<Eigen::Vector3d>> hull = ExtremeRays(std::move(rays));
  total->surrounded = total->surrounded || other.surrounded || !hull.has_value();
  total->hull.clear();
  if (!total->surrounded) total->hull = *std::move(hull);
  return absl::OkStatus();
}

absl::StatusOr<Summary> SummaryOfTotal(const SummaryTotal& total) {
  if (total.surrounded) return SurroundedError(total.light);
  if (total.hull.empty()) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "light \"%s\": none of its %d frames shows any of its shadow, so there is nothing to fit. "
        "Leave the light out of the shot, or cover all receivers (options.cover = kReceivers)",
        total.light.name,
        total.num_frames));
  }
  const Eigen::Vector3d mean_ray(
      total.mean_ray[0].Value(), total.mean_ray[1].Value(), total.mean_ray[2].Value());
  absl::StatusOr<RayCover> cover = CoverRays(total.hull, total.depth, mean_ray, total.light);
  if (!cover.ok()) return cover.status();
  cover->border = total.border;
  Summary summary;
  summary.facing = total.facing;
  summary.metric = total.metric;
  summary.total_weight = total.total_weight.Value();
  summary.footprint_sum = total.footprint_sum.Value();
  summary.counts = total.counts;
  WideMatrix<6> tensor;
  for (int i = 0; i < 36; ++i) tensor[i / 6][i % 6] = ToWide(total.tensor[i]);
  const WideMatrix<3> normalized_from_ray = ToWide<3>(cover->normalized_from_ray);
  tensor = Transformed(tensor, normalized_from_ray, Inverse(normalized_from_ray));
  Eigen::Matrix<double, 6, 6> entries;
  for (int i = 0; i < 36; ++i) {
    entries(i / 6, i % 6) = tensor[i / 6][i % 6].convert_to<double>();
  }
  summary.tensor = EnergyTensor(entries);
  if (!IsSumOfSamples(summary.tensor)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("light \"%s\": tensor: no samples sum to this, the summary is damaged: "
                        "summarise its frames again",
                        total.light.name));
  }
  summary.cover = *std::move(cover);
  return summary;
}

absl::StatusOr<Summary> MergeSummaries(absl::Span<const Summary> summaries, const Light& light) {
  if (summaries.empty()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("light \"%s\": no summaries to add, want at least one", light.name));
  }
  SummaryTotal total = TotalOf(summaries.front(), light);
  for (const Summary& summary : summaries.subspan(1)) {
    absl::Status status = AddToTotal(TotalOf(summary, light), &total);
    if (!status.ok()) return status;
  }
  return SummaryOfTotal(total);
}

}  // namespace lightfit
