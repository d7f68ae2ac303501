#include "geometry/ray_cone.h"

#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "base/scratch.h"
#include "base/stop.h"
#include "geometry/convex_hull.h"
#include "geometry/enclosing_rectangle.h"

namespace lightfit {

namespace {

// With this margin the mean of the rays is as good an axis as any.
constexpr double kGoodMargin = 0.3;

// The rays whose hull has the nearest point. Four do; one more is under way, and rounding may leave
// some that depend on each other.
constexpr int kMaxCorral = 7;
// Of the size of the corral, without heap memory.
using Weights = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxCorral + 1, 1>;

// The point nearest to the origin in the affine hull of the rays, as weights that sum to 1.
Weights AffineMinimizer(absl::Span<const Eigen::Vector3d> corral) {
  using System =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxCorral + 1, kMaxCorral + 1>;
  const Eigen::Index n = static_cast<Eigen::Index>(corral.size());
  System system = System::Ones(n + 1, n + 1);
  system(n, n) = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) system(i, j) = corral[i].dot(corral[j]);
  }
  const Weights weights = system.fullPivLu().solve(Weights(Weights::Unit(n + 1, n)));
  return weights.head(n);
}

// Wolfe (1976), "Finding the nearest point in a polytope". The hull's point nearest to the origin
// is a convex combination of at most four rays, the corral.
Eigen::Vector3d NearestPointOfHull(const Eigen::Vector3d& first, LowestUnitRay lowest_along) {
  constexpr int kMaxRounds = 200;
  constexpr double kTolerance = 1e-12;
  ScratchVector<Eigen::Vector3d> corral = {first};
  Weights weights = Weights::Ones(1);
  Eigen::Vector3d nearest = first;
  for (int round = 0; round < kMaxRounds; ++round) {
    const Eigen::Vector3d lowest = lowest_along(nearest);
    const bool is_nearest = nearest.dot(lowest) >= nearest.squaredNorm() - kTolerance;
    if (is_nearest || corral.size() == kMaxCorral) break;
    corral.push_back(lowest);
    weights.conservativeResize(weights.size() + 1);
    weights(weights.size() - 1) = 0.0;
    // Step towards the affine minimiser; drop the rays whose weight reaches zero on the way.
    while (true) {
      const Weights target = AffineMinimizer(corral);
      if (!target.allFinite()) return Eigen::Vector3d::Zero();
      if (target.minCoeff() > kTolerance || corral.size() == 1) {
        weights = target;
        break;
      }
      double step = 1.0;
      for (Eigen::Index i = 0; i < target.size(); ++i) {
        if (target(i) <= kTolerance && weights(i) > target(i)) {
          step = std::min(step, weights(i) / (weights(i) - target(i)));
        }
      }
      weights += step * (target - weights);
      Eigen::Index least = 0;
      weights.minCoeff(&least);
      corral.erase(corral.begin() + least);
      for (Eigen::Index i = least; i + 1 < weights.size(); ++i) weights(i) = weights(i + 1);
      weights.conservativeResize(weights.size() - 1);
    }
    nearest.setZero();
    for (size_t i = 0; i < corral.size(); ++i) nearest += weights(i) * corral[i];
    if (nearest.norm() < 0.5 * kMinConeMargin) break;  // the origin is (all but) inside
  }
  return nearest;
}

}  // namespace

std::optional<Eigen::Vector3d> FeasibleAxis(absl::Span<const Eigen::Vector3d> rays) {
  constexpr size_t kBlock = 4096;  // between two looks at whether to stop
  ScratchVector<Eigen::Vector3d> unit_rays;
  unit_rays.reserve(rays.size());
  UnitRaySum sum;
  for (const Eigen::Vector3d& ray : rays) {
    if (unit_rays.size() % kBlock == 0 && StopRequested()) return std::nullopt;
    unit_rays.push_back(ray.normalized());
    sum.Add(unit_rays.back());
  }
  return FeasibleAxis(sum, [&unit_rays](const Eigen::Vector3d& axis) {
    const Eigen::Vector3d* lowest = &unit_rays[0];
    if (StopRequested()) return *lowest;
    double lowest_height = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& ray : unit_rays) {
      const double height = axis.dot(ray);
      if (height < lowest_height) {
        lowest_height = height;
        lowest = &ray;
      }
    }
    return *lowest;
  });
}

