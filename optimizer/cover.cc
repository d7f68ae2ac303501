#include "optimizer/cover.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "absl/strings/str_format.h"
#include "geometry/convex_hull.h"
#include "geometry/ray_cone.h"

namespace lightfit {

namespace {

using Matrix34d = Eigen::Matrix<double, 3, 4>;

absl::Status SurroundedError(const Light& light) {
  return absl::FailedPreconditionError(absl::StrFormat(
      "light \"%s\" at (%g, %g, %g) hangs among its receivers: no single map has all of them in "
      "front of it. Render its shadow with a cube map or a dual paraboloid map, split the receivers "
      "into several maps, or leave receivers that it does not light out of the read-back",
      light.name,
      light.position.x(),
      light.position.y(),
      light.position.z()));
}

absl::Status FlatError(const Light& light) {
  return absl::FailedPreconditionError(absl::StrFormat(
      "light \"%s\": all receivers lie in one plane with the light (or are one point), so that its "
      "map would have no area. Is the surface edge-on to the light? Then it shows no shadow",
      light.name));
}

// Tells quickly whether a point lies inside a convex polygon: first by the largest circle around
// the polygon's centroid, then by binary search among the triangles that fan out from it.
class InsideTest {
 public:
  explicit InsideTest(const Polygon& polygon) : polygon_(polygon), centre_(Centroid(polygon)) {
    radius_squared_ = polygon.size() < 3 ? -1.0 : std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < polygon.size() && polygon.size() >= 3; ++i) {
      const Eigen::Vector2d edge = polygon[(i + 1) % polygon.size()] - polygon[i];
      const double distance = Cross(edge, centre_ - polygon[i]) / edge.norm();
      radius_squared_ = std::min(radius_squared_, distance * distance);
    }
  }

  bool operator()(const Eigen::Vector2d& point) const {
    const Eigen::Vector2d offset = point - centre_;
    if (offset.squaredNorm() <= radius_squared_) return true;
    if (radius_squared_ < 0.0) return false;
    // The fan's edges are sorted by angle from the first one; find the triangle around the point.
    const Eigen::Vector2d first = polygon_[0] - centre_;
    const bool left_half = IsLeft(first, offset);
    size_t low = 0, high = polygon_.size();
    while (high - low > 1) {
      const size_t middle = (low + high) / 2;
      const Eigen::Vector2d spoke = polygon_[middle] - centre_;
      const bool spoke_left = IsLeft(first, spoke);
      const bool after = left_half == spoke_left ? Cross(spoke, offset) >= 0.0 : spoke_left;
      (after ? low : high) = middle;
    }
    const Eigen::Vector2d& from = polygon_[low];
    const Eigen::Vector2d& to = polygon_[low + 1 == polygon_.size() ? 0 : low + 1];
    return Cross(to - from, point - from) >= 0.0;
  }

 private:
  // Angle of `v` from `first` in [0, pi).
  static bool IsLeft(const Eigen::Vector2d& first, const Eigen::Vector2d& v) {
    const double cross = Cross(first, v);
    return cross > 0.0 || (cross == 0.0 && first.dot(v) > 0.0);
  }

  const Polygon& polygon_;
  Eigen::Vector2d centre_;
  double radius_squared_;
};

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

// The convex hull of the rays of one read-back, seen along the third axis of a frame.
class HullBuilder {
 public:
  HullBuilder(const Receivers& receivers, const Matrix34d& frame_from_screen)
      : receivers_(receivers), frame_from_screen_(frame_from_screen) {}

  Polygon ExactHull() {
    // One receiver of every middling tile gives a first hull that is not far off.
    const size_t seeds = receivers_.tile_grids.size() > 1 ? 1 : 0;
    for (const DepthTile& tile : receivers_.tile_grids[seeds].tiles) AddFirstReceiver(tile);
    UpdateHull();
    // Then every tile whose box reaches out of what is known is looked into, coarse to fine.
    const size_t coarsest = receivers_.tile_grids.size() - 1;
    for (size_t i = 0; i < receivers_.tile_grids[coarsest].tiles.size(); ++i) Visit(coarsest, i);
    UpdateHull();
    return std::move(hull_);
  }

 private:
  static constexpr size_t kMaxPending = 48;

  Eigen::Vector2d Project(const Eigen::Vector4d& screen) const {
    return (frame_from_screen_ * screen).hnormalized();
  }

