// render/seams.h
//
// What is seen of the borders between a plan's maps: how much texels differ on their two sides.
// In:   what the camera sees, the true lighting, a light and its Plan.
// Out:  the seams, pairs of neighbouring pixels that ask different maps, and statistics of them.
//
// Where the denser of two maps is asked the area of a texel is continuous, as both have the same q
// on the border; shape and direction are not, and so the footprint and the extent across a shadow's
// edge may jump. Where a map's rectangle or half spaces end anything may.   math.md 10, 11
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/light.h"
#include "partition/plan.h"
#include "render/surface_image.h"
#include "render/true_lighting.h"

namespace lightfit {

// The border between two maps runs between two pixels on one surface. Ratios are those of the
// neighbour's map to the pixel's own, of texels on the screen at the same place: the geometric mean
// of the ratio at the one pixel and at the other.
struct Seam {
  int32_t pixel = 0, neighbour = 0;  // row-major; the neighbour is to the right or below
  int map = 0, neighbour_map = 0;

  bool is_by_density = false;  // both maps may be asked about both pixels: the denser one is
  bool is_at_edge = false;     // next to an edge of the true shadow, whose direction is known

  double footprint = 1.0;  // sqrt((|dS/du|^2 + |dS/dv|^2) / 2), as in FootprintStatistics
  double area = 1.0;       // |det dS/d(u, v)|
  double across = 1.0;     // |(n.dS/du, n.dS/dv)|, n the edge's normal; 1 where not at an edge
};

// Both pixels are judged, ask a map, and lie on a surface that continues to all four sides of
// either (SampleOptions::max_depth_bend), not edge-on to the light. In the order of the pixels.
// InvalidArgument for a truth of another image, and for a plan that PlanLookUp refuses.
absl::StatusOr<std::vector<Seam>> FindSeams(const SurfaceImage& image,
                                            absl::Span<const Lighting> truth,
                                            const Light& light,
                                            const Plan& plan);

// Of ratios turned to be 1 or more; 1 of none.
struct SeamJump {
  double mean = 1.0;  // geometric
  double p99 = 1.0;   // 99 % are no larger
};

struct SeamJumps {
  int64_t seams = 0;
  int64_t at_edges = 0;  // of them
  SeamJump footprint;
  SeamJump area;
  SeamJump across;  // of those at edges
};

struct SeamStatistics {
  SeamJumps all;
  SeamJumps by_density;
};

SeamStatistics StatisticsOf(absl::Span<const Seam> seams);

}  // namespace lightfit
