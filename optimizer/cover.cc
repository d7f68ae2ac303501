#include "optimizer/cover.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>

#include "absl/strings/str_format.h"
#include "geometry/convex_hull.h"
#include "geometry/inside_test.h"
#include "geometry/ray_cone.h"
#include "geometry/scratch.h"
#include "optimizer/stop.h"

namespace lightfit {

namespace {

using Matrix34d = Eigen::Matrix<double, 3, 4>;

absl::Status FlatError(const Light& light) {
  return absl::FailedPreconditionError(absl::StrFormat(
      "light \"%s\": all receivers lie in one plane with the light (or are one point), so that its "
      "map would have no area. Is the surface edge-on to the light? Then it shows no shadow",
      light.name));
}

// The corners of a tile's box of pixel centres and affine depths, as screen points (x, y, d, 1).
std::array<Eigen::Vector4d, 8> Corners(const DepthTile& tile) {
  std::array<Eigen::Vector4d, 8> corners;
  int i = 0;
  for (const double d : {tile.d_min, tile.d_max}) {
    for (const double y : {tile.y_begin + 0.5, tile.y_end - 0.5}) {
      for (const double x : {tile.x_begin + 0.5, tile.x_end - 0.5}) {
        corners[i++] = Eigen::Vector4d(x, y, d, 1.0);
      }
    }
  }
  return corners;
}

// The receivers that are to be covered, and when to stop looking at them.
struct CoveredSurfaces {
  const Receivers& receivers;
  const DepthTiles& tiles;
  const std::stop_token& stop;

  template <typename Visitor>
  void ForEach(const DepthTile& tile, const Visitor& visit) const {
    ForEachSurface(receivers.readback, receivers.affine_depth, tiles.filter, tile, visit);
  }
};

// The first covered receiver of every tile that has any, as screen points (x, y, d, 1).
ScratchVector<Eigen::Vector4d> OneReceiverPerTile(const CoveredSurfaces& covered, size_t grid) {
  const Readback& readback = covered.receivers.readback;
  const uint32_t mask = covered.tiles.filter.shadow_mask;
  const auto first_receiver = [&](const DepthTile& tile) -> Eigen::Vector4d {
    for (int y = tile.y_begin; y < tile.y_end; ++y) {
      for (int x = tile.x_begin; x < tile.x_end; ++x) {
        const size_t pixel = static_cast<size_t>(y) * readback.width() + x;
        if (mask != 0 && (readback.shadow_bits[pixel] & mask) == 0) continue;
        const double depth = readback.depth[pixel];
        if (!covered.receivers.affine_depth.IsSurface(depth)) continue;
        return {x + 0.5, y + 0.5, covered.receivers.affine_depth.At(x, y, depth), 1.0};
      }
    }
    return Eigen::Vector4d::Zero();  // not reached: the tile has a receiver
  };
  ScratchVector<Eigen::Vector4d> found;
  for (const DepthTile& tile : covered.tiles.grids[grid].tiles) {
    if (covered.stop.stop_requested()) break;
    if (tile.num_surfaces > 0) found.push_back(first_receiver(tile));
  }
  return found;
}

// The convex hull of the rays of one read-back, seen along the third axis of a frame.
class HullBuilder {
 public:
  HullBuilder(const CoveredSurfaces& covered, const Matrix34d& frame_from_screen)
      : covered_(covered), frame_from_screen_(frame_from_screen) {}

  Polygon ExactHull() {
    // One receiver of every middling tile gives a first hull that is not far off.
    const size_t seeds = covered_.tiles.grids.size() > 1 ? 1 : 0;
    for (const Eigen::Vector4d& receiver : OneReceiverPerTile(covered_, seeds)) {
      pending_.push_back(Project(receiver));
    }
    UpdateHull();
    // Then every tile whose box reaches out of what is known is looked into, coarse to fine.
    const size_t coarsest = covered_.tiles.grids.size() - 1;
    for (size_t i = 0; i < covered_.tiles.grids[coarsest].tiles.size(); ++i) Visit(coarsest, i);
    UpdateHull();
    return std::move(hull_);
  }

 private:
  static constexpr size_t kMaxPending = 128;

  Eigen::Vector2d Project(const Eigen::Vector4d& screen) const {
    return (frame_from_screen_ * screen).hnormalized();
  }

