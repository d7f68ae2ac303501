// partition/shipped/clipmap_pages.h : virtual shadow map pages of a directional light.
//
// In:      what a read-back sees, a directional light, the texels that there is memory for.
// Out:     PagedMap: the pages that are asked for; its look-up, and the ray of a place.
// Symbols: level l has texels of 2^l world units in the light's plane; p size of a pixel there,
//          world units; b bias of the level.
//
// As engines ship them (Unreal 5's virtual shadow maps; Fernando et al. 2001, Lefohn et al. 2007):
// a virtual map of many levels, each a window around the camera and split into pages, of which only
// those have memory that a pixel asks. A receiver asks the level whose texel is about its pixel,
//   l = floor(log2 p + b + 1/2),   p = z / f at camera depth z, f focal length in pixels,
// or the next one whose window holds it. b is a resolution bias: the least, in steps of 1/8, at
// which the pages fit in the pool.   docs/published_plans.md
//
// It has more maps than a Plan may have, and its rule knows the camera, so it is no Plan.
//
// Edge cases: pages lie on a lattice that is fixed in the world, so they do not crawl. Between the
// pixels of a read-back others may ask for pages that none of it asked: they find the next coarser
// one that is there. Pages of all levels from the one on whose page holds all receivers are alike,
// so that is the last: four pages are always enough.
#pragma once

#include <Eigen/Core>
#include <compare>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "geometry/light.h"
#include "optimizer/readback/surfaces.h"
#include "partition/shipped/texel_ray.h"

namespace lightfit {

// Texels [128 column, 128 (column + 1)) times [128 row, ...) of a level, for pages of 128.
struct MapPage {
  int level = 0;
  int64_t column = 0, row = 0;

  friend auto operator<=>(const MapPage&, const MapPage&) = default;
};

struct PagePlace {
  int page = -1;  // in PagedMap::pages; -1: none holds the receiver
  Eigen::Vector2d texel = Eigen::Vector2d::Zero();  // in the page, 0 <= u, v < page_side
};

struct PagedMap {
  std::string light_name;
  int page_side = 128;         // texels
  std::vector<MapPage> pages;  // by level, column and row: the finest first

  // What the look-up needs. The sun's plane and its direction, world.
  Eigen::Matrix<double, 2, 4> plane_from_world = Eigen::Matrix<double, 2, 4>::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
  // log2 of a pixel's size: of (depth_from_world . (x, y, z, 1)) pixel_per_depth.
  Eigen::RowVector4d depth_from_world = Eigen::RowVector4d::UnitW();
  double pixel_per_depth = 1.0;
  Eigen::Vector2d eye = Eigen::Vector2d::Zero();  // in the plane: where windows are centred
  int pages_per_side = 128;                       // of a window
  double level_bias = 0.0;
  int last_level = 0;

  // The page that the receiver asks for, whether it is there or not.
  MapPage AskedBy(const Eigen::Vector3d& world) const;

  // The page asked for, or the next coarser one that is there.
  PagePlace At(const Eigen::Vector3d& world) const;

  // For a texel's centre (column + 1/2, row + 1/2).
  TexelRay RayAt(const PagePlace& place) const;

 private:
  // The page of a level, or of the next one whose window holds the point.
  MapPage PageAround(int level, const Eigen::Vector2d& at) const;
};

// Of all pages.
int64_t NumTexels(const PagedMap& map);

struct ClipmapOptions {
  int page_side = 128;       // texels, 8 ... 4096
  int pages_per_side = 128;  // of a level's window; even, 4 ... 65536

  // The bias is not less than this, although there may be memory: -4 is a texel of a sixteenth of
  // the read-back's pixel. -8 ... 0.
  int least_bias = -4;
};

// FailedPrecondition for a point light. InvalidArgument for a light or option out of range, and
// when there is memory for less than four pages; CancelledError once a StopScope says so.
absl::StatusOr<PagedMap> ClipmapPages(const Surfaces& surfaces,
                                      const Light& light,
                                      int64_t max_texels,
                                      const ClipmapOptions& options = {});

}  // namespace lightfit
