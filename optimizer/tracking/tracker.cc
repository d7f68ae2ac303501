#include "optimizer/tracking/tracker.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "absl/strings/str_format.h"
#include "base/stop.h"
#include "geometry/homography.h"
#include "geometry/map_size.h"
#include "optimizer/choose_fit.h"
#include "optimizer/fit.h"
#include "optimizer/fit_matrix.h"
#include "optimizer/light_view.h"
#include "optimizer/search/axis_evaluator.h"
#include "optimizer/search/axis_search.h"

namespace lightfit {

namespace {

double MedianSquared(const LightMatrix& matrix) {
  return matrix.figures.footprint.median * matrix.figures.footprint.median;
}

}  // namespace

TrackerOptions TrackerOptions::ForStability(double stability) {
  TrackerOptions options;
  options.replace_below = 1.0 - stability;
  options.update_every_frames = stability > 0.0 ? 3 : 1;
  options.cover_margin_percent = 20.0 * stability * stability;
  return options;
}

TrackerOptions TrackerOptions::AsPublished() {
  TrackerOptions options;
  options.fit = FitOptions::AsPublished();
  options.keeps = Keeps::kAxis;
  options.replace_below = 0.8;
  options.update_every_frames = 3;
  options.cover_margin_percent = 0.0;
  return options;
}

absl::Status ValidateTrackerOptions(const TrackerOptions& options) {
  if (absl::Status status = ValidateFitOptions(options.fit); !status.ok()) return status;
  if (!(options.replace_below >= 0.0)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("options.replace_below = %g, want at least 0", options.replace_below));
  }
  return ValidateUpdates(options.update_every_frames, options.cover_margin_percent);
}

bool Tracker::IsUpdate(const TrackedState& state) const {
  return state.frames_since_update + 1 >= options_.update_every_frames;
}

Border Tracker::BorderOf(const Surfaces& surfaces,
                         const Light& light,
                         MapSize map,
                         const TrackedState& state) const {
  if (options_.fit.border != BorderChoice::kAutomatic) {
    return options_.fit.border == BorderChoice::kDark ? Border::kDark : Border::kLit;
  }
  const bool is_first = state.map.width == 0;
  if (!is_first && !IsUpdate(state)) return state.border;
  FitOptions roomy = options_.fit;
  roomy.margin_percent += options_.cover_margin_percent;
  return BorderByForecast(surfaces, light, map, roomy, state.border);
}

