#include "optimizer/readback/covered_surfaces.h"

#include <algorithm>
#include <limits>

namespace lightfit {

namespace {

// Of axis.X / |X| over a tile's box. A sum of rays is no longer than their lengths together, so
// that none is lower than the lowest corner, if that is in front.
double LowerBound(const DepthTile& tile,
                  const Matrix34d& ray_from_screen,
                  const Eigen::Vector3d& axis) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector4d& corner : Corners(tile)) {
    lowest = std::min(lowest, axis.dot((ray_from_screen * corner).normalized()));
  }
  return lowest >= 0.0 ? lowest : -std::numeric_limits<double>::infinity();
}

}  // namespace

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

ScratchVector<Eigen::Vector4d> OneReceiverPerTile(const CoveredSurfaces& covered, size_t grid) {
  const Readback& readback = covered.surfaces.readback;
  const auto first_receiver = [&](const DepthTile& tile) -> Eigen::Vector4d {
    for (int y = tile.y_begin; y < tile.y_end; ++y) {
      for (int x = tile.x_begin; x < tile.x_end; ++x) {
        const size_t pixel = readback.Index(x, y);
        if (!covered.tiles.filter.Has(pixel)) continue;
        const double depth = readback.depth[pixel];
        if (!covered.surfaces.affine_depth.IsSurface(depth)) continue;
        return {x + 0.5, y + 0.5, covered.surfaces.affine_depth.At(x, y, depth), 1.0};
      }
    }
    return Eigen::Vector4d::Zero();  // not reached: the tile has a receiver
  };
  ScratchVector<Eigen::Vector4d> found;
  ForEachTile(covered.tiles.grids[grid],
              [&](const DepthTile& tile) { found.push_back(first_receiver(tile)); });
  return found;
}

UnitRaySum SumOfUnitRays(const CoveredSurfaces& covered, const Matrix34d& ray_from_screen) {
  UnitRaySum sum;
  ForEachTile(covered.tiles.grids[0], [&](const DepthTile& tile) {
    covered.ForEach(tile, [&](const Eigen::Vector4d& screen) {
      sum.Add((ray_from_screen * screen).normalized());
    });
  });
  return sum;
}

Eigen::Vector3d LowestOfUnitRays(const CoveredSurfaces& covered,
                                 const Matrix34d& ray_from_screen,
                                 const Eigen::Vector3d& axis) {
  Eigen::Vector3d lowest = Eigen::Vector3d::Zero();
  double lowest_height = std::numeric_limits<double>::infinity();
  ForEachTile(covered.tiles.grids[0], [&](const DepthTile& tile) {
    if (LowerBound(tile, ray_from_screen, axis) >= lowest_height) return;
    covered.ForEach(tile, [&](const Eigen::Vector4d& screen) {
      const Eigen::Vector3d ray = (ray_from_screen * screen).normalized();
      const double height = axis.dot(ray);
      if (height < lowest_height) {
        lowest_height = height;
        lowest = ray;
      }
    });
  });
  return lowest;
}

}  // namespace lightfit
