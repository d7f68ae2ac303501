#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

#include "tests/testing/box_scene.h"

namespace lightfit {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kTileSize = 16;  // pixels

struct Ray {
  Eigen::Vector3d origin, direction;
};

// A box prepared for casting: what turns world coordinates into its own.
struct CastBox {
  Eigen::Vector3d center, half_size;
  double cos_turn, sin_turn;
  double radius;

  explicit CastBox(const Box& box)
      : center(box.center),
        half_size(box.half_size),
        cos_turn(std::cos(box.turn_rad)),
        sin_turn(std::sin(box.turn_rad)),
        radius(box.half_size.norm()) {}

  Eigen::Vector3d FromWorld(const Eigen::Vector3d& v) const {
    return {cos_turn * v.x() + sin_turn * v.y(), cos_turn * v.y() - sin_turn * v.x(), v.z()};
  }
  Eigen::Vector3d ToWorld(const Eigen::Vector3d& v) const {
    return {cos_turn * v.x() - sin_turn * v.y(), cos_turn * v.y() + sin_turn * v.x(), v.z()};
  }
};

// The part of a ray inside a box (slabs), and the outward normal where it enters.
struct Slabs {
  double enter = -kInfinity, leave = kInfinity;
  int axis = 0;
  double sign = 0.0;  // of the outward normal along the axis
  bool Hit() const { return enter < leave; }
};

Slabs CastSlabs(const Ray& ray, const CastBox& box) {
  const Eigen::Vector3d origin = box.FromWorld(ray.origin - box.center);
  const Eigen::Vector3d direction = box.FromWorld(ray.direction);
  Slabs slabs;
  for (int axis = 0; axis < 3; ++axis) {
    const double o = origin[axis], v = direction[axis], h = box.half_size[axis];
    if (v == 0.0) {
      if (std::abs(o) > h) slabs.leave = -kInfinity;
      continue;
    }
    const double sign = v > 0.0 ? -1.0 : 1.0;
    const double enter = (sign * h - o) / v;
    slabs.leave = std::min(slabs.leave, (-sign * h - o) / v);
    if (enter > slabs.enter) {
      slabs.enter = enter;
      slabs.axis = axis;
      slabs.sign = sign;
    }
  }
  return slabs;
}

bool IsOccluded(const Ray& ray, double length, const CastBox& box) {
  const Slabs slabs = CastSlabs(ray, box);
  return slabs.Hit() && slabs.leave > 0.0 && slabs.enter < length;
}

// Rays through pixel centres, scaled so that the ray parameter is camera z.
class PrimaryRays {
 public:
  explicit PrimaryRays(const Camera& camera)
      : orthographic_(camera.orthographic),
        camera_from_screen_(camera.screen_from_camera.inverse()),
        world_from_camera_(camera.camera_from_world.inverse()) {}

  Ray At(int x, int y) const {
    const Eigen::Vector3d p = camera_from_screen_ * Eigen::Vector3d(x + 0.5, y + 0.5, 1.0);
    const Eigen::Matrix3d rotation = world_from_camera_.topLeftCorner<3, 3>();
    const Eigen::Vector3d center = world_from_camera_.topRightCorner<3, 1>();
    if (orthographic_) {
      return {center + rotation * Eigen::Vector3d(p.x(), p.y(), 0.0), rotation.col(2)};
    }
    return {center, rotation * p};
  }

