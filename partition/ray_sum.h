// partition/ray_sum.h
//
// What the maps of a light's plan must serve in several read-backs, and their plan.
// In:   ServedRays of each read-back.
// Out:  RaySum, which adds; one LightPlan for all of them.   docs/mathematics.md 11
//
// Every read-back has normalised rays of its own; a sum lives in light space, which all share. Of
// each no more samples are taken than are asked for, so that a sum of a thousand frames fits in
// memory: every so many of them, which then count for the others.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "geometry/border.h"
#include "geometry/homography.h"
#include "geometry/light.h"
#include "optimizer/light_matrix.h"
#include "optimizer/light_view.h"
#include "partition/fit_plan.h"
#include "partition/plan_options.h"
#include "partition/served_rays.h"

namespace lightfit {

struct RaySum {
  // A bin of one read-back: what lies between its rays is covered too.
  struct CoveredBin {
    std::vector<Eigen::Vector3d> hull;  // light space, RayFromWorld(light), of whatever length
    int num_covered = 0;                // pixels
    DepthRange distance;                // of these, from a point light
  };

  Light light;  // shadow_bit does not matter
  Border border = Border::kLit;
  FacingSource facing = FacingSource::kGiven;  // given in every read-back, or guessed in some
  int64_t num_frames = 0;

  std::vector<CoveredBin> covered;
  std::vector<RaySample> samples;  // in light space
  DepthRange distance = kNoDepth;  // of all receivers, as ServedRays::distance
};

// Of one read-back; at most so many samples.
RaySum SumOfRays(const ServedRays& rays, const LightView& view, int most_samples);

// InvalidArgument, and `sum` as it was, when light or border are others.
absl::Status AddToSum(const RaySum& other, RaySum* sum);

// All of it, in bins: about so many at most.
ServedRays RaysOfSum(const RaySum& sum, int max_bins = ServedRaysOptions().max_bins);

// The plan of `options.max_maps` maps for all of them, in the sum's border: nothing is foretold.
// Every receiver that was covered is within 0 ... 1 in whatever map it asks. Figures of a map are
// its energy and how many of the sum's boundary samples ask it; energies are of the samples that
// there are. Errors as FitPlan().
absl::StatusOr<LightPlan> FitRaySum(const RaySum& sum, const PlanOptions& options);

}  // namespace lightfit