absl::StatusOr<TrackedMatrix> Tracker::UpdateLight(const Surfaces& surfaces,
                                                   const Light& light,
                                                   MapSize map,
                                                   TrackedState* state) const {
  // The median decides, so it is always computed.
  FitOptions options = options_.fit;
  options.compute_statistics = true;
  const Border border = BorderOf(surfaces, light, map, *state);
  const absl::StatusOr<LightView> view = ViewLight(surfaces, light, border, options);
  if (!view.ok()) return view.status();
  if (!view->cover.ok()) return view->cover.status();
  const Summary summary = SummaryOfView(*view, options);
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  const SearchInputs inputs = {light, summary, &view->samples, &surfaces};
  FitOptions roomy = options;
  roomy.margin_percent += options_.cover_margin_percent;
  const auto replace = [&](LightMatrix fresh, TrackerAction action) {
    state->light = light;
    state->map = map;
    state->border = border;
    state->map_from_world = fresh.map_from_world;
    state->frames_kept = state->frames_since_update = 0;
    return TrackedMatrix{std::move(fresh), action, 0};
  };

  // A status with a message would allocate, and having nothing to keep is no error.
  std::optional<Eigen::Matrix3d> kept_map_from_ray;
  const bool is_flip = state->map.width > 0 && state->border != border;
  if (!is_flip && state->map.width == map.width && state->map.height == map.height &&
      IsSameLight(state->light, light)) {
    const absl::StatusOr<Eigen::Matrix3d> map_from_ray = MapFromRay(state->map_from_world, light);
    if (map_from_ray.ok()) kept_map_from_ray = *map_from_ray;
  }
  if (!kept_map_from_ray.has_value()) {
    absl::StatusOr<LightMatrix> first = FitMatrix(inputs, map, roomy);
    if (!first.ok()) return first.status();
    return replace(*std::move(first), is_flip ? TrackerAction::kReplaced : TrackerAction::kFirst);
  }

  const ScratchVector<Eigen::Vector4d> corners = CornersOfCover(*view->cover, light);
  const bool is_update = IsUpdate(*state);
  Kept kept = KeepMatrix(*state, corners);
  if (options_.keeps == TrackerOptions::Keeps::kAxis) {
    const bool stays = kept.is_valid && kept.action == TrackerAction::kKept && !is_update;
    if (!stays) kept = KeepAxis(*state, inputs, *kept_map_from_ray, roomy);
  }
  std::optional<LightMatrix> figures;
  if (kept.is_valid || (!options_.hard_validity && !is_update)) {
    absl::StatusOr<LightMatrix> matrix = FiguresOfKept(kept, inputs, corners, map, options);
    if (matrix.ok()) figures = *std::move(matrix);
  }
  if (is_update || !figures.has_value()) {
    absl::StatusOr<LightMatrix> fresh = FitMatrix(inputs, map, roomy);
    if (!figures.has_value()) {
      if (!fresh.ok()) return fresh.status();
      return replace(*std::move(fresh), TrackerAction::kInvalid);
    }
    const bool is_better =
        fresh.ok() && (options_.replace_below >= 1.0 ||
                       MedianSquared(*fresh) < options_.replace_below * MedianSquared(*figures));
    if (is_better) return replace(*std::move(fresh), TrackerAction::kReplaced);
  }
  const bool crawls = kept.action == TrackerAction::kRelaid;
  state->map_from_world = figures->map_from_world;
  state->frames_kept = crawls ? 0 : state->frames_kept + 1;
  state->frames_since_update = is_update ? 0 : state->frames_since_update + 1;
  return TrackedMatrix{*std::move(figures), kept.action, state->frames_kept};
}

TrackedMatrices Tracker::Update(const Readback& readback,
                                absl::Span<const Light> lights,
                                MapSize map) {
  absl::Status status = ValidateTrackerOptions(options_);
  if (status.ok()) status = ValidateMapSize(map, options_.fit.margin_texels);
  const absl::StatusOr<Surfaces> surfaces =
      status.ok() ? FindSurfaces(readback, LightMask(lights), options_.fit.samples) : status;
  return Update(surfaces.ok() ? &*surfaces : nullptr, surfaces.status(), lights, map);
}

TrackedMatrices Tracker::Update(const Surfaces& surfaces,
                                absl::Span<const Light> lights,
                                MapSize map) {
  absl::Status status = ValidateTrackerOptions(options_);
  if (status.ok()) status = ValidateMapSize(map, options_.fit.margin_texels);
  return Update(status.ok() ? &surfaces : nullptr, status, lights, map);
}

TrackedMatrices Tracker::Update(const Surfaces* surfaces,
                                const absl::Status& status,
                                absl::Span<const Light> lights,
                                MapSize map) {
  TrackedMatrices results(lights.size());
  if (StopPossible()) states_before_ = states_;
  for (size_t i = 0; i < lights.size(); ++i) {
    const Light& light = lights[i];
    // States stand in the order of the lights, so that those of one frame are mostly in place.
    const auto known = std::find_if(
        states_.begin() + std::min(i, states_.size()), states_.end(), [&](const TrackedState& s) {
          return s.light.name == light.name;
        });
    if (known == states_.end()) {
      states_.insert(states_.begin() + i, TrackedState());
      states_[i].light = light;
    } else {
      std::swap(states_[i], *known);
    }
    if (surfaces == nullptr) {
      results[i] = status;
    } else if (absl::Status light_status = ValidateLight(light); !light_status.ok()) {
      results[i] = std::move(light_status);
    } else {
      results[i] = UpdateLight(*surfaces, light, map, &states_[i]);
    }
  }
  states_.resize(lights.size());
  if (StopRequested()) {
    states_.swap(states_before_);
    for (size_t i = 0; i < lights.size(); ++i) {
      // What cannot be used is said whether or not there was time to use it.
      if (!absl::IsInvalidArgument(results[i].status())) results[i] = CheckStop(lights[i]);
    }
  }
  return results;
}

}  // namespace lightfit