 private:
  bool orthographic_;
  Eigen::Matrix3d camera_from_screen_;
  Eigen::Matrix4d world_from_camera_;
};

struct SurfacePoint {
  size_t pixel;
  Eigen::Vector3d position, normal;
};

// The nearest surface in front of the camera along a primary ray.
bool CastPrimary(const Ray& ray,
                 double floor_half_size,
                 const std::vector<CastBox>& boxes,
                 double* z,
                 SurfacePoint* surface) {
  *z = kInfinity;
  if (ray.direction.z() != 0.0) {
    const double t = -ray.origin.z() / ray.direction.z();
    const Eigen::Vector3d hit = ray.origin + t * ray.direction;
    if (t > 0.0 && hit.head<2>().lpNorm<Eigen::Infinity>() <= floor_half_size) {
      *z = t;
      surface->normal = ray.direction.z() < 0.0 ? Eigen::Vector3d(0.0, 0.0, 1.0)
                                                : Eigen::Vector3d(0.0, 0.0, -1.0);
    }
  }
  for (const CastBox& box : boxes) {
    const Slabs slabs = CastSlabs(ray, box);
    if (slabs.Hit() && slabs.enter > 0.0 && slabs.enter < *z) {
      *z = slabs.enter;
      surface->normal = box.ToWorld(slabs.sign * Eigen::Vector3d::Unit(slabs.axis));
    }
  }
  surface->position = ray.origin + *z * ray.direction;
  return *z < kInfinity;
}

// Boxes whose bounding sphere comes within `radius` of the ray from `origin`, at most `length`
// long: those that may lie between the light and any surface within `radius` of `origin`.
std::vector<CastBox> BoxesNearRay(const Ray& ray,
                                  double length,
                                  double radius,
                                  const std::vector<CastBox>& boxes) {
  std::vector<CastBox> near;
  for (const CastBox& box : boxes) {
    const Eigen::Vector3d offset = box.center - ray.origin;
    const double along = std::clamp(offset.dot(ray.direction), 0.0, length);
    if ((offset - along * ray.direction).norm() <= radius + box.radius) near.push_back(box);
  }
  return near;
}

// The ray towards the light, direction unit, and its length.
Ray RayToLight(const Eigen::Vector3d& origin, const Light& light, double* length) {
  if (light.kind == Light::Kind::kDirectional) {
    *length = kInfinity;
    return {origin, -light.direction.normalized()};
  }
  const Eigen::Vector3d offset = light.position - origin;
  *length = offset.norm();
  return {origin, offset / *length};
}

// Sets the light's bits at the surfaces, all of one tile: where it does not reach them, and where
// they face it.
void CastShadows(const Light& light,
                 const std::vector<CastBox>& boxes,
                 double floor_half_size,
                 const std::vector<SurfacePoint>& surfaces,
                 SyntheticReadback& readback) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const SurfacePoint& surface : surfaces) middle += surface.position;
  middle /= static_cast<double>(surfaces.size());
  double radius = 0.0;
  for (const SurfacePoint& surface : surfaces) {
    radius = std::max(radius, (surface.position - middle).norm());
  }
  double length = 0.0;
  const Ray middle_ray = RayToLight(middle, light, &length);
  const std::vector<CastBox> near =
      BoxesNearRay(middle_ray, std::min(length, 1e9), radius + kOcclusionOffset, boxes);
  for (const SurfacePoint& surface : surfaces) {
    const Ray ray =
        RayToLight(surface.position + kOcclusionOffset * surface.normal, light, &length);
    const bool is_away = surface.normal.dot(ray.direction) <= 0.0;
    bool blocked = is_away;
    if (ray.direction.z() < 0.0) {
      const double t = -ray.origin.z() / ray.direction.z();
      const Eigen::Vector3d hit = ray.origin + t * ray.direction;
      blocked |=
          t > 0.0 && t < length && hit.head<2>().lpNorm<Eigen::Infinity>() <= floor_half_size;
    }
    for (size_t i = 0; i < near.size() && !blocked; ++i) blocked = IsOccluded(ray, length, near[i]);
    const uint32_t bit = uint32_t{1} << light.shadow_bit;
    if (blocked) readback.shadow_bits[surface.pixel] |= bit;
    if (!is_away) readback.facing_bits[surface.pixel] |= bit;
  }
}

}  // namespace

Readback SyntheticReadback::View() const {
  return {camera, depth, DepthKind::kCameraZ, shadow_bits};
}

Readback SyntheticReadback::ViewWithFacing() const {
  Readback view = View();
  view.facing_bits = facing_bits;
  return view;
}

SyntheticReadback Render(const BoxScene& scene,
                         const Camera& camera,
                         absl::Span<const Light> lights) {
  const size_t num_pixels = static_cast<size_t>(camera.width) * camera.height;
  SyntheticReadback readback;
  readback.camera = camera;
  readback.depth.assign(num_pixels, kSyntheticBackground);
  readback.shadow_bits.assign(num_pixels, 0);
  readback.facing_bits.assign(num_pixels, 0);

  const std::vector<CastBox> boxes(scene.boxes.begin(), scene.boxes.end());
  const PrimaryRays primary_rays(camera);

  const auto render_tile = [&](int x_begin, int y_begin) {
    const int x_end = std::min(x_begin + kTileSize, camera.width);
    const int y_end = std::min(y_begin + kTileSize, camera.height);
    std::vector<SurfacePoint> surfaces;
    for (int y = y_begin; y < y_end; ++y) {
      for (int x = x_begin; x < x_end; ++x) {
        SurfacePoint surface;
        double z = 0.0;
        surface.pixel = static_cast<size_t>(y) * camera.width + x;
        const Ray ray = primary_rays.At(x, y);
        if (!CastPrimary(ray, scene.floor_half_size, boxes, &z, &surface)) continue;
        readback.depth[surface.pixel] = static_cast<float>(z);
        surfaces.push_back(surface);
      }
    }
    if (surfaces.empty()) return;
    for (const Light& light : lights) {
      CastShadows(light, boxes, scene.floor_half_size, surfaces, readback);
    }
  };

  const int num_tile_rows = (camera.height + kTileSize - 1) / kTileSize;
  std::atomic<int> next_row = 0;
  const auto render_rows = [&] {
    for (int row = next_row++; row < num_tile_rows; row = next_row++) {
      for (int x = 0; x < camera.width; x += kTileSize) render_tile(x, row * kTileSize);
    }
  };
  const int num_helpers = std::min<int>(std::thread::hardware_concurrency(), num_tile_rows) - 1;
  std::vector<std::thread> threads;
  threads.reserve(std::max(num_helpers, 0));
  for (int i = 0; i < num_helpers; ++i) threads.emplace_back(render_rows);
  render_rows();
  for (std::thread& thread : threads) thread.join();
  return readback;
}

}  // namespace lightfit