  void Visit(size_t level, size_t index) {
    const TileGrid& grid = receivers_.tile_grids[level];
    const DepthTile& tile = grid.tiles[index];
    if (tile.num_receivers == 0) return;
    const std::array<Eigen::Vector4d, 8> corners = Corners(tile);
    if (std::all_of(corners.begin(), corners.end(), [this](const Eigen::Vector4d& corner) {
          return (*inside_)(Project(corner));
        })) {
      return;
    }
    if (level == 0) {
      receivers_.ForEachReceiver(tile, [this](int x, int y, double d) {
        const Eigen::Vector2d point = Project({x + 0.5, y + 0.5, d, 1.0});
        if (!(*inside_)(point)) pending_.push_back(point);
      });
      if (pending_.size() > kMaxPending) UpdateHull();
      return;
    }
    constexpr int kSide = Receivers::kTilesPerSide;
    const TileGrid& finer = receivers_.tile_grids[level - 1];
    const int first_row = static_cast<int>(index) / grid.columns * kSide;
    const int first_column = static_cast<int>(index) % grid.columns * kSide;
    for (int row = first_row; row < std::min(first_row + kSide, finer.rows); ++row) {
      for (int column = first_column; column < std::min(first_column + kSide, finer.columns);
           ++column) {
        Visit(level - 1, static_cast<size_t>(row) * finer.columns + column);
      }
    }
  }

  void AddFirstReceiver(const DepthTile& tile) {
    if (tile.num_receivers == 0) return;
    const AffineDepth affine_depth(receivers_.readback.camera, receivers_.readback.depth_kind);
    for (int y = tile.y_begin; y < tile.y_end; ++y) {
      for (int x = tile.x_begin; x < tile.x_end; ++x) {
        const double depth =
            receivers_.readback.depth[static_cast<size_t>(y) * receivers_.readback.width() + x];
        if (!affine_depth.IsSurface(depth)) continue;
        pending_.push_back(Project({x + 0.5, y + 0.5, affine_depth.At(x, y, depth), 1.0}));
        return;
      }
    }
  }

  void UpdateHull() {
    pending_.insert(pending_.end(), hull_.begin(), hull_.end());
    hull_ = ConvexHull(std::move(pending_));
    pending_.clear();
    inside_.emplace(hull_);
  }

  const Receivers& receivers_;
  const Matrix34d frame_from_screen_;
  std::vector<Eigen::Vector2d> pending_;  // receivers that may lie outside hull_
  Polygon hull_;
  std::optional<InsideTest> inside_;  // of hull_
};

// Bounds on all receivers at one level of detail: boxes and how many receivers each holds.
struct ReceiverBoxes {
  std::vector<Eigen::Vector4d> corners;  // eight to a box, screen points (x, y, d, 1)
  std::vector<int> num_receivers;
};

ReceiverBoxes BoxesOf(const TileGrid& grid) {
  ReceiverBoxes boxes;
  for (const DepthTile& tile : grid.tiles) {
    if (tile.num_receivers == 0) continue;
    const std::array<Eigen::Vector4d, 8> corners = Corners(tile);
    boxes.corners.insert(boxes.corners.end(), corners.begin(), corners.end());
    boxes.num_receivers.push_back(tile.num_receivers);
  }
  return boxes;
}

// A box for every receiver.
ReceiverBoxes PixelBoxes(const Receivers& receivers) {
  ReceiverBoxes boxes;
  for (const DepthTile& tile : receivers.tile_grids[0].tiles) {
    if (tile.num_receivers == 0) continue;
    receivers.ForEachReceiver(tile, [&boxes](int x, int y, double d) {
      boxes.corners.insert(boxes.corners.end(), 8, Eigen::Vector4d(x + 0.5, y + 0.5, d, 1.0));
      boxes.num_receivers.push_back(1);
    });
  }
  return boxes;
}

// Sets the cover's mean ray and depth, and a frame (a rotation of light space) whose third axis has
// all boxes in front of it. False when there is none.
bool AimAtBoxes(const ReceiverBoxes& boxes,
                const Light& light,
                const Matrix34d& ray_from_screen,
                const Eigen::Matrix4d& world_from_screen,
                RayCover* cover,
                Eigen::Matrix3d* frame_from_ray) {
  frame_from_ray->setIdentity();
  // Depth of a box is extreme at its corners: a linear function of the world point.
  Eigen::RowVector4d depth_from_screen;
  if (light.kind == Light::Kind::kPoint) {
    std::vector<Eigen::Vector3d> rays;
    rays.reserve(boxes.corners.size());
    for (const Eigen::Vector4d& corner : boxes.corners) rays.push_back(ray_from_screen * corner);
    const std::optional<Eigen::Vector3d> axis = FeasibleAxis(rays);
    if (!axis.has_value()) return false;
    *frame_from_ray = FrameAlong(*axis);
    cover->mean_ray.setZero();
    for (size_t box = 0; box < boxes.num_receivers.size(); ++box) {
      // Between two opposite corners lies the middle of the box.
      const Eigen::Vector3d middle = rays[8 * box].normalized() + rays[8 * box + 7].normalized();
      cover->mean_ray += boxes.num_receivers[box] * middle.normalized();
    }
    cover->mean_ray.normalize();
    depth_from_screen = frame_from_ray->row(2) * ray_from_screen;
  } else {
    cover->mean_ray = Eigen::Vector3d::UnitZ();
    depth_from_screen = light.direction.normalized().transpose() * world_from_screen.topRows<3>();
  }
  const Eigen::RowVector4d scale_from_screen = world_from_screen.row(3);
  cover->depth = {std::numeric_limits<double>::infinity(),
                  -std::numeric_limits<double>::infinity()};
  for (const Eigen::Vector4d& corner : boxes.corners) {
    const double depth = depth_from_screen.dot(corner) / scale_from_screen.dot(corner);
    cover->depth.near = std::min(cover->depth.near, depth);
    cover->depth.far = std::max(cover->depth.far, depth);
  }
  return true;
}

}  // namespace

