#include "methods/dominant_plane.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace lightfit {

namespace {

using Plane = Eigen::Hyperplane<double, 3>;

struct Surfaces {
  std::vector<Eigen::Vector3d> points, normals;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // middle of their box
  double diagonal = 0.0;                             // of it
};

Surfaces UsableSurfaces(absl::Span<const Eigen::Vector3d> points,
                        absl::Span<const Eigen::Vector3d> normals) {
  constexpr double kLengthTolerance = 1e-3;
  Surfaces surfaces;
  Eigen::AlignedBox3d box;
  for (size_t i = 0; i < std::min(points.size(), normals.size()); ++i) {
    if (!points[i].allFinite() || !(std::abs(normals[i].norm() - 1.0) < kLengthTolerance)) continue;
    surfaces.points.push_back(points[i]);
    surfaces.normals.push_back(normals[i].normalized());
    box.extend(points[i]);
  }
  if (!surfaces.points.empty()) {
    surfaces.origin = box.center();
    surfaces.diagonal = box.sizes().norm();
  }
  return surfaces;
}

// A cube around the origin whose faces have kCells x kCells cells of about 7 degrees.
constexpr int kCells = 12;
constexpr int kNumCells = 6 * kCells * kCells;

int CellOf(const Eigen::Vector3d& normal) {
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  const double size = std::abs(normal(axis));
  const auto index = [&](double value) {
    return std::clamp(static_cast<int>(0.5 * (value / size + 1.0) * kCells), 0, kCells - 1);
  };
  const int face = 2 * static_cast<int>(axis) + (normal(axis) < 0.0 ? 1 : 0);
  return (face * kCells + index(normal((axis + 1) % 3))) * kCells + index(normal((axis + 2) % 3));
}

// Mean normals of the fullest cells, fullest first.
std::vector<Eigen::Vector3d> NormalCandidates(const Surfaces& surfaces) {
  constexpr int kMaxCandidates = 12;
  std::vector<int> votes(kNumCells, 0);
  std::vector<Eigen::Vector3d> sums(kNumCells, Eigen::Vector3d::Zero());
  for (const Eigen::Vector3d& normal : surfaces.normals) {
    const int cell = CellOf(normal);
    ++votes[cell];
    sums[cell] += normal;
  }
  std::vector<int> order(kNumCells);
  for (int i = 0; i < kNumCells; ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return votes[a] > votes[b]; });
  std::vector<Eigen::Vector3d> candidates;
  for (int i = 0; i < kMaxCandidates && votes[order[i]] > 0; ++i) {
    candidates.push_back(sums[order[i]].normalized());
  }
  return candidates;
}

// The plane along `normal` with the fullest pair of neighbouring offset bins, each as wide as the
// distance allowed: it holds every point of the best plane along this normal.
Plane BestOffset(const Surfaces& surfaces,
                 const Eigen::Vector3d& normal,
                 double min_cosine,
                 double distance) {
  const int num_bins = static_cast<int>(surfaces.diagonal / distance) + 2;
  std::vector<int> votes(num_bins + 1, 0);
  std::vector<double> sums(num_bins + 1, 0.0);
  for (size_t i = 0; i < surfaces.points.size(); ++i) {
    if (surfaces.normals[i].dot(normal) < min_cosine) continue;
    const double offset = normal.dot(surfaces.points[i] - surfaces.origin);
    const double bin = (offset + 0.5 * surfaces.diagonal) / distance;
    const int index = std::clamp(static_cast<int>(bin), 0, num_bins - 1);
    ++votes[index];
    sums[index] += offset;
  }
  int best = 0;
  for (int i = 0; i < num_bins; ++i) {
    if (votes[i] + votes[i + 1] > votes[best] + votes[best + 1]) best = i;
  }
  const int count = std::max(votes[best] + votes[best + 1], 1);
  const double offset = (sums[best] + sums[best + 1]) / count;
  return Plane(normal, surfaces.origin + offset * normal);
}

std::vector<size_t> Supporters(const Surfaces& surfaces,
                               const Plane& plane,
                               double min_cosine,
                               double distance) {
  std::vector<size_t> supporters;
  for (size_t i = 0; i < surfaces.points.size(); ++i) {
    if (surfaces.normals[i].dot(plane.normal()) >= min_cosine &&
        plane.absDistance(surfaces.points[i]) <= distance) {
      supporters.push_back(i);
    }
  }
  return supporters;
}

// The plane of least squared distance; `plane` where the points do not tell one.
Plane Refit(const Surfaces& surfaces, const std::vector<size_t>& supporters, const Plane& plane) {
  if (supporters.size() < 3) return plane;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const size_t i : supporters) mean += surfaces.points[i] - surfaces.origin;
  mean /= static_cast<double>(supporters.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const size_t i : supporters) {
    const Eigen::Vector3d offset = surfaces.points[i] - surfaces.origin - mean;
    spread += offset * offset.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  constexpr double kLine = 1e-6;  // all on a line, across or less spread out than that
  if (!(solver.eigenvalues()(1) > kLine * solver.eigenvalues()(2))) return plane;
  Eigen::Vector3d normal = solver.eigenvectors().col(0);
  if (normal.dot(plane.normal()) < 0.0) normal = -normal;
  return Plane(normal.normalized(), surfaces.origin + mean);
}

}  // namespace

std::optional<Plane> DominantPlane(absl::Span<const Eigen::Vector3d> points,
                                   absl::Span<const Eigen::Vector3d> normals,
                                   const DominantPlaneOptions& options) {
  constexpr double kLeastDistance = 1e-5;  // bounds the number of offset bins
  if (!(options.max_angle_rad > 0.0 && options.max_angle_rad < 0.5) ||
      !(options.max_distance >= kLeastDistance)) {
    return std::nullopt;
  }
  const Surfaces surfaces = UsableSurfaces(points, normals);
  if (surfaces.points.size() < 3 || !(surfaces.diagonal > 0.0) ||
      !std::isfinite(surfaces.diagonal)) {
    return std::nullopt;
  }
  const double distance = options.max_distance * surfaces.diagonal;
  const double min_cosine = std::cos(options.max_angle_rad);
  // The mean of a cell may be off by its size, and leans the plane over its length: the first
  // rounds are generous.
  constexpr std::array<double, 4> kGenerous = {4.0, 2.0, 1.0, 1.0};
  const double wide_cosine = std::cos(std::min(1.5 * options.max_angle_rad, 0.5));
  std::optional<Plane> best;
  size_t best_support = 2;
  for (const Eigen::Vector3d& normal : NormalCandidates(surfaces)) {
    Plane plane = BestOffset(surfaces, normal, wide_cosine, kGenerous[0] * distance);
    std::vector<size_t> supporters;
    for (const double generous : kGenerous) {
      supporters = Supporters(surfaces, plane, wide_cosine, generous * distance);
      plane = Refit(surfaces, supporters, plane);
    }
    supporters = Supporters(surfaces, plane, min_cosine, distance);
    if (supporters.size() > best_support) {
      best_support = supporters.size();
      best = plane;
    }
  }
  if (static_cast<double>(best_support) <
      options.min_share * static_cast<double>(surfaces.points.size())) {
    return std::nullopt;
  }
  return best;
}

}  // namespace lightfit
