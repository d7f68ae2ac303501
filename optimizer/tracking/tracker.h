// optimizer/tracking/tracker.h
//
// From frame to frame: keep each light's matrix, move it, or replace it.
// In:   per frame a read-back (or its Surfaces) and the lights.
// Out:  per light the matrix for this frame, and what was done to it.   math.md 7
//
// A matrix that changes makes shadow edges crawl: texels move over surfaces that stand still. A
// matrix that is kept grows loose, and in the end misses what it must cover. Between the two there
// is one move that costs nothing: by whole texels, which leaves every texel on its surface.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "base/scratch.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_matrix.h"
#include "optimizer/readback/readback.h"
#include "optimizer/readback/surfaces.h"
#include "optimizer/tracking/keep_matrix.h"

namespace lightfit {

struct TrackerOptions {
  FitOptions fit;

  // What a light keeps when it keeps: the matrix itself, or its axis alone, with the affine part
  // fitted anew to the rays of every updated frame (as published; the map then crawls).
  enum class Keeps { kMatrix, kAxis };
  Keeps keeps = Keeps::kMatrix;

  // A matrix is replaced when the median of the squared footprints falls below this share of what
  // it is with what is kept. 0: never for that reason, 1 and above: in every updated frame. >= 0.
  double replace_below = 0.5;

  // Every n-th frame is looked at for that. The frames between are checked for validity alone.
  // >= 1.
  int update_every_frames = 3;

  // A replaced matrix makes room for what comes into view: on every side by this share of what must
  // be covered, in percent, on top of fit.margin_percent. >= 0.
  double cover_margin_percent = 5.0;

  // Whether a receiver that must be covered and is not makes the matrix move, or be replaced, in
  // the same frame. Without it such receivers wait for the next updated frame, lit.
  bool hard_validity = true;

  // All of the above but `fit` from one number, 0 ... 1:   docs/sequences.md has the price of each
  //   0    every frame has the tightest map, and crawls
  //   1    a matrix stays as long as it is valid
  static TrackerOptions ForStability(double stability);

  // Chong & Gortler: every third frame, axis kept unless the median falls below 80 %.
  static TrackerOptions AsPublished();
};

absl::Status ValidateTrackerOptions(const TrackerOptions& options);

struct TrackedMatrix {
  LightMatrix matrix;  // its figures are those of this frame's samples
  TrackerAction action = TrackerAction::kFirst;
  int64_t frames_kept = 0;  // since texels last moved over surfaces, 0: in this frame
};

// Element i belongs to light i. A ScratchVector, as LightMatrices.
using TrackedMatrices = ScratchVector<absl::StatusOr<TrackedMatrix>>;

// One sequence of frames. A light is known by its name; those that are not in a frame are
// forgotten. Not for use by two threads at once. Inside a ScratchScope the results and all working
// memory come from there; what a tracker remembers does not.
class Tracker {
 public:
  explicit Tracker(const TrackerOptions& options) : options_(options) {}

  const TrackerOptions& options() const { return options_; }
  // From the next frame on. What was fitted so far is kept as far as the new options allow.
  void set_options(const TrackerOptions& options) { options_ = options; }

  // Element i belongs to lights[i] and has its own status, as FitLights(). Where nothing can be
  // fitted (no shadow edge in view, say) but the matrix of the frame before is valid still, that is
  // the result.
  // CancelledError for every light whose inputs are right, and the tracker as it was before the
  // frame, once a StopScope says so.
  TrackedMatrices Update(const Readback& readback, absl::Span<const Light> lights, MapSize map);

  // The same where the read-back's surfaces are known, of all these lights.
  TrackedMatrices Update(const Surfaces& surfaces, absl::Span<const Light> lights, MapSize map);

  // To stop and go on in another process.
  const std::vector<TrackedState>& state() const { return states_; }
  void set_state(std::vector<TrackedState> states) { states_ = std::move(states); }

 private:
  // `surfaces` may be null, where `status` says why.
  TrackedMatrices Update(const Surfaces* surfaces,
                         const absl::Status& status,
                         absl::Span<const Light> lights,
                         MapSize map);
  // Whether the matrix is to be looked at in this frame, beyond its validity.
  bool IsUpdate(const TrackedState& state) const;

  // Of the map in this frame, as the options ask; kAutomatic: that of the frame before, and in
  // every updated frame the better one.
  Border BorderOf(const Surfaces& surfaces,
                  const Light& light,
                  MapSize map,
                  const TrackedState& state) const;
  absl::StatusOr<TrackedMatrix> UpdateLight(const Surfaces& surfaces,
                                            const Light& light,
                                            MapSize map,
                                            TrackedState* state) const;

  TrackerOptions options_;
  std::vector<TrackedState> states_;
  std::vector<TrackedState> states_before_;  // of the frame under way, in case it is stopped
};

}  // namespace lightfit
