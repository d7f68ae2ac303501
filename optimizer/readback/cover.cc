#include "optimizer/readback/cover.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "absl/strings/str_format.h"
#include "base/scratch.h"
#include "base/stop.h"
#include "geometry/convex_hull.h"
#include "geometry/ray_cone.h"
#include "optimizer/readback/cover_hull.h"
#include "optimizer/readback/covered_surfaces.h"
#include "optimizer/readback/fine_surfaces.h"
#include "optimizer/readback/needed_surfaces.h"

namespace lightfit {

namespace {

absl::Status FlatError(const Light& light) {
  return absl::FailedPreconditionError(absl::StrFormat(
      "light \"%s\": all receivers lie in one plane with the light (or are one point), so that its "
      "map would have no area. Is the surface edge-on to the light? Then it shows no shadow",
      light.name));
}

// What is to be covered in one image, with the rays of its screen points.
struct Layer {
  const DepthTiles* tiles;
  Matrix34d ray_from_screen;
};

// An axis that has all boxes of the grids in front of it; of coarse ones where `level` is above 0.
std::optional<Eigen::Vector3d> AxisOfBoxes(absl::Span<const Layer> layers, size_t level) {
  ScratchVector<Eigen::Vector3d> rays;
  for (const Layer& layer : layers) {
    const auto& grids = layer.tiles->grids;
    ForEachTile(grids[std::min(level, grids.size() - 1)], [&](const DepthTile& tile) {
      for (const Eigen::Vector4d& corner : Corners(tile)) {
        rays.push_back(layer.ray_from_screen * corner);
      }
    });
  }
  return FeasibleAxis(rays);
}

// Few, coarse boxes will do unless they reach around the light where finer ones do not.
std::optional<Eigen::Vector3d> AxisOfBoxes(absl::Span<const Layer> layers) {
  std::optional<Eigen::Vector3d> axis = AxisOfBoxes(layers, 1);
  if (!axis.has_value()) axis = AxisOfBoxes(layers, 0);
  return axis;
}

Eigen::Vector3d MeanRay(const TileGrid& grid, const Matrix34d& ray_from_screen) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  ForEachTile(grid, [&](const DepthTile& tile) {
    const Eigen::Vector4d middle(0.5 * (tile.x_begin + tile.x_end),
                                 0.5 * (tile.y_begin + tile.y_end),
                                 0.5 * (tile.d_min + tile.d_max),
                                 1.0);
    sum += tile.num_surfaces * (ray_from_screen * middle).normalized();
  });
  return sum.normalized();
}

// The boxes that hold rays close to the covered ones, in four times their square, and perhaps some
// more: all but those whose corners lie beyond one and the same side of it.
TileGrid BoxesAlong(const TileGrid& grid, const Matrix34d& normalized_from_screen) {
  constexpr double kCloseBy = 4.0;
  TileGrid close;
  ForEachTile(grid, [&](const DepthTile& tile) {
    // Bits: which sides all corners seen so far are beyond.
    unsigned beyond = 0xf;
    for (const Eigen::Vector4d& corner : Corners(tile)) {
      const Eigen::Vector3d ray = normalized_from_screen * corner;
      const double limit = kCloseBy * ray.z();
      beyond &= (ray.x() > limit ? 1u : 0u) | (-ray.x() > limit ? 2u : 0u) |
                (ray.y() > limit ? 4u : 0u) | (-ray.y() > limit ? 8u : 0u);
    }
    if (beyond == 0) close.tiles.push_back(tile);
  });
  return close;
}

// A linear function of the world point, on the screen.
struct DepthOnScreen {
  DepthOnScreen(const Eigen::RowVector4d& depth_from_world,
                const Eigen::Matrix4d& world_from_screen)
      : depth_from_screen(depth_from_world * world_from_screen),
        scale_from_screen(world_from_screen.row(3)) {}

  Eigen::RowVector4d depth_from_screen, scale_from_screen;