  // Looks into a tile unless its box is inside the hull. Also where InsideTest does not recognise
  // it.
  void Visit(size_t level, size_t index) {
    const TileGrid& grid = covered_.tiles.grids[level];
    const DepthTile& tile = grid.tiles[index];
    if (tile.num_surfaces == 0 || covered_.stop.stop_requested()) return;
    const std::array<Eigen::Vector4d, 8> corners = Corners(tile);
    if (std::all_of(corners.begin(), corners.end(), [this](const Eigen::Vector4d& corner) {
          return (*inside_)(Project(corner));
        })) {
      return;
    }
    if (level == 0) {
      covered_.ForEach(tile, [this](int x, int y, double d) {
        const Eigen::Vector2d point = Project({x + 0.5, y + 0.5, d, 1.0});
        if (!(*inside_)(point)) pending_.push_back(point);
      });
      if (pending_.size() > kMaxPending) UpdateHull();
      return;
    }
    constexpr int kSide = DepthTiles::kTilesPerSide;
    const TileGrid& finer = covered_.tiles.grids[level - 1];
    const int first_row = static_cast<int>(index) / grid.columns * kSide;
    const int first_column = static_cast<int>(index) % grid.columns * kSide;
    for (int row = first_row; row < std::min(first_row + kSide, finer.rows); ++row) {
      for (int column = first_column; column < std::min(first_column + kSide, finer.columns);
           ++column) {
        Visit(level - 1, static_cast<size_t>(row) * finer.columns + column);
      }
    }
  }

  void UpdateHull() {
    pending_.insert(pending_.end(), hull_.begin(), hull_.end());
    hull_ = ConvexHull(pending_);
    pending_.clear();
    inside_.emplace(hull_);
  }

  const CoveredSurfaces& covered_;
  const Matrix34d frame_from_screen_;
  ScratchVector<Eigen::Vector2d> pending_;  // receivers that may lie outside hull_
  Polygon hull_;
  std::optional<InsideTest> inside_;  // of hull_
};

// A box for every receiver: the way out where tiles reach around the light and receivers do not.
TileGrid PixelGrid(const CoveredSurfaces& covered) {
  TileGrid pixels;
  for (const DepthTile& tile : covered.tiles.grids[0].tiles) {
    if (covered.stop.stop_requested()) break;
    if (tile.num_surfaces == 0) continue;
    covered.ForEach(tile, [&pixels](int x, int y, double d) {
      pixels.tiles.push_back({x, y, x + 1, y + 1, d, d, 1});
    });
  }
  return pixels;
}

// An axis that has all boxes of the grid in front of it.
std::optional<Eigen::Vector3d> AxisOfBoxes(const TileGrid& grid, const Matrix34d& ray_from_screen) {
  ScratchVector<Eigen::Vector3d> rays;
  rays.reserve(8 * grid.tiles.size());
  for (const DepthTile& tile : grid.tiles) {
    if (tile.num_surfaces == 0) continue;
    for (const Eigen::Vector4d& corner : Corners(tile)) rays.push_back(ray_from_screen * corner);
  }
  return FeasibleAxis(rays);
}

Eigen::Vector3d MeanRay(const TileGrid& grid, const Matrix34d& ray_from_screen) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const DepthTile& tile : grid.tiles) {
    if (tile.num_surfaces == 0) continue;
    const Eigen::Vector4d middle(0.5 * (tile.x_begin + tile.x_end),
                                 0.5 * (tile.y_begin + tile.y_end),
                                 0.5 * (tile.d_min + tile.d_max),
                                 1.0);
    sum += tile.num_surfaces * (ray_from_screen * middle).normalized();
  }
  return sum.normalized();
}

// The boxes that hold rays close to the covered ones, in four times their square, and perhaps some
// more: all but those whose corners lie beyond one and the same side of it.
TileGrid BoxesAlong(const TileGrid& grid, const Matrix34d& normalized_from_screen) {
  constexpr double kCloseBy = 4.0;
  TileGrid close;
  for (const DepthTile& tile : grid.tiles) {
    if (tile.num_surfaces == 0) continue;
    // Bits: which sides all corners seen so far are beyond.
    unsigned beyond = 0xf;
    for (const Eigen::Vector4d& corner : Corners(tile)) {
      const Eigen::Vector3d ray = normalized_from_screen * corner;
      const double limit = kCloseBy * ray.z();
      beyond &= (ray.x() > limit ? 1u : 0u) | (-ray.x() > limit ? 2u : 0u) |
                (ray.y() > limit ? 4u : 0u) | (-ray.y() > limit ? 8u : 0u);
    }
    if (beyond == 0) close.tiles.push_back(tile);
  }
  return close;
}

