#include "partition/published/view_grid.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "methods/view_body.h"

namespace lightfit {

namespace {

constexpr int kCells = 24;  // of the screen, along each side
constexpr int kDepths = 8;  // on a view ray

// World point of a view ray at camera depth z: origin + z slope.
struct ViewRay {
  Eigen::Vector3d origin, slope;
};

ViewRay RayThrough(const Camera& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Matrix4d world_from_camera = camera.camera_from_world.inverse();
  const Eigen::Vector3d at = camera.screen_from_camera.inverse() * pixel.homogeneous();
  const Eigen::Matrix3d axes = world_from_camera.topLeftCorner<3, 3>();
  const Eigen::Vector3d eye = world_from_camera.topRightCorner<3, 1>();
  if (camera.orthographic) {
    return {eye + axes.leftCols<2>() * at.head<2>(), axes.col(2)};
  }
  return {eye, axes * at};
}

// Leaves of the depths those where plane . (x, 1) >= 0.
void Clip(const ViewRay& ray, const Eigen::Vector4d& plane, ViewDepths* depths) {
  const double start = plane.dot(ray.origin.homogeneous());
  const double growth = plane.head<3>().dot(ray.slope);
  const double end = -start / growth;
  if (growth > 0.0) {
    depths->least = std::max(depths->least, end);
  } else if (growth < 0.0) {
    depths->greatest = std::min(depths->greatest, end);
  } else if (start < 0.0) {
    depths->greatest = -std::numeric_limits<double>::infinity();
  }
}

// Pixels for each unit of area across the view ray.
double PixelDensity(const Camera& camera, const Eigen::Vector3d& position) {
  const double focal_area = std::abs(camera.screen_from_camera.determinant());
  if (camera.orthographic) return focal_area;
  const double z = CameraDepth(camera, position);
  return focal_area * (position - EyePosition(camera)).norm() / (z * z * z);
}

}  // namespace

std::vector<ViewGridPoint> ViewGrid(const MethodInput& input) {
  const Camera& camera = input.camera;
  std::vector<Eigen::Vector4d> planes = input.cuts;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
    planes.emplace_back(unit.x(), unit.y(), unit.z(), -input.receivers.min()(axis));
    planes.emplace_back(-unit.x(), -unit.y(), -unit.z(), input.receivers.max()(axis));
  }
  std::vector<ViewGridPoint> grid;
  for (int row = 0; row < kCells; ++row) {
    for (int column = 0; column < kCells; ++column) {
      const Eigen::Vector2d pixel((column + 0.5) / kCells * camera.width,
                                  (row + 0.5) / kCells * camera.height);
      const ViewRay ray = RayThrough(camera, pixel);
      ViewDepths depths = {camera.near, camera.far};
      for (const Eigen::Vector4d& plane : planes) Clip(ray, plane, &depths);
      if (!(depths.least < depths.greatest)) continue;
      for (int i = 0; i < kDepths; ++i) {
        const double share = (i + 0.5) / kDepths;
        const double z = depths.least * std::pow(depths.greatest / depths.least, share);
        ViewGridPoint point;
        point.position = ray.origin + z * ray.slope;
        point.scale = PixelDensity(camera, point.position);
        if (input.light.kind == Light::Kind::kPoint) {
          point.scale /= (point.position - input.light.position).norm();
        }
        grid.push_back(point);
      }
    }
  }
  return grid;
}

double MeanTexelSide(const PlanLookUp& look_up, const std::vector<ViewGridPoint>& grid) {
  double sum = 0.0;
  for (const ViewGridPoint& point : grid) {
    const PlanPlace place = look_up.At(point.position);
    if (place.map < 0) return std::numeric_limits<double>::infinity();
    const double q = look_up.CoarsenessOf(place.map, point.position);
    sum += std::sqrt(point.scale * q * q * q);
  }
  return grid.empty() ? 0.0 : sum / static_cast<double>(grid.size());
}

}  // namespace lightfit
