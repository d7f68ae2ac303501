#include "methods/view_body.h"

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <utility>

namespace lightfit {

namespace {

// Corner indices of the six faces of FrustumCorners() and BoxCorners(), each around its outline.
constexpr int kFaces[6][4] = {
    {0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};

std::array<Eigen::Vector4d, 6> BoxPlanes(const Eigen::AlignedBox3d& box) {
  std::array<Eigen::Vector4d, 6> planes;
  for (size_t axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d unit = Eigen::Vector3d::Unit(static_cast<Eigen::Index>(axis));
    planes[2 * axis] << unit, -unit.dot(box.min());
    planes[2 * axis + 1] << -unit, unit.dot(box.max());
  }
  return planes;
}

void AppendFaces(const std::array<Eigen::Vector3d, 8>& corners,
                 absl::Span<const Eigen::Vector4d> planes,
                 absl::Span<const Eigen::Vector4d> cuts,
                 std::vector<Eigen::Vector3d>* body) {
  for (const auto& face : kFaces) {
    std::vector<Eigen::Vector3d> polygon;
    for (const int corner : face) polygon.push_back(corners[corner]);
    polygon = ClipPolygon(ClipPolygon(std::move(polygon), planes), cuts);
    body->insert(body->end(), polygon.begin(), polygon.end());
  }
}

}  // namespace

std::array<Eigen::Vector3d, 8> FrustumCorners(const Camera& camera) {
  const Eigen::Matrix4d world_from_screen = camera.WorldFromScreen();
  std::array<Eigen::Vector3d, 8> corners;
  int i = 0;
  for (const double z : {camera.near, camera.far}) {
    const double d = camera.orthographic ? z : 1.0 / z;
    const double width = camera.width, height = camera.height;
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {width, 0.0}, {width, height}, {0.0, height}}) {
      corners[i++] = (world_from_screen * Eigen::Vector4d(x, y, d, 1.0)).hnormalized();
    }
  }
  return corners;
}

std::array<Eigen::Vector3d, 8> BoxCorners(const Eigen::AlignedBox3d& box) {
  const Eigen::Vector3d &a = box.min(), &b = box.max();
  return {Eigen::Vector3d(a.x(), a.y(), a.z()),
          Eigen::Vector3d(b.x(), a.y(), a.z()),
          Eigen::Vector3d(b.x(), b.y(), a.z()),
          Eigen::Vector3d(a.x(), b.y(), a.z()),
          Eigen::Vector3d(a.x(), a.y(), b.z()),
          Eigen::Vector3d(b.x(), a.y(), b.z()),
          Eigen::Vector3d(b.x(), b.y(), b.z()),
          Eigen::Vector3d(a.x(), b.y(), b.z())};
}

std::array<Eigen::Vector4d, 6> FrustumPlanes(const Camera& camera) {
  const Eigen::Matrix<double, 3, 4> pixel_from_world = PixelFromWorld(camera);
  const Eigen::RowVector4d depth = camera.camera_from_world.row(2);
  const Eigen::RowVector4d w = pixel_from_world.row(2);
  std::array<Eigen::Vector4d, 6> planes;
  planes[0] = (depth - camera.near * Eigen::RowVector4d::UnitW()).transpose();
  planes[1] = (camera.far * Eigen::RowVector4d::UnitW() - depth).transpose();
  planes[2] = pixel_from_world.row(0).transpose();
  planes[3] = (camera.width * w - pixel_from_world.row(0)).transpose();
  planes[4] = pixel_from_world.row(1).transpose();
  planes[5] = (camera.height * w - pixel_from_world.row(1)).transpose();
  return planes;
}

std::vector<Eigen::Vector3d> ClipPolygon(std::vector<Eigen::Vector3d> polygon,
                                         absl::Span<const Eigen::Vector4d> planes) {
  std::vector<Eigen::Vector3d> inside;
  for (const Eigen::Vector4d& plane : planes) {
    inside.clear();
    for (size_t i = 0; i < polygon.size(); ++i) {
      const Eigen::Vector3d& from = polygon[i];
      const Eigen::Vector3d& to = polygon[i + 1 == polygon.size() ? 0 : i + 1];
      const double from_height = plane.dot(from.homogeneous());
      const double to_height = plane.dot(to.homogeneous());
      if (from_height >= 0.0) inside.push_back(from);
      if ((from_height > 0.0 && to_height < 0.0) || (from_height < 0.0 && to_height > 0.0)) {
        inside.push_back(from + from_height / (from_height - to_height) * (to - from));
      }
    }
    polygon.swap(inside);
  }
  return polygon;
}

std::vector<Eigen::Vector3d> ViewBody(const Camera& camera,
                                      const Eigen::AlignedBox3d& box,
                                      absl::Span<const Eigen::Vector4d> cuts) {
  std::vector<Eigen::Vector3d> body;
  AppendFaces(FrustumCorners(camera), BoxPlanes(box), cuts, &body);
  AppendFaces(BoxCorners(box), FrustumPlanes(camera), cuts, &body);
  return body;
}

Eigen::Vector3d EyePosition(const Camera& camera) {
  return camera.camera_from_world.inverse().topRightCorner<3, 1>();
}

Eigen::Vector3d ViewDirection(const Camera& camera) {
  return camera.camera_from_world.block<1, 3>(2, 0).transpose().normalized();
}

double CameraDepth(const Camera& camera, const Eigen::Vector3d& point) {
  return camera.camera_from_world.row(2).dot(point.homogeneous());
}

ViewDepths ViewDepthsOf(const Camera& camera, absl::Span<const Eigen::Vector3d> points) {
  ViewDepths depths = {std::numeric_limits<double>::infinity(),
                       -std::numeric_limits<double>::infinity()};
  for (const Eigen::Vector3d& point : points) {
    const double depth = CameraDepth(camera, point);
    depths = {std::min(depths.least, depth), std::max(depths.greatest, depth)};
  }
  return depths;
}

Eigen::Matrix<double, 3, 4> PixelFromWorld(const Camera& camera) {
  Eigen::Matrix<double, 3, 4> plane_from_world = camera.camera_from_world.topRows<3>();
  if (camera.orthographic) plane_from_world.row(2) = Eigen::RowVector4d::UnitW();
  return camera.screen_from_camera * plane_from_world;
}

}  // namespace lightfit