// The range over all boxes of a linear function of the world point, which is extreme at corners.
DepthRange RangeOverBoxes(const TileGrid& grid,
                          const Eigen::RowVector4d& depth_from_screen,
                          const Eigen::RowVector4d& scale_from_screen) {
  DepthRange range = {std::numeric_limits<double>::infinity(),
                      -std::numeric_limits<double>::infinity()};
  for (const DepthTile& tile : grid.tiles) {
    if (tile.num_surfaces == 0) continue;
    for (const Eigen::Vector4d& corner : Corners(tile)) {
      const double depth = depth_from_screen.dot(corner) / scale_from_screen.dot(corner);
      range = {std::min(range.near, depth), std::max(range.far, depth)};
    }
  }
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

absl::StatusOr<RayCover> CoverReceivers(const Receivers& receivers,
                                        const Light& light,
                                        Cover which,
                                        const std::stop_token& stop) {
  DepthTiles shadowed;
  if (which == Cover::kShadowed) {
    shadowed = BuildDepthTiles(
        receivers.readback, receivers.affine_depth, {uint32_t{1} << light.shadow_bit}, stop);
  }
  if (absl::Status status = CheckStop(stop, light); !status.ok()) return status;
  const bool covers_all = shadowed.num_surfaces == 0;
  const CoveredSurfaces covered = {receivers, covers_all ? receivers.tiles : shadowed, stop};
  const DepthTiles& tiles = covered.tiles;
  const Matrix34d ray_from_screen = RayFromWorld(light) * receivers.world_from_screen;
  const Eigen::RowVector4d scale_from_screen = receivers.world_from_screen.row(3);
  const TileGrid* boxes = &tiles.grids[0];
  RayCover cover;
  cover.nothing_shadowed = which == Cover::kShadowed && covers_all;
  Eigen::Matrix3d frame_from_ray = Eigen::Matrix3d::Identity();
  Eigen::RowVector4d depth_from_screen;
  TileGrid pixels;
  if (light.kind == Light::Kind::kPoint) {
    // Few, coarse boxes will do unless they reach around the light where finer ones do not.
    std::optional<Eigen::Vector3d> axis;
    for (size_t level = std::min<size_t>(1, tiles.grids.size() - 1) + 1; level-- > 0;) {
      axis = AxisOfBoxes(tiles.grids[level], ray_from_screen);
      if (axis.has_value()) break;
    }
    if (!axis.has_value()) {
      // Look at every receiver, unless a few of them surround the light already.
      ScratchVector<Eigen::Vector3d> some_rays;
      for (const Eigen::Vector4d& receiver : OneReceiverPerTile(covered, 0)) {
        some_rays.push_back(ray_from_screen * receiver);
      }
      if (!FeasibleAxis(some_rays).has_value()) {
        absl::Status status = CheckStop(stop, light);
        return status.ok() ? SurroundedError(light) : status;
      }
      pixels = PixelGrid(covered);
      if (absl::Status status = CheckStop(stop, light); !status.ok()) return status;
      boxes = &pixels;
      axis = AxisOfBoxes(pixels, ray_from_screen);
    }
    if (!axis.has_value()) return SurroundedError(light);
    frame_from_ray = FrameAlong(*axis);
    cover.mean_ray = MeanRay(*boxes, ray_from_screen);
    depth_from_screen = frame_from_ray.row(2) * ray_from_screen;
  } else {
    depth_from_screen =
        light.direction.stableNormalized().transpose() * receivers.world_from_screen.topRows<3>();
  }
  cover.depth = RangeOverBoxes(*boxes, depth_from_screen, scale_from_screen);

  cover.hull = HullBuilder(covered, frame_from_ray * ray_from_screen).ExactHull();
  if (absl::Status status = CheckStop(stop, light); !status.ok()) return status;
  const std::optional<Eigen::Matrix3d> normalized = NormalizeRays(frame_from_ray, &cover.hull);
  if (!normalized.has_value()) {
    // A single shadowed pixel, or a row of them, has no area, which is as good as no shadow.
    return covers_all ? FlatError(light)
                      : CoverReceivers(receivers, light, Cover::kReceivers, stop);
  }
  cover.normalized_from_ray = *normalized;
  if (!covers_all) {
    // What is lit may land in the map too, behind all that is shadowed.
    const TileGrid close = BoxesAlong(receivers.tiles.grids[0], *normalized * ray_from_screen);
    cover.depth.far =
        std::max(cover.depth.far, RangeOverBoxes(close, depth_from_screen, scale_from_screen).far);
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
