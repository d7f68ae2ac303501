// optimizer/readback/samples.h
//
// The samples of one light: pixels near its shadow boundary, with all that the energy needs.
// In:   Surfaces, Light, the coordinates of the rays.
// Out:  Samples, a structure of arrays that the summary kernel reads, and single Samples {X, D}.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "base/scratch.h"
#include "geometry/light.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

// One sample in full: the reference form.   math.md (1) and (11)
struct Sample {
  Eigen::Vector3d X;              // ray, along the light's rays
  Eigen::Matrix<double, 2, 3> D;  // d(screen)/d(ray), pixels per unit of ray; D X = 0
  double weight;
  Eigen::Vector2d edge_normal;  // of the shadow's edge on the screen, unit, or 0 if not known
};

struct Samples {
  // X = ray_from_screen (x, y, d, 1), in whatever coordinates of rays the caller chose.
  Eigen::Matrix<double, 3, 4> ray_from_screen;

  // One entry per sample: screen position (pixel centres at +0.5), affine depth and derivatives.
  ScratchVector<double> x, y, d, d_x, d_y;
  ScratchVector<double> weight;
  ScratchVector<double> edge_normal_x, edge_normal_y;  // empty unless asked for

  SampleCounts counts;

  size_t size() const { return x.size(); }
  bool has_edge_normals() const { return !edge_normal_x.empty(); }
  Sample At(size_t i) const;

  // Appends entry i of `other`, which has edge normals if this has.
  void AppendFrom(const Samples& other, size_t i);
};

// The light's share of the boundary, as `options` want it: those that face the light, are not
// edge-on to it or to the eye. Which face it the depth's normals say; with kGiven the read-back
// does where it knows (facing_bits). `normalized_from_ray` acts on RayFromWorld(light); the
// identity keeps light space. Here and below: of no use once a StopScope says so.
Samples SelectSamples(const Surfaces& surfaces,
                      const Light& light,
                      const SampleOptions& options,
                      const Eigen::Matrix3d& normalized_from_ray,
                      bool with_edge_normals,
                      FacingSource facing = FacingSource::kGuessed);

// Those that a map with a dark border serves, in the order they had: within kSquaresServed times
// the square that its cover fills in normalised rays. Beyond, everything is dark to the map, and
// edges there must not draw it away from those that it can show. The others are counted.
inline constexpr double kSquaresServed = 1.15;
Samples SamplesServed(const Samples& samples);

// Those with w = p.X > 0, in the order they had. `counts` are as they were.
Samples SamplesInFront(const Samples& samples, const Eigen::RowVector3d& axis);

}  // namespace lightfit
