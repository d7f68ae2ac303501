#include "render/surface_image.h"

#include <Eigen/LU>
#include <algorithm>

namespace lightfit {

namespace {

// Rays through the pixels' centres. `z_per_distance` turns a ray's distance into camera z.
struct PixelRay {
  Ray ray;
  double z_per_distance;
};

class PixelRays {
 public:
  explicit PixelRays(const Camera& camera)
      : orthographic_(camera.orthographic),
        camera_from_screen_(camera.screen_from_camera.inverse()),
        world_from_camera_(camera.camera_from_world.inverse()),
        z_axis_(camera.camera_from_world.block<1, 3>(2, 0)) {}

  PixelRay At(int x, int y) const {
    const Eigen::Vector3d in_camera = camera_from_screen_ * Eigen::Vector3d(x + 0.5, y + 0.5, 1.0);
    PixelRay result;
    if (orthographic_) {
      const Eigen::Vector4d start(in_camera.x(), in_camera.y(), 0.0, 1.0);
      result.ray.origin = (world_from_camera_ * start).head<3>();
      result.ray.direction = world_from_camera_.block<3, 1>(0, 2).normalized();
    } else {
      result.ray.origin = world_from_camera_.block<3, 1>(0, 3);
      result.ray.direction = (world_from_camera_.block<3, 3>(0, 0) * in_camera).normalized();
    }
    result.z_per_distance = z_axis_.dot(result.ray.direction);
    return result;
  }

 private:
  bool orthographic_;
  Eigen::Matrix3d camera_from_screen_;
  Eigen::Matrix4d world_from_camera_;
  Eigen::RowVector3d z_axis_;
};

}  // namespace

absl::StatusOr<SurfaceImage> RenderSurfaces(const RayCaster& caster, const Camera& camera) {
  if (absl::Status status = ValidateCamera(camera); !status.ok()) return status;
  SurfaceImage image;
  image.camera = camera;
  image.pixels.resize(static_cast<size_t>(camera.width) * camera.height);
  const PixelRays rays(camera);
  const auto render_rows = [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const PixelRay pixel_ray = rays.At(x, y);
        const Hit hit = caster.FirstHit(pixel_ray.ray);
        if (!hit.is_surface()) continue;
        SurfacePoint& pixel = image.pixels[static_cast<size_t>(y) * camera.width + x];
        pixel.triangle = hit.triangle;
        pixel.position = pixel_ray.ray.origin + hit.distance * pixel_ray.ray.direction;
        const Eigen::Vector3d normal = caster.Normal(hit.triangle);
        pixel.normal =
            normal.dot(pixel_ray.ray.direction) > 0.0 ? Eigen::Vector3d(-normal) : normal;
        pixel.camera_z = hit.distance * pixel_ray.z_per_distance;
      }
    }
  };
  ParallelFor(camera.height, 8, caster.num_threads(), render_rows);
  image.num_surface = std::count_if(image.pixels.begin(),
                                    image.pixels.end(),
                                    [](const SurfacePoint& pixel) { return pixel.is_surface(); });
  return image;
}

}  // namespace lightfit
