#include "optimizer/search/axis_evaluator.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <utility>

#include "base/stop.h"
#include "geometry/convex_hull.h"

namespace lightfit {

std::optional<AffineFit> AxisEvaluator::Evaluate(const Eigen::Vector3d& axis) {
  if (StopRequested()) return std::nullopt;
  if (!axis.allFinite() || !(axis.z() > 0.0)) return std::nullopt;
  std::optional<AffineFit> fit = EvaluateScaled(axis / axis.z());
  if (fit.has_value()) ++num_evaluations_;
  return fit;
}

std::optional<AffineFit> SummaryEvaluator::EvaluateScaled(const Eigen::Vector3d& axis) {
  for (const Eigen::Vector2d& ray : summary_.cover.hull) {
    if (!(axis.head<2>().dot(ray) + 1.0 >= min_w())) return std::nullopt;
  }
  absl::StatusOr<AffineFit> fit =
      FitAffine(problem(), summary_.cover.hull, summary_.tensor.AtAxis(axis), axis);
  if (!fit.ok()) return std::nullopt;
  return *std::move(fit);
}

Eigen::Vector3d SummaryEvaluator::Gradient(const AffineFit& fit) {
  return summary_.tensor.EnergyAndGradient(fit.map_from_ray).dE_dp;
}

SampleEvaluator::SampleEvaluator(const Samples& samples,
                                 absl::Span<const Eigen::Vector3d> hull_rays,
                                 const MetricWeights& metric,
                                 const AffineProblem& problem,
                                 double min_w)
    : AxisEvaluator(problem, min_w),
      samples_(samples),
      rays_(hull_rays.begin(), hull_rays.end()),
      metric_(metric) {}

SampleEvaluator::SampleEvaluator(const Samples& samples,
                                 const Surfaces& surfaces,
                                 const MetricWeights& metric,
                                 const AffineProblem& problem,
                                 double min_w)
    : AxisEvaluator(problem, min_w), samples_(samples), surfaces_(&surfaces), metric_(metric) {
  // A dozen megabytes. Beyond that it takes no longer to work them out each time.
  constexpr int64_t kMostRaysKept = int64_t{1} << 19;
  if (surfaces.tiles.num_surfaces > kMostRaysKept) return;
  rays_.reserve(surfaces.tiles.num_surfaces);
  ForEachRay([this](const Eigen::Vector3d& ray) {
    rays_.push_back(ray);
    return true;
  });
  surfaces_ = nullptr;
}

template <typename Visitor>
void SampleEvaluator::ForEachRay(const Visitor& visit) const {
  if (surfaces_ == nullptr) {
    for (size_t i = 0; i < rays_.size(); ++i) {
      if (IsStopped(i) || !visit(rays_[i])) return;
    }
    return;
  }
  bool goes_on = true;
  for (const DepthTile& tile : surfaces_->tiles.grids[0].tiles) {
    if (!goes_on || StopRequested()) return;
    if (tile.num_surfaces == 0) continue;
    ForEachSurface(surfaces_->readback,
                   surfaces_->affine_depth,
                   surfaces_->tiles.filter,
                   tile,
                   [&](int x, int y, double d) {
                     const Eigen::Vector4d screen(x + 0.5, y + 0.5, d, 1.0);
                     goes_on = goes_on && visit(samples_.ray_from_screen * screen);
                   });
  }
}

std::optional<AffineFit> SampleEvaluator::EvaluateScaled(const Eigen::Vector3d& axis) {
  // Project every receiver and take the hull, in the plane X_3 = 1 seen along `axis`.
  Eigen::Matrix3d plane_from_ray = Eigen::Matrix3d::Identity();
  plane_from_ray.row(2) = axis;
  ConvexHullBuilder builder;
  bool is_usable = true;
  ForEachRay([&](const Eigen::Vector3d& ray) {
    const double w = axis.dot(ray);
    is_usable = w >= min_w() * ray.z();
    if (is_usable) builder.Add({ray.x() / w, ray.y() / w});
    return is_usable;
  });
  if (!is_usable || StopRequested()) return std::nullopt;
  // Back to normalised rays, which is where FitAffine takes its hull. Order and convexity hold.
  const Eigen::Matrix3d ray_from_plane = plane_from_ray.inverse();
  Polygon hull = builder.Hull();
  for (Eigen::Vector2d& vertex : hull) {
    vertex = (ray_from_plane * vertex.homogeneous()).hnormalized();
  }
  absl::StatusOr<AffineFit> fit = FitAffine(problem(), hull, Eigen::Matrix3d::Identity(), axis);
  if (!fit.ok()) return std::nullopt;
  fit->energy = Energy(fit->map_from_ray, samples_, metric_);
  return *std::move(fit);
}

Eigen::Vector3d SampleEvaluator::Gradient(const AffineFit& fit) {
  return EnergyAndGradient(fit.map_from_ray, samples_, metric_).dE_dp;
}

}  // namespace lightfit
