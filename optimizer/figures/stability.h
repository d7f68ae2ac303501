// optimizer/figures/stability.h
//
// How much a light's map crawls from one frame to the next, over surfaces that stand still.
// In:   two consecutive read-backs and the light's matrix in each.
// Out:  Crawl: how far points move within their texels, and what that is on the screen.
//
// The phase of a world point is where it lies in its texel: the fractional part of (u, v). Where
// the phase stays, the point looks up the same sample of the scene in both frames, whatever the
// whole texels do; where it moves, the shadow's edge may flicker there.   math.md (14)
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "absl/functional/function_ref.h"
#include "absl/status/statusor.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "optimizer/readback/readback.h"
#include "optimizer/readback/sample_options.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

// One frame of a sequence, and a light's map in it.
struct MappedFrame {
  Readback readback;
  Eigen::Matrix4d map_from_world;  // texels, as LightMatrix::map_from_world; row 3 does not matter
  MapSize map;

  // Of `readback`, where they have been found already; null: found when they are needed.
  const Surfaces* surfaces = nullptr;
};

struct Crawl {
  int64_t num_points = 0;  // surfaces seen in both frames and inside both maps

  // Root mean square over those of the phase's change, texels, the shorter way around: 0 where the
  // texels stand still, 0.41 (1 / sqrt 6) where they are drawn anew.
  double phase_drift_texels = 0.0;

  // Share of those whose phase changes by more than kPhaseTolerance.
  double moved_share = 0.0;

  // Over the samples near the shadow's edge in the later frame alone: root mean square of what
  // that change is on the screen, across the edge where its direction is known; read-back pixels.
  int64_t num_edge_points = 0;
  double edge_crawl_px = 0.0;
};

// The same of whatever is drawn for a light, several maps say.
struct PointDrift {
  Eigen::Vector2d texels;   // the change of phase, math.md (14)
  bool is_redrawn = false;  // has moved in any case: another map than before is asked
};
struct CrawlOf {
  // Of a world point from the one frame to the other; nothing where either frame has it in no map.
  absl::FunctionRef<std::optional<PointDrift>(const Eigen::Vector3d& world)> drift_at;
  // What a texel is on the screen at a pixel of the later frame, in the map that the point there
  // asks: pixels per texel; nothing where that is not known.
  absl::FunctionRef<std::optional<Eigen::Matrix2d>(int x, int y, const Eigen::Vector3d& world)>
      J_screen_map_at;
};

// Matrices in single precision round by less than this, texels; those in double by some 1e-12.
inline constexpr double kPhaseTolerance = 0.01;

// Points are pixels of the earlier frame, every n-th along x and y of a large one; edge points are
// samples of the later. Either must be seen in the other frame: its affine depth there differs from
// that of the surface around it by less than half a pixel's slope of it, and 0.1 %. What moved
// drops out by that, but for what slides along its own surface. Points with w <= 0 or outside
// either map are left out. Where nothing is left all is 0.
//
// InvalidArgument for inputs that cannot be used. That a matrix is one of this light is not asked:
// lights may move between frames.
absl::StatusOr<Crawl> MeasureCrawl(const MappedFrame& before,
                                   const MappedFrame& after,
                                   const Light& light,
                                   const SampleOptions& options = {});

// Of two read-backs that are valid. `surfaces_after` may be null.
absl::StatusOr<Crawl> MeasureCrawl(const Readback& before,
                                   const Readback& after,
                                   const Surfaces* surfaces_after,
                                   const Light& light,
                                   const CrawlOf& of,
                                   const SampleOptions& options);

// The shorter way around in both coordinates.   math.md (14)
Eigen::Vector2d PhaseChange(const Eigen::Vector2d& texel_before,
                            const Eigen::Vector2d& texel_after);

}  // namespace lightfit