  double At(const Eigen::Vector4d& screen) const {
    return depth_from_screen.dot(screen) / scale_from_screen.dot(screen);
  }
};

// How much nearer to a point light than all that is lit something dark may be, as a share, and
// still be told from what hides it: beside the light itself there is no bound.
constexpr double kLeastNear = 0.01;

constexpr DepthRange kNoDepth = {std::numeric_limits<double>::infinity(),
                                 -std::numeric_limits<double>::infinity()};

DepthRange Extended(const DepthRange& range, double depth) {
  return {std::min(range.near, depth), std::max(range.far, depth)};
}

// Extreme at corners.
DepthRange RangeOverBox(const DepthTile& tile, const DepthOnScreen& depth, DepthRange range) {
  for (const Eigen::Vector4d& corner : Corners(tile)) range = Extended(range, depth.At(corner));
  return range;
}

DepthRange RangeOverBoxes(const TileGrid& grid, const DepthOnScreen& depth) {
  DepthRange range = kNoDepth;
  ForEachTile(grid, [&](const DepthTile& tile) { range = RangeOverBox(tile, depth, range); });
  return range;
}

DepthRange RangeOverReceivers(const CoveredSurfaces& covered, const DepthOnScreen& depth) {
  DepthRange range = kNoDepth;
  ForEachTile(covered.tiles.grids[0], [&](const DepthTile& tile) {
    const DepthRange with_box = RangeOverBox(tile, depth, range);
    if (with_box.near == range.near && with_box.far == range.far) return;
    covered.ForEach(tile, [&](const Eigen::Vector4d& receiver) {
      range = Extended(range, depth.At(receiver));
    });
  });
  return range;
}

}  // namespace

absl::Status SurroundedError(const Light& light) {
  return absl::FailedPreconditionError(absl::StrFormat(
      "light \"%s\": at (%g, %g, %g) it hangs among its receivers: no single map has all of them "
      "in "
      "front of it. Render its shadow with a cube map or a dual paraboloid map, split the "
      "receivers "
      "into several maps, or leave receivers that it does not light out of the read-back",
      light.name,
      light.position.x(),
      light.position.y(),
      light.position.z()));
}

