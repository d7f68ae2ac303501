#include "tests/testing/random_cases.h"

#include <optional>
#include <vector>

#include "geometry/convex_hull.h"
#include "geometry/ray_cone.h"

namespace lightfit::testing {

Camera CameraAround(Random& random, double size, bool orthographic) {
  const int width = random.Int(48, 640), height = random.Int(48, 480);
  const Eigen::Vector3d eye = size * random.Uniform(1.5, 4.0) * random.UnitVector();
  const Eigen::Vector3d target = random.InCube(0.2 * size);
  // One by one: compilers evaluate arguments in an order of their own.
  const double vertical_fov_rad = random.Uniform(0.4, 1.2);
  const Eigen::Vector3d up = random.UnitVector();
  Camera camera = *LookAtCamera(eye, target, up, vertical_fov_rad, width, height);
  camera.screen_from_camera(0, 2) += random.Uniform(-0.2, 0.2) * width;
  camera.screen_from_camera(1, 2) += random.Uniform(-0.2, 0.2) * height;
  if (orthographic) {
    camera.orthographic = true;
    camera.screen_from_camera(0, 0) = camera.screen_from_camera(1, 1) = 0.5 * height / size;
  }
  return camera;
}

Eigen::Vector3d DepthOnPlane(const Camera& camera,
                             const Eigen::Vector3d& normal,
                             double offset,
                             const Eigen::Vector2d& screen) {
  Eigen::Vector4d plane;
  plane << normal, -offset;
  const Eigen::Vector4d p = camera.WorldFromScreen().transpose() * plane;
  return Eigen::Vector3d(-(p(0) * screen.x() + p(1) * screen.y() + p(3)), -p(0), -p(1)) / p(2);
}

PatchCase RandomPatchCase(Random& random, double distance, int num_samples) {
  while (true) {
    PatchCase result;
    const double size = random.LogUniform(1e-2, 1e3);
    result.camera = CameraAround(random, size, random.Coin());
    const Eigen::Vector3d dir_to_light = random.UnitVector();
    result.light = distance > 0.0
                       ? Light::Point("lamp", distance * size * dir_to_light)
                       : Light::Directional("sun", -random.LogUniform(0.1, 10.0) * dir_to_light);
    const Eigen::Matrix4d world_from_screen = result.camera.WorldFromScreen();
    const double camera_distance = result.camera.camera_from_world(2, 3);
    Samples& samples = result.raw;
    samples.ray_from_screen = RayFromWorld(result.light) * world_from_screen;
    for (int attempt = 0; attempt < 40 * num_samples; ++attempt) {
      if (static_cast<int>(samples.size()) == num_samples) break;
      const Eigen::Vector2d screen(random.Int(0, result.camera.width - 1) + 0.5,
                                   random.Int(0, result.camera.height - 1) + 0.5);
      const double z = camera_distance + size * random.Uniform(-0.7, 0.7);
      const double d = result.camera.orthographic ? z : 1.0 / z;
      const Eigen::Vector3d point =
          (world_from_screen * Eigen::Vector4d(screen.x(), screen.y(), d, 1.0)).hnormalized();
      const Eigen::Vector3d neighbour =
          (world_from_screen * Eigen::Vector4d(screen.x(), screen.y(), 1.1 * d, 1.0)).hnormalized();
      const Eigen::Vector3d normal = random.UnitVector();
      const Eigen::Vector4d light = result.light.HomogeneousPosition();
      const Eigen::Vector3d to_light = light.head<3>() - light.w() * point;
      // Not edge-on: the energy of such samples is all rounding, and SelectSamples rejects them.
      if (std::abs(normal.dot((neighbour - point).normalized())) < 0.15) continue;
      if (std::abs(normal.dot(to_light.normalized())) < 0.15) continue;
      const Eigen::Vector3d depth = DepthOnPlane(result.camera, normal, normal.dot(point), screen);
      samples.x.push_back(screen.x());
      samples.y.push_back(screen.y());
      samples.d.push_back(depth(0));
      samples.d_x.push_back(depth(1));
      samples.d_y.push_back(depth(2));
      samples.weight.push_back(random.LogUniform(0.1, 10.0));
      const double angle = random.Uniform(0.0, 2.0 * M_PI);
      const bool known = random.Int(0, 9) > 0;
      samples.edge_normal_x.push_back(known ? std::cos(angle) : 0.0);
      samples.edge_normal_y.push_back(known ? std::sin(angle) : 0.0);
    }
    if (static_cast<int>(samples.size()) < num_samples) continue;
    std::vector<Eigen::Vector3d> rays;
    for (size_t i = 0; i < samples.size(); ++i) rays.push_back(samples.At(i).X);
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
    if (result.light.kind == Light::Kind::kPoint) {
      const std::optional<Eigen::Vector3d> feasible = FeasibleAxis(rays);
      if (!feasible.has_value()) continue;
      axis = *feasible;
      // A cone wider than 80 degrees to a side is left to the tests of near-infeasible sets.
      bool wide = false;
      for (const Eigen::Vector3d& ray : rays) wide |= axis.dot(ray.normalized()) < 0.17;
      if (wide) continue;
    }
    const Eigen::Matrix3d frame = result.light.kind == Light::Kind::kPoint
                                      ? FrameAlong(axis)
                                      : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
    std::vector<Eigen::Vector2d> points;
    points.reserve(rays.size());
    for (const Eigen::Vector3d& ray : rays) points.push_back((frame * ray).hnormalized());
    result.hull = ConvexHull(points);
    const std::optional<Eigen::Matrix3d> normalized = NormalizeRays(frame, &result.hull);
    if (!normalized.has_value()) continue;
    result.normalized_from_ray = *normalized;
    samples.counts.used = num_samples;
    result.normalized = samples;
    result.normalized.ray_from_screen = *normalized * samples.ray_from_screen;
    return result;
  }
}

Eigen::Vector2d PointInPolygon(Random& random, const Polygon& polygon, double share) {
  const size_t i = static_cast<size_t>(random.Int(0, static_cast<int>(polygon.size()) - 1));
  const Eigen::Vector2d edge_point =
      polygon[i] + random.Uniform(0.0, 1.0) * (polygon[(i + 1) % polygon.size()] - polygon[i]);
  return share * edge_point;
}

Eigen::Matrix3d RandomMap(Random& random, const Polygon& hull) {
  const Eigen::Vector2d ab =
      PointInPolygon(random, PolarPolygon(hull, 0.05), random.Uniform(0.0, 1.0));
  Eigen::Matrix3d map_from_ray;
  map_from_ray.row(2) = ab.homogeneous();
  map_from_ray.topLeftCorner<2, 2>() = 300.0 * random.Matrix2(10.0);
  map_from_ray.topRightCorner<2, 1>().setZero();
  Eigen::Vector2d centre;
  centre.y() = random.Uniform(0.0, 1000.0);
  centre.x() = random.Uniform(0.0, 1000.0);
  map_from_ray.topRows<2>() += centre * map_from_ray.row(2);
  return map_from_ray;
}

Polygon RandomPolygon(Random& random, int num_points, double max_aspect) {
  while (true) {
    const Eigen::Matrix2d stretch = random.Matrix2(max_aspect);
    const bool on_circle = random.Coin();
    std::vector<Eigen::Vector2d> points;
    for (int i = 0; i < num_points; ++i) {
      const double angle = random.Uniform(0.0, 2.0 * M_PI);
      const double radius = on_circle ? 1.0 : random.Uniform(0.0, 1.0);
      points.push_back(stretch *
                       Eigen::Vector2d(radius * std::cos(angle), radius * std::sin(angle)));
    }
    Polygon hull = ConvexHull(points);
    if (hull.size() >= 3 && Area(hull) > 1e-3 / max_aspect) return hull;
  }
}

}  // namespace lightfit::testing
