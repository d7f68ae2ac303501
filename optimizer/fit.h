// optimizer/fit.h : from a read-back to one light matrix, in one call.
//
// In:      Readback {camera, depth, shadow bits}, Light, MapSize, FitOptions.
// Out:     LightMatrix {map_from_world, energy, footprint statistics, trace}.
// Flow:    Readback -> Surfaces -> LightView {samples, cover} -> Summary {T, count, cone of rays}
//          -> axis + affine part -> LightMatrix.
// Symbols: X ray, D = d(screen)/d(ray), H map_from_ray, p = h3 axis, w = h3.X.  docs/mathematics.md
// Errors:  InvalidArgument: an input is wrong; the message names field, value and remedy.
//          FailedPrecondition: the input is fine but no single map exists, or there is nothing to
//          fit; the message names the light and what to do.
//          Cancelled: a StopScope said so; of several lights those done before it are there.
// Threads: functions share nothing; call them from as many threads as you like.
// Memory:  inside a ScratchScope all of it, results included, comes from there, and a pool that has
//          seen the like before allocates nothing. base/scratch.h
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "base/scratch.h"
#include "geometry/light.h"
#include "optimizer/energy/summary.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_matrix.h"
#include "optimizer/light_view.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

// Raised whenever a fit of the same input may come out otherwise, so that who keeps results knows
// which to compute anew.
inline constexpr int kFitRevision = 3;

// The matrix for one light.
absl::StatusOr<LightMatrix> FitLight(const Readback& readback,
                                     const Light& light,
                                     MapSize map,
                                     const FitOptions& options = {});

using LightMatrices = ScratchVector<absl::StatusOr<LightMatrix>>;

// The matrices for up to 32 lights of one read-back. What does not depend on the light is computed
// once. Element i belongs to lights[i] and has its own status; an error that concerns the whole
// read-back is returned for every light.
LightMatrices FitLights(const Readback& readback,
                        absl::Span<const Light> lights,
                        MapSize map,
                        const FitOptions& options = {});

// The shadow bits of those of the lights that can be used: what FindSurfaces() is to look at.
uint32_t LightMask(absl::Span<const Light> lights);

// The two halves of FitLight: everything the read-back has to say about this light, in about a
// kilobyte, and the fit from that alone. Summaries of one light add
// (optimizer/energy/summary_total.h). For the L1 metrics Summarize() weighs the samples by their
// footprints in the best map of this read-back, and Fit() keeps to those weights; its energies are
// then bounds, see Summary::footprint_sum. Statistics beyond the RMS are left at 0.
absl::StatusOr<Summary> Summarize(const Readback& readback,
                                  const Light& light,
                                  const FitOptions& options = {});
absl::StatusOr<LightMatrix> Fit(const Summary& summary,
                                const Light& light,
                                MapSize map,
                                const FitOptions& options = {});

// The same halves with one map for many frames in mind: for the L1 metrics the samples weigh what
// they do in `map_from_world` (texels, of any map size), the best of all frames so far, say.
// Summarised, added and fitted once more, energies become what the sum of footprints is, and their
// minimum the shot's own.   math.md 4. Samples with w <= 0 there are left out: what is lit may lie
// beyond the map. InvalidArgument when the matrix is not one of this light.
absl::StatusOr<Summary> SummarizeInMap(const Readback& readback,
                                       const Light& light,
                                       const Eigen::Matrix4d& map_from_world,
                                       const FitOptions& options = {});

// All of these once more for who asks several things of one read-back: of its surfaces, or of a
// light's view in them, made with the same options. Bit for bit the same, but that a view has one
// border, and BorderChoice::kAutomatic means that one.
LightMatrices FitLights(const Surfaces& surfaces,
                        absl::Span<const Light> lights,
                        MapSize map,
                        const FitOptions& options = {});
absl::StatusOr<LightMatrix> FitLight(const Surfaces& surfaces,
                                     const Light& light,
                                     MapSize map,
                                     const FitOptions& options = {});
absl::StatusOr<LightMatrix> FitLight(const LightView& view,
                                     MapSize map,
                                     const FitOptions& options = {});
absl::StatusOr<Summary> Summarize(const LightView& view, const FitOptions& options = {});
absl::StatusOr<Summary> SummarizeInMap(const LightView& view,
                                       const Eigen::Matrix4d& map_from_world,
                                       const FitOptions& options = {});

}  // namespace lightfit
