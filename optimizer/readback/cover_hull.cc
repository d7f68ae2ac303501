#include "optimizer/readback/cover_hull.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "base/scratch.h"
#include "base/stop.h"
#include "geometry/convex_hull.h"
#include "geometry/hull_interior.h"

namespace lightfit {

namespace {

class HullBuilder {
 public:
  HullBuilder(const CoveredSurfaces& covered, const Matrix34d& frame_from_screen)
      : covered_(covered), frame_from_screen_(frame_from_screen) {}

  Polygon Build() {
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

  // Looks into a tile unless its box is inside the hull. Also where HullInterior does not recognise
  // it.
  void Visit(size_t level, size_t index) {
    const TileGrid& grid = covered_.tiles.grids[level];
    const DepthTile& tile = grid.tiles[index];
    if (tile.num_surfaces == 0 || StopRequested()) return;
    const std::array<Eigen::Vector4d, 8> corners = Corners(tile);
    if (std::all_of(corners.begin(), corners.end(), [this](const Eigen::Vector4d& corner) {
          return (*inside_)(Project(corner));
        })) {
      return;
    }
    if (level == 0) {
      covered_.ForEach(tile, [this](const Eigen::Vector4d& screen) {
        const Eigen::Vector2d point = Project(screen);
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
  std::optional<HullInterior> inside_;  // of hull_
};

}  // namespace

Polygon ExactHull(const CoveredSurfaces& covered, const Matrix34d& frame_from_screen) {
  return HullBuilder(covered, frame_from_screen).Build();
}

Polygon HullOfSurroundings(const CoveredSurfaces& covered, const Matrix34d& frame_from_screen) {
  ScratchVector<Eigen::Vector2d> centres, corners;
  bool all_in_front = true;
  ForEachTile(covered.tiles.grids[0], [&](const DepthTile& tile) {
    covered.ForEach(tile, [&](const Eigen::Vector4d& centre) {
      centres.emplace_back(centre.head<2>());
      for (const double dx : {-1.0, 1.0}) {
        for (const double dy : {-1.0, 1.0}) {
          const Eigen::Vector3d ray =
              frame_from_screen * (centre + Eigen::Vector4d(dx, dy, 0.0, 0.0));
          all_in_front = all_in_front && ray.z() > 0.0;
          if (all_in_front) corners.emplace_back(ray.hnormalized());
        }
      }
    });
  });
  const bool is_row = Area(ConvexHull(centres)) == 0.0;  // exact: centres are halves
  return is_row && all_in_front ? ConvexHull(corners) : Polygon();
}

}  // namespace lightfit
