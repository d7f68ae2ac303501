// optimizer/energy/summary_total.h
//
// Summaries of one light, added exactly: over tiles, frames and machines, in any order and
// grouping, to the last bit.
// In:   Summary and Light, as often as there are frames.
// Out:  SummaryTotal, one or two kilobytes; and from it the Summary of all the samples together.
//
// Every frame has normalised rays of its own. A total lives in light space, which all frames share;
// what precision that costs with distant lights (docs/design.md) is made up for by two or
// three doubles for each sum, added without rounding.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "base/exact_sum.h"
#include "geometry/light.h"
#include "optimizer/energy/summary.h"

namespace lightfit {

struct SummaryTotal {
  Light light;  // shadow_bit does not matter
  MetricWeights metric;
  Border border = Border::kLit;                  // that the covers are for
  FacingSource facing = FacingSource::kGuessed;  // given in every frame, or guessed in some
  bool is_l1 = false;  // the samples weigh one over their footprints; false without samples
  int64_t num_frames = 0;

  // In light space, RayFromWorld(light): the entries of EnergyTensor, row by row.
  std::array<ExactSum, 36> tensor;
  ExactSum total_weight, footprint_sum;  // as in Summary
  SampleCounts counts;

  // ExtremeRays() of all frames' hulls; light space, unit for a point light, third component 1 for
  // a directional one. Empty, and `surrounded`, when no single map covers the rays of all frames;
  // frames in which nothing is shadowed (RayCover::nothing_to_cover) have no part in it.
  std::vector<Eigen::Vector3d> hull;
  bool surrounded = false;

  std::array<ExactSum, 3> mean_ray;  // sum of the frames' RayCover::mean_ray

  // World units. Point light: distances from it. Directional: depths along its direction. Of the
  // frames that have a part in the hull.
  DepthRange depth = {std::numeric_limits<double>::infinity(),
                      -std::numeric_limits<double>::infinity()};
};

// A frame's summary as a total of one.
SummaryTotal TotalOf(const Summary& summary, const Light& light);

// InvalidArgument, and `total` as it was, when light, metric or border are others. Equal totals
// come out of equal frames however they are grouped.
absl::Status AddToTotal(const SummaryTotal& other, SummaryTotal* total);

// What Fit() takes: sums, hull and depths of all frames. For a point light the range of depth is
// wider than a single frame's own, as distances stand for depths along the axis.
// FailedPrecondition when no single map covers the rays of all frames.
absl::StatusOr<Summary> SummaryOfTotal(const SummaryTotal& total);

// All of it: the summary of the samples of all summaries together, for one light. InvalidArgument
// when there is none, or their metrics differ.
absl::StatusOr<Summary> MergeSummaries(absl::Span<const Summary> summaries, const Light& light);

}  // namespace lightfit
