#include "partition/map_depths.h"

#include <algorithm>
#include <optional>

#include "base/stop.h"
#include "optimizer/readback/needed_surfaces.h"
#include "partition/served_rays.h"

namespace lightfit {

bool MapDepths::Fits() const {
  constexpr double kTolerance = 1e-9;  // rounding
  return !IsAsked() || (!(least_z_served < -kTolerance) && most_z <= 1.0 + kTolerance);
}

ScratchVector<MapDepths> FindMapDepths(const LightView& view,
                                       const FitOptions& fit,
                                       absl::Span<const RayMap> maps,
                                       absl::Span<const Eigen::Matrix4d> map_from_world,
                                       double guard_texels) {
  const Surfaces& surfaces = *view.surfaces;
  const Readback& readback = surfaces.readback;
  const uint32_t bit = uint32_t{1} << view.light->shadow_bit;
  const Eigen::Matrix<double, 3, 4> ray_from_world =
      view.normalized_from_ray() * RayFromWorld(*view.light);
  std::optional<NeededSurfaces> needed;
  if (fit.cover == Cover::kShadowed) needed.emplace(surfaces, *view.light, view.border);
  ScratchVector<MapDepths> depths(maps.size());
  const auto look =
      [&](const Eigen::Vector4d& screen, const Eigen::Matrix4d& world_from_screen, bool is_served) {
        Eigen::Vector4d world = world_from_screen * screen;
        world /= world.w();
        const int k = DensestAt(maps, ray_from_world * world, guard_texels);
        if (k < 0) return;
        const double w = map_from_world[k].row(3).dot(world);
        const double z = map_from_world[k].row(2).dot(world) / w;
        MapDepths& of = depths[k];
        of.least_w = std::min(of.least_w, w);
        of.most_w = std::max(of.most_w, w);
        of.most_z = std::max(of.most_z, z);
        if (!is_served) return;
        of.least_w_served = std::min(of.least_w_served, w);
        of.least_z_served = std::min(of.least_z_served, z);
      };
  for (int y = 0; y < readback.height() && !StopRequested(); ++y) {
    for (int x = 0; x < readback.width(); ++x) {
      const size_t pixel = readback.Index(x, y);
      if (!surfaces.affine_depth.IsSurface(readback.depth[pixel])) continue;
      const double d = surfaces.affine_depth.At(x, y, readback.depth[pixel]);
      look({x + 0.5, y + 0.5, d, 1.0},
           surfaces.world_from_screen,
           !needed.has_value() || (needed->words()[pixel] & bit) != 0);
    }
  }
  for (const FineSurfaces& fine : FineSurfacesServed(view, fit)) {
    fine.ForEach([&](const Eigen::Vector4d& cell) {
      look(cell, fine.surfaces.world_from_screen, /*is_served=*/true);
    });
  }
  return depths;
}

void LayDepthRow(const Light& light,
                 const MapDepths& depths,
                 DepthRange distances,
                 double room,
                 Eigen::Matrix4d* map_from_world) {
  constexpr double kBetweenPixels = 0.01;
  room += kBetweenPixels;
  const double w_min = depths.least_w / (1.0 + room);
  DepthRange range;
  if (light.kind == Light::Kind::kPoint) {
    range = {std::min(depths.least_w_served, depths.most_w) / (1.0 + room),
             depths.most_w * (1.0 + room)};
  } else {
    const double extent = distances.far - distances.near;
    range = {distances.near - room * extent, distances.far + room * extent};
  }
  Eigen::Matrix<double, 3, 4> rows;
  rows << map_from_world->topRows<2>(), map_from_world->row(3);
  const Eigen::Matrix4d laid = MapFromWorld(Eigen::Matrix3d::Identity(), rows, light, range, w_min);
  if (laid.allFinite()) map_from_world->row(2) = laid.row(2);
}

}  // namespace lightfit
