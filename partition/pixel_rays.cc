#include "partition/pixel_rays.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "optimizer/figures/forecast_places.h"
#include "optimizer/readback/covered_surfaces.h"

namespace lightfit {

PixelRays::PixelRays(const LightView& view, const SampleOptions& options)
    : surfaces_(*view.surfaces),
      options_(options),
      screen_from_world_(surfaces_.world_from_screen.inverse()),
      light_position_(view.light->HomogeneousPosition()),
      ray_from_screen_(view.normalized_from_ray() * RayFromWorld(*view.light) *
                       surfaces_.world_from_screen) {
  options_.use_outlines = true;
}

std::optional<DepthGradient> PixelRays::PlaneAt(int x, int y) const {
  const Readback& readback = surfaces_.readback;
  const int inner_x = std::clamp(x, 1, readback.width() - 2);
  const int inner_y = std::clamp(y, 1, readback.height() - 2);
  DepthGradient gradient;
  if (!DepthGradientAt(readback, surfaces_.affine_depth, options_, inner_x, inner_y, &gradient)) {
    return std::nullopt;
  }
  if (inner_x == x && inner_y == y) return gradient;
  const double d = surfaces_.affine_depth.At(x, y, readback.depth[readback.Index(x, y)]);
  if (!IsOnSurface(x, y, d, {inner_x, inner_y, gradient})) return std::nullopt;
  gradient.d = d;
  return gradient;
}

bool PixelRays::ShowsShadows(int x, int y, const DepthGradient& plane) const {
  const bool orthographic = surfaces_.readback.camera.orthographic;
  const Eigen::Vector3d normal = SurfaceNormal(screen_from_world_, orthographic, x, y, plane);
  const Eigen::Vector4d screen(x + 0.5, y + 0.5, plane.d, 1.0);
  const Eigen::Vector3d position = (surfaces_.world_from_screen * screen).hnormalized();
  const Eigen::Vector3d to_light = light_position_.head<3>() - light_position_.w() * position;
  return normal.dot(to_light) > options_.min_cos_light * to_light.norm();
}

void PixelRays::AddCorners(int x,
                           int y,
                           const std::optional<DepthGradient>& plane,
                           double half,
                           ScratchVector<Eigen::Vector3d>* rays) const {
  const double centre_x = x + 0.5, centre_y = y + 0.5;
  if (!plane.has_value()) {
    const double depth = surfaces_.readback.depth[surfaces_.readback.Index(x, y)];
    rays->push_back(RayOf(centre_x, centre_y, surfaces_.affine_depth.At(x, y, depth)));
    return;
  }
  const bool orthographic = surfaces_.readback.camera.orthographic;
  for (const double dx : {-half, half}) {
    for (const double dy : {-half, half}) {
      double d = plane->d + dx * plane->d_x + dy * plane->d_y;
      // A plane nearly edge-on to the eye reaches its horizon within the pixel.
      constexpr double kMostChange = 2.0;
      if (!orthographic) d = std::clamp(d, plane->d / kMostChange, plane->d * kMostChange);
      rays->push_back(RayOf(centre_x + dx, centre_y + dy, d));
    }
  }
}

double DistanceFromLight(const Light& light, const Eigen::Vector3d& world) {
  const Eigen::Vector4d position = light.HomogeneousPosition();
  return position.w() > 0.0 ? (world - position.head<3>()).norm() : -position.head<3>().dot(world);
}

DepthRange DistancesFromLight(const Surfaces& surfaces, const Light& light) {
  DepthRange distance = {std::numeric_limits<double>::infinity(),
                         -std::numeric_limits<double>::infinity()};
  ForEachTile(surfaces.tiles.grids[0], [&](const DepthTile& tile) {
    for (const Eigen::Vector4d& corner : Corners(tile)) {
      const Eigen::Vector3d world = (surfaces.world_from_screen * corner).hnormalized();
      const double at = DistanceFromLight(light, world);
      distance = {std::min(distance.near, at), std::max(distance.far, at)};
    }
  });
  return distance;
}

}  // namespace lightfit
