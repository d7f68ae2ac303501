#include "methods/plane_optimal.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "geometry/polygon.h"
#include "methods/focused.h"
#include "methods/light_body.h"
#include "methods/view_body.h"

namespace lightfit {

namespace {

using Plane = Eigen::Hyperplane<double, 3>;

// Sine of the angle at which a plane is seen edge-on.
constexpr double kEdgeOn = 1e-6;

// Sine between the plane and the rays that meet at a homogeneous point, with its sign.
double SineAt(const Plane& plane, const Eigen::Vector4d& centre, const Eigen::Vector3d& nearby) {
  const Eigen::Vector3d direction = centre.head<3>() - centre.w() * nearby;
  return plane.coeffs().dot(centre) / std::max(direction.norm(), 1e-300);
}

// Where the view's rays meet: the eye, or the direction that they come from.
Eigen::Vector4d HomogeneousEye(const Camera& camera) {
  Eigen::Vector4d eye;
  if (camera.orthographic) {
    eye << -ViewDirection(camera), 0.0;
  } else {
    eye << EyePosition(camera), 1.0;
  }
  return eye;
}

// Corners of BoxCorners() around the faces of least and greatest x, y and z.
constexpr int kBoxFaces[3][2][4] = {
    {{0, 3, 7, 4}, {1, 2, 6, 5}}, {{0, 1, 5, 4}, {3, 2, 6, 7}}, {{0, 1, 2, 3}, {4, 5, 6, 7}}};

double ScreenArea(const Camera& camera, const std::vector<Eigen::Vector3d>& polygon) {
  const Eigen::Matrix<double, 3, 4> pixel_from_world = PixelFromWorld(camera);
  double twice_area = 0.0;
  for (size_t i = 2; i < polygon.size(); ++i) {
    std::array<Eigen::Vector2d, 3> corners;
    int k = 0;
    for (const size_t vertex : {size_t{0}, i - 1, i}) {
      corners[k++] = (pixel_from_world * polygon[vertex].homogeneous()).hnormalized();
    }
    twice_area += Cross(corners[1] - corners[0], corners[2] - corners[0]);
  }
  return 0.5 * std::abs(twice_area);
}

}  // namespace

std::optional<Plane> MostVisibleFace(const MethodInput& input) {
  const std::array<Eigen::Vector3d, 8> corners = BoxCorners(input.receivers);
  const std::array<Eigen::Vector4d, 6> view_planes = FrustumPlanes(input.camera);
  const Eigen::Vector4d light = input.light.HomogeneousPosition();
  const Eigen::Vector4d eye = HomogeneousEye(input.camera);
  std::optional<Plane> best;
  double best_area = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
    for (int side = 0; side < 2; ++side) {
      const Eigen::Vector3d inward = side == 0 ? unit : -unit;
      const Plane plane(inward, side == 0 ? input.receivers.min() : input.receivers.max());
      std::vector<Eigen::Vector3d> face;
      for (const int corner : kBoxFaces[axis][side]) face.push_back(corners[corner]);
      const Eigen::Vector3d middle = 0.25 * (face[0] + face[1] + face[2] + face[3]);
      if (!(SineAt(plane, eye, middle) > kEdgeOn)) continue;
      if (!(SineAt(plane, light, middle) > kEdgeOn)) continue;
      const double area = ScreenArea(input.camera, ClipPolygon(std::move(face), view_planes));
      if (area > best_area) {
        best_area = area;
        best = plane;
      }
    }
  }
  return best;
}

absl::StatusOr<MethodMap> PlaneOptimalMap(const MethodInput& input,
                                          const PlaneOptimalOptions& options) {
  const absl::StatusOr<LightBody> body = BodyInView(input);
  if (!body.ok()) return body.status();
  if (!body->in_view) return FocusedMap(input);
  const std::optional<Plane> chosen =
      input.plane.has_value() ? input.plane : MostVisibleFace(input);
  if (!chosen.has_value()) return FocusedInstead(input, "no lit face of the box is in view");

  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : body->points) middle += point;
  middle /= static_cast<double>(body->points.size());
  Eigen::Vector4d plane = chosen->coeffs();
  const Eigen::Vector4d light = input.light.HomogeneousPosition();
  const double light_sine = SineAt(*chosen, light, middle);
  if (!(std::abs(light_sine) > kEdgeOn)) return FocusedInstead(input, "the light is in the plane");
  if (light_sine < 0.0) plane = -plane;

  if (!(std::abs(SineAt(*chosen, HomogeneousEye(input.camera), middle)) > kEdgeOn)) {
    return FocusedInstead(input, "the plane is seen edge-on");
  }
  // x' over plane.light, so that w is the camera depth of points on the plane.
  const Eigen::Matrix4d shadow_from_world =
      Eigen::Matrix4d::Identity() - light * plane.transpose() / plane.dot(light);
  const Eigen::Matrix3d pixel_from_ray =
      HomographyOfRows(*body, PixelFromWorld(input.camera) * shadow_from_world);
  const WRange w = RangeOfW(*body, pixel_from_ray.row(2).transpose());

  if (options.cover == PlaneOptimalOptions::Cover::kScreen) {
    if (!(w.greatest > 0.0)) return FocusedInstead(input, "the plane is behind the camera");
    const Eigen::Vector3d scale(static_cast<double>(input.map.width) / input.camera.width,
                                static_cast<double>(input.map.height) / input.camera.height,
                                1.0);
    absl::StatusOr<MethodMap> map = CompleteMap(*body, scale.asDiagonal() * pixel_from_ray);
    if (!map.ok()) return map;
    constexpr double kRounding = 1e-9;
    for (const Eigen::Vector3d& ray : body->rays) {
      const Eigen::Vector3d pixel = pixel_from_ray * ray;
      const Eigen::Vector2d share =
          pixel.head<2>().cwiseQuotient(Eigen::Vector2d(input.camera.width, input.camera.height));
      if (!(pixel.z() > 0.0) || share.minCoeff() < -kRounding * pixel.z() ||
          share.maxCoeff() > (1.0 + kRounding) * pixel.z()) {
        map->note = "plane-optimal: receivers off the plane reach out of the map";
      }
    }
    return map;
  }
  // Shadow points much nearer than the near plane would spend the map on them.
  constexpr double kLeastShare = 0.1;
  const double least = input.camera.orthographic ? 0.0 : kLeastShare * input.camera.near;
  if (!(w.least > least)) {
    return FocusedInstead(input, "rays of receivers off the plane meet it behind the camera");
  }
  return FitBody(*body, pixel_from_ray, RectangleTurn::kAlongRows);
}

}  // namespace lightfit