std::optional<Eigen::Vector3d> FeasibleAxis(const UnitRaySum& rays, LowestUnitRay lowest) {
  if (rays.count == 0 || !rays.sum.allFinite()) return std::nullopt;
  const auto margin = [&lowest](const Eigen::Vector3d& axis) { return axis.dot(lowest(axis)); };
  if (rays.sum.norm() > kGoodMargin * static_cast<double>(rays.count)) {
    const Eigen::Vector3d mean = rays.sum.normalized();
    if (margin(mean) >= kGoodMargin) return mean;
  }
  const Eigen::Vector3d nearest = NearestPointOfHull(rays.first, lowest);
  if (!(nearest.norm() >= kMinConeMargin)) return std::nullopt;
  const Eigen::Vector3d axis = nearest.normalized();
  if (!(margin(axis) >= 0.5 * kMinConeMargin)) return std::nullopt;
  return axis;
}

namespace {

// Drops vertices that nothing but rounding keeps apart from the one before: edges between them have
// any direction, and whoever goes around the hull by directions of edges gets lost.
void DropCoincident(Polygon* hull) {
  constexpr double kLeastEdge = 1e-12;  // in a hull of extent 2
  const auto is_close = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return (a - b).cwiseAbs().maxCoeff() < kLeastEdge;
  };
  hull->erase(std::unique(hull->begin(), hull->end(), is_close), hull->end());
  while (hull->size() > 3 && is_close(hull->back(), hull->front())) hull->pop_back();
}

}  // namespace

std::optional<Eigen::Matrix3d> NormalizeRays(const Eigen::Matrix3d& frame_from_ray, Polygon* hull) {
  const Parallelogram rectangle = MinAreaRectangle(*hull);
  const double length_u = rectangle.edge_u.norm();
  const double length_v = rectangle.edge_v.norm();
  const double longer = std::max(length_u, length_v);
  if (!(std::min(length_u, length_v) > kMinHullAspect * longer) || !std::isfinite(longer)) {
    return std::nullopt;
  }
  const Eigen::Vector2d origin = Centroid(*hull);
  // Rows that send the rectangle's edges to (2, 0) and (0, 2). The edges are perpendicular.
  Eigen::Matrix2d square_from_plane;
  square_from_plane.row(0) = 2.0 * rectangle.edge_u / (length_u * length_u);
  square_from_plane.row(1) = 2.0 * rectangle.edge_v / (length_v * length_v);
  if (square_from_plane.determinant() < 0.0) square_from_plane.row(1) *= -1.0;

  Eigen::Matrix3d normalized_from_frame = Eigen::Matrix3d::Identity();
  normalized_from_frame.topLeftCorner<2, 2>() = square_from_plane;
  normalized_from_frame.topRightCorner<2, 1>() = -square_from_plane * origin;
  for (Eigen::Vector2d& vertex : *hull) vertex = square_from_plane * (vertex - origin);
  DropCoincident(hull);
  return normalized_from_frame * frame_from_ray;
}

Polygon PolarPolygon(const Polygon& hull, double min_w) {
  // a x + b y + 1 >= min_w: each hull vertex is an edge of the polar polygon, each hull edge one of
  // its vertices, the axis with w = min_w on both ends of the edge.
  Polygon polar;
  polar.reserve(hull.size());
  for (size_t i = 0; i < hull.size(); ++i) {
    const Eigen::Vector2d& from = hull[i];
    const Eigen::Vector2d& to = hull[i + 1 == hull.size() ? 0 : i + 1];
    const double cross = Cross(from, to);
    polar.push_back((min_w - 1.0) * Eigen::Vector2d(to.y() - from.y(), from.x() - to.x()) / cross);
  }
  return polar;
}

}  // namespace lightfit
