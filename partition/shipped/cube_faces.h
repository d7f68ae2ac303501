// partition/shipped/cube_faces.h : a cube map around a lamp, as a plan.
//
// In:      a point light; what a read-back sees, its samples; texels of all maps.
// Out:     a Plan of up to six equal squares of 90 degrees.
// Symbols: f axis of a face; u, v = side (1 + a.d / f.d) / 2, side (1 + b.d / f.d) / 2.
//
// A cube of S texels in all has (S / 24) / cos^3 texels per steradian at an angle from a face's
// axis. Engines draw only the faces that something asks (King & Newhall 2005); here the texels of
// the others are shared out. And as nothing says that a cube's axes are the world's, it can be
// turned: of sixty rotations to the least sum of footprints at the given samples.
// docs/published_plans.md
//
// Edge cases: faces are wider than 90 degrees by a billionth, so that rounding leaves no gap where
// two meet; a filter's guard (PlanLookUp) does.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/homography.h"
#include "geometry/light.h"
#include "optimizer/energy/metric.h"
#include "optimizer/readback/samples.h"
#include "optimizer/readback/surfaces.h"
#include "partition/plan.h"
#include "partition/shipped/direction_samples.h"

namespace lightfit {

// Rows: the cube's axes, orthonormal and right-handed. Face 2 i looks along row i, face 2 i + 1
// against it.
using CubeAxes = Eigen::Matrix3d;
inline constexpr int kNumFaces = 6;
inline constexpr uint32_t kAllFaces = (1u << kNumFaces) - 1;

// The face that looks along `offset` most: the first of equals.
int FaceOf(const CubeAxes& axes, const Eigen::Vector3d& offset);

// Those of 60 turned cubes, spread evenly over all turns; the first is the identity.
const std::vector<CubeAxes>& CubeRotations();

// The maps of the faces in `faces`, a bit for each. `depth`: range over the receivers of the
// greatest of their three distances along the axes, 0 < near. FailedPrecondition for a directional
// light. InvalidArgument for a light, axes, faces or depth out of range, and when the budget leaves
// no texel.
absl::StatusOr<Plan> PlanOfFaces(
    const Light& light, const CubeAxes& axes, uint32_t faces, DepthRange depth, int64_t max_texels);

struct CubeFacesOptions {
  // A face that looks at no receiver has no map.
  bool needed_faces_only = true;

  // The cube is turned to the least SumOfFootprints(); else its axes are the world's.
  bool turned = false;
  MetricWeights weights;  // of the footprints
};

// `samples`: in light space (SelectSamples() with the identity); looked at only when turned. A face
// is needed when the middle or a corner of a receiver's pixel lies on it (receiver_pixels.h). As
// PlanOfFaces(), and CancelledError once a StopScope says so.
absl::StatusOr<Plan> CubeFaces(const Surfaces& surfaces,
                               const Light& light,
                               const Samples& samples,
                               int64_t max_texels,
                               const CubeFacesOptions& options = {});

// Sum over samples of weight times footprint, for faces of one texel to a side; those of faces of n
// texels a side are 1 / n of it.
double SumOfFootprints(const CubeAxes& axes, absl::Span<const DirectionSample> samples);

}  // namespace lightfit
