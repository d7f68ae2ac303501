#include "partition/published/storage_factor.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/homography.h"
#include "methods/light_body.h"
#include "methods/view_body.h"

namespace lightfit {

namespace {

// Width at unit depth of the beam of an image of one pixel; of an orthographic view at any depth.
double UnitBeamWidth(const Camera& camera) {
  const double scale = std::abs(camera.screen_from_camera.determinant());
  return std::sqrt(static_cast<double>(camera.width) * camera.height / scale);
}

// What moves a receiver across its ray: d X less its component along the ray.
Eigen::Vector3d AcrossRay(const Light& light, const Eigen::Vector3d& ray, Eigen::Vector3d step) {
  if (light.kind == Light::Kind::kDirectional) return step - step.z() / ray.z() * ray;
  return step - step.dot(ray) / ray.squaredNorm() * ray;
}

}  // namespace

absl::StatusOr<BeamErrors> MaxBeamErrors(const Eigen::Matrix4d& map_from_world,
                                         const Light& light,
                                         const Camera& camera,
                                         absl::Span<const Eigen::Vector3d> corners) {
  const absl::StatusOr<Eigen::Matrix3d> map_from_ray = MapFromRay(map_from_world, light);
  if (!map_from_ray.ok()) return map_from_ray.status();
  const Eigen::Matrix3d ray_from_map = map_from_ray->inverse();
  const Eigen::Matrix<double, 3, 4> ray_from_world = RayFromWorld(light);
  const double unit_width = UnitBeamWidth(camera);
  BeamErrors errors;
  for (const Eigen::Vector3d& corner : corners) {
    // X = w R (u, v, 1), at the receiver's own scale.
    const Eigen::Vector3d ray = ray_from_world * corner.homogeneous();
    const double w = map_from_ray->row(2).dot(ray);
    const Eigen::Vector3d side_u = AcrossRay(light, ray, w * ray_from_map.col(0));
    const Eigen::Vector3d side_v = AcrossRay(light, ray, w * ray_from_map.col(1));
    const double width = unit_width * (camera.orthographic ? 1.0 : CameraDepth(camera, corner));
    errors.u = std::max(errors.u, side_u.norm() / width);
    errors.v = std::max(errors.v, side_u.cross(side_v).norm() / side_u.norm() / width);
  }
  return errors;
}

absl::StatusOr<double> StorageFactor(const Plan& plan, const MethodInput& input) {
  if (absl::Status status = ValidateMethodInput(input); !status.ok()) return status;
  double sum = 0.0;
  for (const PlanMap& map : plan.maps) {
    std::vector<Eigen::Vector4d> cuts = input.cuts;
    for (const Eigen::RowVector4d& half_space : map.half_spaces) {
      cuts.emplace_back(half_space.transpose());
    }
    const std::vector<Eigen::Vector3d> corners = ViewBody(input.camera, input.receivers, cuts);
    const absl::StatusOr<BeamErrors> errors =
        MaxBeamErrors(map.map_from_world, input.light, input.camera, corners);
    if (!errors.ok()) return errors.status();
    sum += map.size.width * errors->u * map.size.height * errors->v;
  }
  return sum;
}

}  // namespace lightfit
