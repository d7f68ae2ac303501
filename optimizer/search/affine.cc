#include "optimizer/search/affine.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <utility>

#include "geometry/enclosing_rectangle.h"
#include "geometry/light.h"

namespace lightfit {

namespace {

// Rows s, t, p: the plane in which the shape is fitted. A rectangle depends on the choice, so s and
// t are orthonormal and normal to p in the coordinates asked for; a parallelogram does not.
Eigen::Matrix3d PlaneFromRay(const AffineProblem& problem, const Eigen::Vector3d& axis) {
  Eigen::Matrix3d plane_from_ray;
  if (problem.affine == Affine::kMinEnergyParallelogram) {
    plane_from_ray.setIdentity();
  } else if (problem.ray_space == RaySpace::kNormalized) {
    plane_from_ray = FrameAlong(axis);
  } else {
    const Eigen::Vector3d axis_in_light = problem.normalized_from_ray.transpose() * axis;
    plane_from_ray = FrameAlong(axis_in_light) * problem.normalized_from_ray.inverse();
  }
  plane_from_ray.row(2) = axis;
  return plane_from_ray;
}

// A rectangle's longer side goes along the longer side of the map: a turn by a right angle.
void TurnToMap(const MapSize& map, Parallelogram* shape) {
  if ((shape->edge_u.norm() < shape->edge_v.norm()) == (map.width < map.height)) return;
  shape->corner += shape->edge_u;
  const Eigen::Vector2d edge_u = shape->edge_u;
  shape->edge_u = shape->edge_v;
  shape->edge_v = -edge_u;
}

absl::StatusOr<Parallelogram> Rectangle(Affine affine, const Polygon& polygon) {
  switch (affine) {
    case Affine::kMinAreaRectangleCgal:
      return MinAreaRectangleCgal(polygon);
    case Affine::kSkewedRectangle:
      return MinAreaSkewedRectangle(polygon);
    case Affine::kMinAreaRectangle:
    case Affine::kMinEnergyParallelogram:
      break;
  }
  return MinAreaRectangle(polygon);
}

}  // namespace

InnerInterval InnerTexels(double size, double margin_percent, double margin_texels) {
  // Grown by g of its extent on both sides, the shape itself keeps 1 / (1 + 2 g) of the map.
  const double room = size - 2.0 * margin_texels;
  const double inner = room / (1.0 + 0.02 * margin_percent);
  return {0.5 * (size - inner), 0.5 * (size + inner)};
}

absl::StatusOr<AffineFit> FitAffine(const AffineProblem& problem,
                                    const Polygon& hull,
                                    const Eigen::Matrix3d& metric_at_axis,
                                    const Eigen::Vector3d& axis) {
  const Eigen::Matrix3d plane_from_ray = PlaneFromRay(problem, axis);
  const Eigen::Matrix<double, 3, 2> r = plane_from_ray.inverse().leftCols<2>();
  const Eigen::Matrix2d metric = r.transpose() * metric_at_axis * r;

  // A projective map with w > 0 keeps convexity and order.
  Polygon polygon(hull.size());
  for (size_t i = 0; i < hull.size(); ++i) {
    polygon[i] = (plane_from_ray * hull[i].homogeneous()).hnormalized();
  }
  const InnerInterval u =
      InnerTexels(problem.map.width, problem.margin_percent, problem.margin_texels);
  const InnerInterval v =
      InnerTexels(problem.map.height, problem.margin_percent, problem.margin_texels);
  const double inner_width = u.high - u.low;
  const double inner_height = v.high - v.low;

  AffineFit fit;
  Parallelogram shape;
  if (problem.affine == Affine::kMinEnergyParallelogram) {
    // Sums of samples are positive; those of a damaged summary need not be.
    if (!(metric(0, 0) > 0.0) || !metric.allFinite()) {
      return absl::InvalidArgumentError("the energy is not positive: no samples sum to this");
    }
    const EnclosingParallelogram best =
        MinEnergyParallelogram(polygon, metric, inner_width, inner_height);
    shape = best.shape;
    fit.energy = best.energy;
    fit.contacts = best.contacts;
  } else {
    absl::StatusOr<Parallelogram> rectangle = Rectangle(problem.affine, polygon);
    if (!rectangle.ok()) return rectangle.status();
    shape = *rectangle;
    TurnToMap(problem.map, &shape);
    fit.energy = ParallelogramEnergy(shape, metric, inner_width, inner_height);
  }
  Eigen::Matrix2d edges;
  edges << shape.edge_u, shape.edge_v;
  const Eigen::Matrix2d unit_from_plane = edges.inverse();
  if (!unit_from_plane.allFinite() || !std::isfinite(fit.energy)) {
    return absl::FailedPreconditionError("the enclosing shape of the rays has no area");
  }
  // (u, v) = low + inner size * unit coordinates, times w.
  const Eigen::Vector2d corner_in_unit = unit_from_plane * shape.corner;
  const Eigen::RowVector3d p = axis.transpose();
  const Eigen::Matrix<double, 2, 3> unit_rows = unit_from_plane * plane_from_ray.topRows<2>();
  fit.map_from_ray.row(0) =
      inner_width * unit_rows.row(0) + (u.low - inner_width * corner_in_unit.x()) * p;
  fit.map_from_ray.row(1) =
      inner_height * unit_rows.row(1) + (v.low - inner_height * corner_in_unit.y()) * p;
  fit.map_from_ray.row(2) = p;
  return fit;
}

}  // namespace lightfit
