#include "optimizer/cover.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
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

// Rays of one read-back seen along `frame`'s third axis.
class HullBuilder {
 public:
  HullBuilder(const Receivers& receivers, const Matrix34d& frame_from_screen)
      : receivers_(receivers), frame_from_screen_(frame_from_screen) {}

  // `corners`: eight to a tile, as screen points (x, y, d, 1).
  Polygon ExactHull(const std::vector<Eigen::Vector4d>& corners) {
    std::vector<Eigen::Vector2d> corner_points;
    corner_points.reserve(corners.size());
    for (const Eigen::Vector4d& corner : corners) corner_points.push_back(Project(corner));

    // First look into the tiles that carry the hull of all corners: most of the exact hull is there.
    std::vector<bool> looked_into(receivers_.tiles.size(), false);
    const Polygon outer = ConvexHull(corner_points);
    const InsideTest strictly_inside_outer(outer);
    for (size_t tile = 0; tile < receivers_.tiles.size(); ++tile) {
      for (int i = 0; i < 8 && !looked_into[tile]; ++i) {
        looked_into[tile] = std::find(outer.begin(), outer.end(), corner_points[8 * tile + i]) !=
                            outer.end();
      }
      if (looked_into[tile]) AddTile(receivers_.tiles[tile], nullptr);
    }
    hull_ = ConvexHull(std::move(points_));
    // Then into every other tile whose box still reaches out of what is known.
    constexpr size_t kMaxPending = 4096;
    std::optional<InsideTest> inside(hull_);
    points_.clear();
    for (size_t tile = 0; tile < receivers_.tiles.size(); ++tile) {
      if (looked_into[tile]) continue;
      const Eigen::Vector2d* box = &corner_points[8 * tile];
      if (std::all_of(box, box + 8, *inside)) continue;
      AddTile(receivers_.tiles[tile], &*inside);
      if (points_.size() > kMaxPending) {
        UpdateHull();
        inside.emplace(hull_);
      }
    }
    UpdateHull();
    return std::move(hull_);
  }

 private:
  Eigen::Vector2d Project(const Eigen::Vector4d& screen) const {
    return (frame_from_screen_ * screen).hnormalized();
  }

  void AddTile(const DepthTile& tile, const InsideTest* inside) {
    receivers_.ForEachReceiver(tile, [&](int x, int y, double d) {
      const Eigen::Vector2d point = Project({x + 0.5, y + 0.5, d, 1.0});
      if (inside == nullptr || !(*inside)(point)) points_.push_back(point);
    });
  }

  void UpdateHull() {
    points_.insert(points_.end(), hull_.begin(), hull_.end());
    hull_ = ConvexHull(std::move(points_));
    points_.clear();
  }

  const Receivers& receivers_;
  const Matrix34d frame_from_screen_;
  std::vector<Eigen::Vector2d> points_;
  Polygon hull_;
};

// The corners of the tile's box of pixel centres and affine depths.
void AppendCorners(const DepthTile& tile, std::vector<Eigen::Vector4d>* corners) {
  for (const double d : {tile.d_min, tile.d_max}) {
    for (const double y : {tile.y_begin + 0.5, tile.y_end - 0.5}) {
      for (const double x : {tile.x_begin + 0.5, tile.x_end - 0.5}) {
        corners->emplace_back(x, y, d, 1.0);
      }
    }
  }
}

// A tile for every receiver: the way out when the boxes are too coarse to tell whether the light is
// among the receivers.
Receivers WithTilePerReceiver(const Receivers& receivers) {
  Receivers fine;
  fine.readback = receivers.readback;
  fine.world_from_screen = receivers.world_from_screen;
  for (const DepthTile& tile : receivers.tiles) {
    receivers.ForEachReceiver(tile, [&fine](int x, int y, double d) {
      fine.tiles.push_back({x, y, x + 1, y + 1, d, d, 1});
    });
  }
  return fine;
}

absl::StatusOr<RayCover> CoverTiles(const Receivers& receivers, const Light& light) {
  const Matrix34d ray_from_screen = RayFromWorld(light) * receivers.world_from_screen;
  std::vector<Eigen::Vector4d> corners;
  corners.reserve(8 * receivers.tiles.size());
  for (const DepthTile& tile : receivers.tiles) AppendCorners(tile, &corners);

  RayCover cover;
  Eigen::Matrix3d frame_from_ray = Eigen::Matrix3d::Identity();
  if (light.kind == Light::Kind::kPoint) {
    std::vector<Eigen::Vector3d> rays;
    rays.reserve(corners.size());
    for (const Eigen::Vector4d& corner : corners) rays.push_back(ray_from_screen * corner);
    const std::optional<Eigen::Vector3d> axis = FeasibleAxis(rays);
    if (!axis.has_value()) return SurroundedError(light);
    frame_from_ray = FrameAlong(*axis);
    cover.mean_ray.setZero();
    for (size_t tile = 0; tile < receivers.tiles.size(); ++tile) {
      // The mean of a box's two opposite corners stands for its receivers.
      const Eigen::Vector3d centre = ray_from_screen * (corners[8 * tile] + corners[8 * tile + 7]);
      cover.mean_ray += receivers.tiles[tile].num_receivers * centre.normalized();
    }
    cover.mean_ray.normalize();
  }

  const Matrix34d frame_from_screen = frame_from_ray * ray_from_screen;
  // Depth of a box is extreme at its corners: a linear function of the world point.
  const Eigen::RowVector4d depth_from_screen =
      light.kind == Light::Kind::kPoint
          ? Eigen::RowVector4d(frame_from_screen.row(2))
          : Eigen::RowVector4d(light.direction.normalized().transpose() *
                               receivers.world_from_screen.topRows<3>());
  const Eigen::RowVector4d scale_from_screen = receivers.world_from_screen.row(3);
  cover.depth = {std::numeric_limits<double>::infinity(),
                 -std::numeric_limits<double>::infinity()};
  for (const Eigen::Vector4d& corner : corners) {
    const double depth = depth_from_screen.dot(corner) / scale_from_screen.dot(corner);
    cover.depth.near = std::min(cover.depth.near, depth);
    cover.depth.far = std::max(cover.depth.far, depth);
  }

  cover.hull = HullBuilder(receivers, frame_from_screen).ExactHull(corners);
  const std::optional<Eigen::Matrix3d> normalized = NormalizeRays(frame_from_ray, &cover.hull);
  if (!normalized.has_value()) return FlatError(light);
  cover.normalized_from_ray = *normalized;
  return cover;
}

}  // namespace

absl::StatusOr<RayCover> CoverReceivers(const Receivers& receivers, const Light& light) {
  absl::StatusOr<RayCover> cover = CoverTiles(receivers, light);
  if (cover.ok() || light.kind == Light::Kind::kDirectional) return cover;
  return CoverTiles(WithTilePerReceiver(receivers), light);
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