absl::StatusOr<RayCover> CoverReceivers(
    const Surfaces& surfaces, const Light& light, Cover which, Border border, bool use_fine_cover) {
  std::optional<NeededSurfaces> filter;
  DepthTiles needed;
  if (which == Cover::kShadowed) {
    filter.emplace(surfaces, light, border);
    needed = BuildDepthTiles(surfaces.readback,
                             surfaces.affine_depth,
                             {filter->words(), uint32_t{1} << light.shadow_bit});
  }
  const bool covers_all = needed.num_surfaces == 0;
  ScratchVector<FineSurfaces> fine;
  if (use_fine_cover && !covers_all) fine = FindFineSurfaces(surfaces, light, border);
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  const CoveredSurfaces covered = {surfaces, covers_all ? surfaces.tiles : needed};
  const DepthTiles& tiles = covered.tiles;
  const Matrix34d ray_from_screen = RayFromWorld(light) * surfaces.world_from_screen;
  RayCover cover;
  cover.border = border;
  cover.nothing_to_cover = which == Cover::kShadowed && covers_all;
  Eigen::Matrix3d frame_from_ray = Eigen::Matrix3d::Identity();
  Eigen::RowVector4d depth_from_world = Eigen::RowVector4d::Zero();
  bool one_by_one = false;
  if (light.kind == Light::Kind::kPoint) {
    ScratchVector<Layer> layers = {{&tiles, ray_from_screen}};
    for (const FineSurfaces& layer : fine) {
      layers.push_back({&layer.tiles, layer.ray_from_screen});
    }
    std::optional<Eigen::Vector3d> axis = AxisOfBoxes(layers);
    if (!axis.has_value() && !fine.empty()) {
      fine.clear();
      layers.resize(1);
      axis = AxisOfBoxes(layers);
    }
    if (axis.has_value()) {
      cover.mean_ray = MeanRay(tiles.grids[0], ray_from_screen);
    } else {
      // Look at every receiver, unless a few of them surround the light already.
      ScratchVector<Eigen::Vector3d> some_rays;
      for (const Eigen::Vector4d& receiver : OneReceiverPerTile(covered, 0)) {
        some_rays.push_back(ray_from_screen * receiver);
      }
      if (FeasibleAxis(some_rays).has_value()) {
        one_by_one = true;
        const UnitRaySum sum = SumOfUnitRays(covered, ray_from_screen);
        axis = FeasibleAxis(sum, [&](const Eigen::Vector3d& along) {
          return LowestOfUnitRays(covered, ray_from_screen, along);
        });
        cover.mean_ray = sum.sum.normalized();
      }
    }
    if (absl::Status status = CheckStop(light); !status.ok()) return status;
    if (!axis.has_value()) return SurroundedError(light);
    frame_from_ray = FrameAlong(*axis);
    depth_from_world = frame_from_ray.row(2) * RayFromWorld(light);
  } else {
    depth_from_world.head<3>() = light.direction.stableNormalized().transpose();
  }
  const DepthOnScreen depth(depth_from_world, surfaces.world_from_screen);
  cover.depth =
      one_by_one ? RangeOverReceivers(covered, depth) : RangeOverBoxes(tiles.grids[0], depth);

  cover.hull = ExactHull(covered, frame_from_ray * ray_from_screen);
  if (!fine.empty()) {
    ScratchVector<Eigen::Vector2d> points(cover.hull.begin(), cover.hull.end());
    for (const FineSurfaces& layer : fine) {
      const Polygon hull =
          ExactHull({layer.surfaces, layer.tiles}, frame_from_ray * layer.ray_from_screen);
      points.insert(points.end(), hull.begin(), hull.end());
      const DepthRange range = RangeOverBoxes(
          layer.tiles.grids[0], DepthOnScreen(depth_from_world, layer.surfaces.world_from_screen));
      cover.depth = Extended(Extended(cover.depth, range.near), range.far);
    }
    cover.hull = ConvexHull(points);
  }
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  std::optional<Eigen::Matrix3d> normalized = NormalizeRays(frame_from_ray, &cover.hull);
  if (!normalized.has_value() && !covers_all) {
    // A single pixel to cover, or a row of them: what is around their centres has area.
    cover.hull = HullOfSurroundings(covered, frame_from_ray * ray_from_screen);
    if (!cover.hull.empty()) normalized = NormalizeRays(frame_from_ray, &cover.hull);
  }
  if (!normalized.has_value()) {
    if (covers_all) return FlatError(light);
    return CoverReceivers(surfaces, light, Cover::kReceivers, border);
  }
  cover.normalized_from_ray = *normalized;
  if (!covers_all) {
    // What need not be covered may land in the map too, behind all that is; or in front of it,
    // which matters where it is dark.
    const TileGrid close = BoxesAlong(surfaces.tiles.grids[0], *normalized * ray_from_screen);
    const DepthRange all = RangeOverBoxes(close, depth);
    cover.depth.far = std::max(cover.depth.far, all.far);
    if (border == Border::kDark) {
      cover.depth.near = light.kind == Light::Kind::kPoint
                             ? std::clamp(all.near, kLeastNear * cover.depth.near, cover.depth.near)
                             : std::min(all.near, cover.depth.near);
    }
    if (absl::Status status = CheckStop(light); !status.ok()) return status;
  }
  return cover;
}

absl::StatusOr<RayCover> CoverRays(absl::Span<const Eigen::Vector3d> rays,
                                   DepthRange depth,
                                   const Eigen::Vector3d& mean_ray,
                                   const Light& light) {
  RayCover cover;
  cover.depth = depth;
  Eigen::Matrix3d frame_from_ray = Eigen::Matrix3d::Identity();
  if (light.kind == Light::Kind::kPoint) {
    const std::optional<Eigen::Vector3d> axis = FeasibleAxis(rays);
    if (!axis.has_value()) return SurroundedError(light);
    frame_from_ray = FrameAlong(*axis);
    // A receiver at some distance is nearer than that along the axis, by its ray's cosine.
    double min_cos = 1.0;
    for (const Eigen::Vector3d& ray : rays)
      min_cos = std::min(min_cos, axis->dot(ray) / ray.norm());
    cover.depth.near = depth.near * min_cos;
    cover.mean_ray = mean_ray.squaredNorm() > 0.0 ? mean_ray.normalized() : *axis;
  }
  ScratchVector<Eigen::Vector2d> points;
  points.reserve(rays.size());
  for (const Eigen::Vector3d& ray : rays) points.push_back((frame_from_ray * ray).hnormalized());
  cover.hull = ConvexHull(points);
  const std::optional<Eigen::Matrix3d> normalized = NormalizeRays(frame_from_ray, &cover.hull);
  if (!normalized.has_value()) return FlatError(light);
  cover.normalized_from_ray = *normalized;
  return cover;
}

}  // namespace lightfit
