// optimizer/tracking/keep_matrix.h
//
// What can be kept of the matrix of the frame before.
// In:   a light's TrackedState, its samples and cover in this frame.
// Out:  Kept: the matrix itself, moved by whole texels, or laid anew along its axis.   math.md 7
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/scratch.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_matrix.h"
#include "optimizer/readback/cover.h"
#include "optimizer/search/axis_search.h"

namespace lightfit {

enum class TrackerAction {
  kFirst,     // there was no matrix of this light, or light, map size or options changed
  kKept,      // the matrix of the frame before, but perhaps for its depth range
  kShifted,   // ... by whole texels
  kRelaid,    // the axis of the frame before, the affine part anew (Keeps::kAxis)
  kReplaced,  // the fresh fit is better by enough, maybe with the other border
  kInvalid    // replaced because what must be covered was not
};

const char* TrackerActionName(TrackerAction action);

// What is remembered of one light, all there is to a tracker's state: write it down to go on later.
struct TrackedState {
  Light light;
  MapSize map;
  Border border = Border::kLit;
  Eigen::Matrix4d map_from_world = Eigen::Matrix4d::Identity();
  int64_t frames_kept = 0;
  int64_t frames_since_update = 0;
};

// Whether a matrix of the one can be kept for the other: names and shadow bits do not count.
bool IsSameLight(const Light& a, const Light& b);

// Of what trackers of matrices and of plans have in common; InvalidArgument names options.FIELD.
absl::Status ValidateUpdates(int update_every_frames, double cover_margin_percent);

// What is kept of the frame before, fitted into this one.
struct Kept {
  Eigen::Matrix4d map_from_world;
  TrackerAction action;
  bool is_valid;  // all that must be covered is in the map
};

// The corners of all that a map must have room for, none where nothing is shadowed: the hull's rays
// at the nearest and the farthest depth, as homogeneous world points. u, v, w and z of a map are
// extreme over the covered receivers at some of these.
ScratchVector<Eigen::Vector4d> CornersOfCover(const RayCover& cover, const Light& light);

// The whole number of texels to move an interval by, so that it lies in `first` ... `last`, in
// their middle where there is a choice; nothing where it does not fit.
std::optional<double> WholeTexelShift(double low, double high, double first, double last);

// The matrix itself, moved by whole texels if it must and can.
Kept KeepMatrix(const TrackedState& state, const ScratchVector<Eigen::Vector4d>& corners);

// The axis, with the affine part fitted to this frame's rays; not valid where the axis cannot be
// used. `map_from_ray` is the state's matrix as MapFromRay() gives it.
Kept KeepAxis(const TrackedState& state,
              const SearchInputs& inputs,
              const Eigen::Matrix3d& map_from_ray,
              const FitOptions& options);

// The figures of a kept matrix in this frame. Its texels stay, to the last bit; so does its depth
// row as long as all receivers lie in its range.
absl::StatusOr<LightMatrix> FiguresOfKept(const Kept& kept,
                                          const SearchInputs& inputs,
                                          const ScratchVector<Eigen::Vector4d>& corners,
                                          MapSize map,
                                          const FitOptions& options);

}  // namespace lightfit