absl::StatusOr<RayCover> CoverReceivers(const Receivers& receivers, const Light& light) {
  const Matrix34d ray_from_screen = RayFromWorld(light) * receivers.world_from_screen;
  RayCover cover;
  Eigen::Matrix3d frame_from_ray;
  // Coarse boxes will do unless they reach around the light where their receivers do not.
  const auto aim_at = [&](const ReceiverBoxes& boxes) {
    return AimAtBoxes(
        boxes, light, ray_from_screen, receivers.world_from_screen, &cover, &frame_from_ray);
  };
  const size_t num_grids = receivers.tile_grids.size();
  const bool aimed = (num_grids > 1 && aim_at(BoxesOf(receivers.tile_grids[1]))) ||
                     aim_at(BoxesOf(receivers.tile_grids[0])) || aim_at(PixelBoxes(receivers));
  if (!aimed) return SurroundedError(light);

  cover.hull = HullBuilder(receivers, frame_from_ray * ray_from_screen).ExactHull();
  const std::optional<Eigen::Matrix3d> normalized = NormalizeRays(frame_from_ray, &cover.hull);
  if (!normalized.has_value()) return FlatError(light);
  cover.normalized_from_ray = *normalized;
  return cover;
}

absl::StatusOr<RayCover> MergeCovers(const RayCover& a, const RayCover& b, const Light& light) {
  std::vector<Eigen::Vector3d> rays;
  const auto append_rays = [&rays](const RayCover& cover) {
    const Eigen::Matrix3d ray_from_normalized = cover.normalized_from_ray.inverse();
    for (const Eigen::Vector2d& vertex : cover.hull) {
      rays.push_back(ray_from_normalized * vertex.homogeneous());
    }
  };
  append_rays(a);
  append_rays(b);

  RayCover merged;
  Eigen::Matrix3d frame_from_ray = Eigen::Matrix3d::Identity();
  if (light.kind == Light::Kind::kPoint) {
    const std::optional<Eigen::Vector3d> axis = FeasibleAxis(rays);
    if (!axis.has_value()) return SurroundedError(light);
    frame_from_ray = FrameAlong(*axis);
    merged.mean_ray = (a.mean_ray + b.mean_ray).normalized();
    // Along the new axis a ray at depth 1 of the old one has depth `ratio`, extreme at hull rays.
    merged.depth = {std::numeric_limits<double>::infinity(), 0.0};
    size_t ray = 0;
    for (const RayCover* cover : {&a, &b}) {
      for (size_t i = 0; i < cover->hull.size(); ++i, ++ray) {
        const double ratio = axis->dot(rays[ray]);
        merged.depth.near = std::min(merged.depth.near, ratio * cover->depth.near);
        merged.depth.far = std::max(merged.depth.far, ratio * cover->depth.far);
      }
    }
  } else {
    merged.depth = {std::min(a.depth.near, b.depth.near), std::max(a.depth.far, b.depth.far)};
  }
  std::vector<Eigen::Vector2d> points;
  points.reserve(rays.size());
  for (const Eigen::Vector3d& ray : rays) points.push_back((frame_from_ray * ray).hnormalized());
  merged.hull = ConvexHull(std::move(points));
  const std::optional<Eigen::Matrix3d> normalized = NormalizeRays(frame_from_ray, &merged.hull);
  if (!normalized.has_value()) return FlatError(light);
  merged.normalized_from_ray = *normalized;
  return merged;
}

}  // namespace lightfit
