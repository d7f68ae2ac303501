#include "methods/light_body.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "absl/strings/str_format.h"
#include "geometry/convex_hull.h"
#include "geometry/enclosing_rectangle.h"
#include "geometry/homography.h"
#include "geometry/light_map.h"
#include "geometry/map_size.h"
#include "geometry/ray_cone.h"
#include "methods/view_body.h"

namespace lightfit {

namespace {

absl::Status SurroundedError(const Light& light) {
  return absl::FailedPreconditionError(absl::StrFormat(
      "light \"%s\": at (%g, %g, %g) it hangs among its receivers: no single map has all of them "
      "in front of it. Use a cube map or a dual paraboloid map, or a smaller box of receivers",
      light.name,
      light.position.x(),
      light.position.y(),
      light.position.z()));
}

absl::Status FlatError(const Light& light) {
  return absl::FailedPreconditionError(absl::StrFormat(
      "light \"%s\": all receivers lie in one plane with the light, so that its map would have no "
      "area. Is the surface edge-on to the light? Then it shows no shadow",
      light.name));
}

absl::StatusOr<LightBody> SeenFromLight(const MethodInput& input,
                                        std::vector<Eigen::Vector3d> points) {
  LightBody body;
  body.light = input.light;
  body.map = input.map;
  body.points = std::move(points);
  Eigen::Vector3d forward = Eigen::Vector3d::UnitZ();
  if (input.light.kind == Light::Kind::kPoint) {
    std::vector<Eigen::Vector3d> offsets;
    for (const Eigen::Vector3d& point : body.points) {
      const Eigen::Vector3d offset = point - input.light.position;
      if (!(offset.norm() > 0.0)) return SurroundedError(input.light);
      offsets.push_back(offset);
    }
    const std::optional<Eigen::Vector3d> axis = FeasibleAxis(offsets);
    if (!axis.has_value()) return SurroundedError(input.light);
    forward = *axis;
  }
  body.ray_from_world = RayFromWorld(input.light, forward);
  for (const Eigen::Vector3d& point : body.points) {
    body.rays.push_back(body.ray_from_world * point.homogeneous());
  }
  return body;
}

Polygon HullOfBody(const LightBody& body, const Eigen::Matrix3d& warped_from_ray) {
  std::vector<Eigen::Vector2d> points;
  points.reserve(body.rays.size());
  for (const Eigen::Vector3d& ray : body.rays) {
    points.push_back((warped_from_ray * ray).hnormalized());
  }
  return ConvexHull(points);
}

bool HasArea(const Polygon& hull) {
  const Parallelogram rectangle = MinAreaRectangle(hull);
  const double u = rectangle.edge_u.norm(), v = rectangle.edge_v.norm();
  return std::isfinite(u + v) && std::min(u, v) > kMinHullAspect * std::max(u, v);
}

// A rectangle's longer side goes along the longer side of the map: a turn by a right angle.
void TurnToMap(const MapSize& map, Parallelogram* shape) {
  if ((shape->edge_u.norm() < shape->edge_v.norm()) == (map.width < map.height)) return;
  shape->corner += shape->edge_u;
  shape->edge_u = std::exchange(shape->edge_v, -shape->edge_u);
}

Parallelogram AlongRows(const Polygon& hull) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& vertex : hull) box.extend(vertex);
  const Eigen::Vector2d sizes = box.sizes();
  return {box.min(), {sizes.x(), 0.0}, {0.0, sizes.y()}};
}

}  // namespace

absl::Status ValidateMethodInput(const MethodInput& input) {
  if (absl::Status status = ValidateLight(input.light); !status.ok()) return status;
  if (absl::Status status = ValidateCamera(input.camera); !status.ok()) return status;
  const double near = input.camera.near, far = input.camera.far;
  if (!(near > 0.0) || !(far > near) || !std::isfinite(far)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "camera: near = %g, far = %g, want 0 < near < far, both finite: they bound what is in view",
        near,
        far));
  }
  const Eigen::Vector3d &low = input.receivers.min(), &high = input.receivers.max();
  if (input.receivers.isEmpty() || !low.allFinite() || !high.allFinite()) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "receivers: the box from (%g, %g, %g) to (%g, %g, %g) is empty or not finite, want world "
        "coordinates with min <= max",
        low.x(),
        low.y(),
        low.z(),
        high.x(),
        high.y(),
        high.z()));
  }
  if (absl::Status status = ValidateMapSize(input.map); !status.ok()) return status;
  if (input.plane.has_value() &&
      (!input.plane->coeffs().allFinite() || std::abs(input.plane->normal().norm() - 1.0) > 1e-6)) {
    return absl::InvalidArgumentError(
        "plane: not finite, or its normal is not of length 1; want a unit normal, world");
  }
  for (const Eigen::Vector4d& cut : input.cuts) {
    if (cut.allFinite()) continue;
    return absl::InvalidArgumentError(absl::StrFormat(
        "cuts: (%g, %g, %g, %g) is not finite, want the coefficients of a plane, world",
        cut.x(),
        cut.y(),
        cut.z(),
        cut.w()));
  }
  return absl::OkStatus();
}

