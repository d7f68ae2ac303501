#include "optimizer/axis_evaluator.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <utility>

#include "geometry/convex_hull.h"
#include "geometry/scratch.h"
#include "optimizer/stop.h"

namespace lightfit {

std::optional<AffineFit> AxisEvaluator::Evaluate(const Eigen::Vector3d& axis) {
  if (problem_.stop.stop_requested()) return std::nullopt;
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
                                 absl::Span<const Eigen::Vector3d> receiver_rays,
                                 const MetricWeights& metric,
                                 const AffineProblem& problem,
                                 double min_w)
    : AxisEvaluator(problem, min_w),
      samples_(samples),
      receiver_rays_(receiver_rays),
      metric_(metric) {}

std::optional<AffineFit> SampleEvaluator::EvaluateScaled(const Eigen::Vector3d& axis) {
  // Project every receiver and take the hull, in the plane X_3 = 1 seen along `axis`.
  Eigen::Matrix3d plane_from_ray = Eigen::Matrix3d::Identity();
  plane_from_ray.row(2) = axis;
  ScratchVector<Eigen::Vector2d> points;
  points.reserve(receiver_rays_.size());
  for (size_t i = 0; i < receiver_rays_.size(); ++i) {
    if (IsStopped(problem().stop, i)) return std::nullopt;
    const Eigen::Vector3d& ray = receiver_rays_[i];
    const double w = axis.dot(ray);
    if (!(w >= min_w() * ray.z())) return std::nullopt;
    points.emplace_back(ray.x() / w, ray.y() / w);
  }
  // Back to normalised rays, which is where FitAffine takes its hull. Order and convexity hold.
  const Eigen::Matrix3d ray_from_plane = plane_from_ray.inverse();
  Polygon hull = ConvexHull(points);
  for (Eigen::Vector2d& vertex : hull) {
    vertex = (ray_from_plane * vertex.homogeneous()).hnormalized();
  }
  absl::StatusOr<AffineFit> fit = FitAffine(problem(), hull, Eigen::Matrix3d::Identity(), axis);
  if (!fit.ok()) return std::nullopt;
  fit->energy = Energy(fit->map_from_ray, samples_, metric_, problem().stop);
  return *std::move(fit);
}

Eigen::Vector3d SampleEvaluator::Gradient(const AffineFit& fit) {
  return EnergyAndGradient(fit.map_from_ray, samples_, metric_, problem().stop).dE_dp;
}

}  // namespace lightfit
