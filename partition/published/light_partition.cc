#include "partition/published/light_partition.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "geometry/convex_hull.h"
#include "geometry/enclosing_rectangle.h"
#include "methods/view_body.h"
#include "methods/view_frame.h"
#include "partition/published/equal_maps.h"

namespace lightfit {

namespace {

std::vector<Eigen::Vector2d> InPlane(const LightPartition& partition) {
  std::vector<Eigen::Vector2d> points;
  points.reserve(partition.body.rays.size());
  for (const Eigen::Vector3d& ray : partition.body.rays) {
    points.emplace_back(partition.across.dot(ray) / ray.z(), partition.along.dot(ray) / ray.z());
  }
  return points;
}

// Axes along the least rectangle around the body, b along its longer side.
void LayAlongRectangle(LightPartition* partition) {
  partition->across = Eigen::RowVector3d::UnitX();
  partition->along = Eigen::RowVector3d::UnitY();
  const Parallelogram shape = MinAreaRectangle(ConvexHull(InPlane(*partition)));
  const bool u_is_longer = shape.edge_u.norm() > shape.edge_v.norm();
  const Eigen::Vector2d along = (u_is_longer ? shape.edge_u : shape.edge_v).normalized();
  partition->along << along.transpose(), -along.dot(shape.corner);
  partition->across << -Perpendicular(along).transpose(), 0.0;
  // The corner is where both edges begin: b = 0 there and grows along the edge.
}

// The line of the light's plane where row.X = 0, as a half space of the world.
Eigen::RowVector4d HalfSpace(const LightPartition& partition, const Eigen::RowVector3d& row) {
  return row * partition.body.ray_from_world;
}

Eigen::RowVector3d Beyond(const Eigen::RowVector3d& row, double offset) {
  return row - offset * Eigen::RowVector3d::UnitZ();
}

}  // namespace

absl::StatusOr<LightPartition> PartitionLight(const MethodInput& input, const RowOptions& options) {
  if (absl::Status status = ValidateRowOptions(options); !status.ok()) return status;
  absl::StatusOr<LightBody> body = BodyInView(input);
  if (!body.ok()) return body.status();
  // Whether the light sees an area at all.
  const absl::Status status =
      FitBody(*body, Eigen::Matrix3d::Identity(), RectangleTurn::kMinArea).status();
  if (!status.ok()) return status;

  LightPartition partition;
  partition.body = *std::move(body);
  const std::optional<ViewFrame> frame =
      AlongView(partition.body, input.camera, ViewDirection(input.camera));
  partition.is_along_view = !frame.has_value();
  if (frame.has_value()) {
    partition.across = frame->across;
    partition.along = frame->along;
    partition.trapezoid = LeastTrapezoid(InPlane(partition));
  } else {
    LayAlongRectangle(&partition);
    Eigen::AlignedBox2d box;
    for (const Eigen::Vector2d& point : InPlane(partition)) box.extend(point);
    partition.trapezoid = {box.center().x(), box.sizes().x(), 0.0, box.max().y()};
  }
  constexpr double kLeastBase = 1e-3;
  Trapezoid& trapezoid = partition.trapezoid;
  trapezoid.base = std::max(trapezoid.base, kLeastBase * trapezoid.WidthAt(trapezoid.length));
  partition.rows = TrapezoidRows(trapezoid, options);
  return partition;
}

absl::StatusOr<Plan> LightPartitionPlan(const MethodInput& input,
                                        const LightPartitionOptions& options) {
  if (absl::Status status = ValidateMargin("tang", options.margin_texels); !status.ok()) {
    return status;
  }
  const absl::StatusOr<LightPartition> partition = PartitionLight(input, options.rows);
  if (!partition.ok()) return partition.status();
  const absl::StatusOr<MapSize> size =
      EqualSquares(input.map, partition->num_maps(), options.margin_texels);
  if (!size.ok()) return size.status();

  Plan plan;
  plan.light_name.assign(input.light.name.begin(), input.light.name.end());
  LightBody body = partition->body;
  body.map = *size;
  for (const TrapezoidRow& row : partition->rows) {
    const double left = partition->trapezoid.centre - 0.5 * row.width;
    const double column_width = row.width / row.num_columns;
    for (int column = 0; column < row.num_columns; ++column) {
      const Eigen::RowVector3d from_left = Beyond(partition->across, left + column * column_width);
      const Eigen::RowVector3d from_begin = Beyond(partition->along, row.begin);
      Eigen::Matrix3d map_from_ray;
      map_from_ray.row(0) = size->width / column_width * from_left;
      map_from_ray.row(1) = size->height / row.length() * from_begin;
      map_from_ray.row(2) = Eigen::RowVector3d::UnitZ();
      const absl::StatusOr<MethodMap> complete = CompleteMap(body, map_from_ray);
      if (!complete.ok()) return complete.status();
      PlanMap map;
      map.size = *size;
      map.map_from_world = WithMargin(complete->map_from_world, *size, options.margin_texels);
      // Only where another cell begins, and as the negative of what that has.
      if (row.begin > 0.0) map.half_spaces.push_back(HalfSpace(*partition, from_begin));
      if (row.end < partition->trapezoid.length) {
        map.half_spaces.push_back(-HalfSpace(*partition, Beyond(partition->along, row.end)));
      }
      if (column > 0) map.half_spaces.push_back(HalfSpace(*partition, from_left));
      if (column + 1 < row.num_columns) {
        map.half_spaces.push_back(
            -HalfSpace(*partition, Beyond(partition->across, left + (column + 1) * column_width)));
      }
      plan.maps.push_back(std::move(map));
    }
  }
  return plan;
}

}  // namespace lightfit