absl::StatusOr<LightBody> WholeBody(const MethodInput& input) {
  if (absl::Status status = ValidateMethodInput(input); !status.ok()) return status;
  const std::array<Eigen::Vector3d, 8> corners = BoxCorners(input.receivers);
  return SeenFromLight(input, {corners.begin(), corners.end()});
}

absl::StatusOr<LightBody> BodyInView(const MethodInput& input) {
  if (absl::Status status = ValidateMethodInput(input); !status.ok()) return status;
  std::vector<Eigen::Vector3d> points = ViewBody(input.camera, input.receivers, input.cuts);
  if (!points.empty()) {
    absl::StatusOr<LightBody> body = SeenFromLight(input, std::move(points));
    if (!body.ok() || HasArea(HullOfBody(*body, Eigen::Matrix3d::Identity()))) return body;
  }
  absl::StatusOr<LightBody> body = WholeBody(input);
  if (body.ok()) body->in_view = false;
  return body;
}

absl::StatusOr<MethodMap> FitBody(const LightBody& body,
                                  const Eigen::Matrix3d& warped_from_ray,
                                  RectangleTurn turn) {
  const WRange w = RangeOfW(body, warped_from_ray.row(2).transpose());
  if (!warped_from_ray.allFinite() || !(w.least > 0.0) || !std::isfinite(w.greatest)) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "light \"%s\": w of the warp is %g ... %g over the receivers, want it positive",
        body.light.name,
        w.least,
        w.greatest));
  }
  const Polygon hull = HullOfBody(body, warped_from_ray);
  if (!HasArea(HullOfBody(body, Eigen::Matrix3d::Identity()))) return FlatError(body.light);
  Parallelogram shape;
  if (turn == RectangleTurn::kMinArea) {
    shape = MinAreaRectangle(hull);
    TurnToMap(body.map, &shape);
  } else {
    shape = AlongRows(hull);
  }
  Eigen::Matrix2d edges;
  edges << shape.edge_u, shape.edge_v;
  const Eigen::Matrix2d unit_from_warped = edges.inverse();
  if (!unit_from_warped.allFinite()) return FlatError(body.light);
  Eigen::Matrix3d map_from_unit = Eigen::Vector3d(body.map.width, body.map.height, 1).asDiagonal();
  Eigen::Matrix3d unit_from_plane = Eigen::Matrix3d::Identity();
  unit_from_plane.topLeftCorner<2, 2>() = unit_from_warped;
  unit_from_plane.topRightCorner<2, 1>() = -unit_from_warped * shape.corner;
  return CompleteMap(body, map_from_unit * unit_from_plane * warped_from_ray);
}

absl::StatusOr<MethodMap> CompleteMap(const LightBody& body, Eigen::Matrix3d map_from_ray) {
  map_from_ray = Unmirrored(map_from_ray, body.map);
  // w is 1 in the middle for a directional light, the distance along the axis for a point light.
  double middle_w = 0.0;
  DepthRange depth = {std::numeric_limits<double>::infinity(),
                      -std::numeric_limits<double>::infinity()};
  double w_min = std::numeric_limits<double>::infinity();
  if (body.light.kind == Light::Kind::kPoint) {
    middle_w = map_from_ray.row(2).norm();
  } else {
    int num_in_front = 0;
    for (const Eigen::Vector3d& ray : body.rays) {
      const double w = map_from_ray.row(2).dot(ray);
      if (w > 0.0) middle_w += w, ++num_in_front;
    }
    middle_w /= std::max(num_in_front, 1);
  }
  if (middle_w > 0.0) map_from_ray /= middle_w;
  const Eigen::Vector3d direction = body.light.direction.stableNormalized();
  for (size_t i = 0; i < body.rays.size(); ++i) {
    const double w = map_from_ray.row(2).dot(body.rays[i]);
    if (!(w > 0.0)) continue;
    const double d = body.light.kind == Light::Kind::kPoint ? w : direction.dot(body.points[i]);
    depth = {std::min(depth.near, d), std::max(depth.far, d)};
    w_min = std::min(w_min, w);
  }
  if (!std::isfinite(w_min)) {
    return absl::FailedPreconditionError(
        absl::StrFormat("light \"%s\": no receiver lies in front of the map", body.light.name));
  }
  const absl::StatusOr<Eigen::Matrix4d> map_from_world =
      FinishMap(map_from_ray, body.ray_from_world, body.light, depth, w_min);
  if (!map_from_world.ok()) return map_from_world.status();
  MethodMap map;
  map.map_from_world = *map_from_world;
  return map;
}

Eigen::Matrix3d HomographyOfRows(const LightBody& body, const Eigen::Matrix<double, 3, 4>& rows) {
  // ray_from_world has orthonormal rows; those of a point light but for their last column.
  if (body.light.kind == Light::Kind::kPoint) {
    return rows.leftCols<3>() * body.ray_from_world.leftCols<3>().transpose();
  }
  return rows * body.ray_from_world.transpose();
}

WRange RangeOfW(const LightBody& body, const Eigen::Vector3d& axis) {
  WRange range = {std::numeric_limits<double>::infinity(),
                  -std::numeric_limits<double>::infinity()};
  for (const Eigen::Vector3d& ray : body.rays) {
    const double w = axis.dot(ray);
    range = {std::min(range.least, w), std::max(range.greatest, w)};
  }
  return range;
}

}  // namespace lightfit
