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
#include "optimizer/fit.h"
#include "optimizer/light_view.h"
#include "optimizer/search/axis_evaluator.h"
#include "optimizer/search/axis_search.h"

namespace lightfit {

namespace {

// The corners of all that a map must have room for, none where nothing is shadowed: the hull's rays
// at the nearest and the farthest depth, as homogeneous world points. u, v, w and z of a map are
// extreme over the covered receivers at some of these.
ScratchVector<Eigen::Vector4d> CornersOfCover(const RayCover& cover, const Light& light) {
  const Eigen::Matrix3d ray_from_normalized = cover.normalized_from_ray.inverse();
  const bool is_point = light.kind == Light::Kind::kPoint;
  const Eigen::Matrix3d axes_from_world =
      is_point ? Eigen::Matrix3d(RayFromWorld(light).leftCols<3>()) : FrameAlong(light.direction);
  ScratchVector<Eigen::Vector4d> corners;
  if (cover.nothing_shadowed) return corners;
  for (const Eigen::Vector2d& vertex : cover.hull) {
    const Eigen::Vector3d ray = ray_from_normalized * vertex.homogeneous();
    for (const double depth : {cover.depth.near, cover.depth.far}) {
      const Eigen::Vector3d point =
          is_point ? Eigen::Vector3d(light.position + axes_from_world.transpose() * (depth * ray))
                   : Eigen::Vector3d(axes_from_world.transpose() *
                                     Eigen::Vector3d(ray.x(), ray.y(), depth));
      corners.push_back(point.homogeneous());
    }
  }
  return corners;
}

// Where the corners land in a map.
struct Landing {
  Eigen::AlignedBox2d texels;  // u, v
  double z_min = std::numeric_limits<double>::infinity();
  double z_max = -std::numeric_limits<double>::infinity();
  bool in_front = true;  // all w > 0
};

Landing LandingOf(const ScratchVector<Eigen::Vector4d>& corners,
                  const Eigen::Matrix4d& map_from_world) {
  Landing landing;
  for (const Eigen::Vector4d& corner : corners) {
    const Eigen::Vector4d mapped = map_from_world * corner;
    if (!(mapped.w() > 0.0)) {
      landing.in_front = false;
      return landing;
    }
    const Eigen::Vector3d point = mapped.hnormalized();
    landing.texels.extend(point.head<2>().eval());
    landing.z_min = std::min(landing.z_min, point.z());
    landing.z_max = std::max(landing.z_max, point.z());
  }
  return landing;
}

// The whole number of texels to move an interval by, so that it lies in 0 ... size, in its middle
// where there is a choice; nothing where it does not fit.
std::optional<double> WholeTexelShift(double low, double high, double size) {
  const double middle = 0.5 * size - 0.5 * (low + high);
  for (const double shift : {std::round(middle), std::floor(middle), std::ceil(middle)}) {
    if (low + shift >= 0.0 && high + shift <= size) return shift;
  }
  return std::nullopt;
}

bool IsSameLight(const Light& a, const Light& b) {
  return a.kind == b.kind && a.position == b.position && a.direction == b.direction;
}

// What is kept of the frame before, fitted into this one.
struct Kept {
  Eigen::Matrix4d map_from_world;
  TrackerAction action;
  bool is_valid;  // all that must be covered is in the map
};

// The matrix itself, moved by whole texels if it must and can.
Kept KeepMatrix(const TrackedState& state, const ScratchVector<Eigen::Vector4d>& corners) {
  constexpr double kTolerance = 1e-6;  // texels: rounding
  Kept kept = {state.map_from_world, TrackerAction::kKept, false};
  const Landing landing = LandingOf(corners, kept.map_from_world);
  if (!landing.in_front) return kept;
  const Eigen::AlignedBox2d map(Eigen::Vector2d::Constant(-kTolerance),
                                Eigen::Vector2d(state.map.width + kTolerance,  //
                                                state.map.height + kTolerance));
  kept.is_valid = map.contains(landing.texels);
  if (kept.is_valid) return kept;
  const std::optional<double> u =
      WholeTexelShift(landing.texels.min().x(), landing.texels.max().x(), state.map.width);
  const std::optional<double> v =
      WholeTexelShift(landing.texels.min().y(), landing.texels.max().y(), state.map.height);
  if (!u.has_value() || !v.has_value()) return kept;
  kept.map_from_world.row(0) += *u * kept.map_from_world.row(3);
  kept.map_from_world.row(1) += *v * kept.map_from_world.row(3);
  kept.action = TrackerAction::kShifted;
  kept.is_valid = true;
  return kept;
}

// The axis, with the affine part fitted to this frame's rays; not valid where the axis cannot be
// used.
Kept KeepAxis(const TrackedState& state,
              const SearchInputs& inputs,
              const Eigen::Matrix3d& map_from_ray,
              const FitOptions& options) {
  Kept kept = {state.map_from_world, TrackerAction::kRelaid, false};
  const AffineProblem problem = MakeAffineProblem(inputs.summary, state.map, options);
  SummaryEvaluator evaluator(inputs.summary, problem, options.min_w);
  const Eigen::Matrix3d normalized_from_ray = inputs.summary.cover.normalized_from_ray;
  const Eigen::RowVector3d axis = map_from_ray.row(2) * normalized_from_ray.inverse();
  if (!(axis.z() > 0.0)) return kept;
  const std::optional<AffineFit> fit = evaluator.Evaluate(axis.transpose());
  if (!fit.has_value()) return kept;
  const absl::StatusOr<LightMatrix> matrix =
      MatrixOfMap(inputs, fit->map_from_ray, state.map, options);
  if (!matrix.ok()) return kept;
  kept.map_from_world = matrix->map_from_world;
  kept.is_valid = true;
  return kept;
}

// The figures of a kept matrix in this frame. Its texels stay, to the last bit; so does its depth
// row as long as all receivers lie in its range.
absl::StatusOr<LightMatrix> FiguresOf(const Kept& kept,
                                      const SearchInputs& inputs,
                                      const ScratchVector<Eigen::Vector4d>& corners,
                                      MapSize map,
                                      const FitOptions& options) {
  if (inputs.summary.cover.nothing_shadowed) {
    LightMatrix unused;
    unused.light_name = inputs.light.name;
    unused.map = map;
    unused.map_from_world = kept.map_from_world;
    unused.samples = inputs.summary.counts;
    return unused;
  }
  const absl::StatusOr<Eigen::Matrix3d> map_from_ray =
      MapFromRay(kept.map_from_world, inputs.light);
  if (!map_from_ray.ok()) return map_from_ray.status();
  absl::StatusOr<LightMatrix> matrix = MatrixOfMap(
      inputs, *map_from_ray * inputs.summary.cover.normalized_from_ray.inverse(), map, options);
  if (!matrix.ok()) return matrix.status();
  constexpr double kTolerance = 1e-9;  // of the range of depth: rounding
  const Landing landing = LandingOf(corners, kept.map_from_world);
  const bool depth_fits = landing.z_min >= -kTolerance && landing.z_max <= 1.0 + kTolerance;
  for (const int row : {0, 1, 3}) matrix->map_from_world.row(row) = kept.map_from_world.row(row);
  if (depth_fits) matrix->map_from_world.row(2) = kept.map_from_world.row(2);
  return matrix;
}

double MedianSquared(const LightMatrix& matrix) {
  return matrix.footprint.median * matrix.footprint.median;
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
  if (options.update_every_frames < 1) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "options.update_every_frames = %d, want at least 1", options.update_every_frames));
  }
  if (!(options.cover_margin_percent >= 0.0 && options.cover_margin_percent <= 1000.0)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "options.cover_margin_percent = %g, want 0 ... 1000", options.cover_margin_percent));
  }
  return absl::OkStatus();
}

const char* TrackerActionName(TrackerAction action) {
  switch (action) {
    case TrackerAction::kFirst:
      return "first";
    case TrackerAction::kKept:
      return "kept";
    case TrackerAction::kShifted:
      return "shifted";
    case TrackerAction::kRelaid:
      return "relaid";
    case TrackerAction::kReplaced:
      return "replaced";
    case TrackerAction::kInvalid:
      return "invalid";
  }
  return "unknown";
}

absl::StatusOr<TrackedMatrix> Tracker::UpdateLight(const Receivers& receivers,
                                                   const Light& light,
                                                   MapSize map,
                                                   TrackedState* state) const {
  // The median decides, so it is always computed.
  FitOptions options = options_.fit;
  options.compute_statistics = true;
  absl::StatusOr<PreparedLight> prepared = PrepareLight(receivers, light, options);
  if (!prepared.ok()) return prepared.status();
  const SearchInputs inputs = {light, prepared->summary, &prepared->samples, &receivers};
  FitOptions roomy = options;
  roomy.margin_percent += options_.cover_margin_percent;
  const auto replace = [&](LightMatrix fresh, TrackerAction action) {
    state->light = light;
    state->map = map;
    state->map_from_world = fresh.map_from_world;
    state->frames_kept = state->frames_since_update = 0;
    return TrackedMatrix{std::move(fresh), action, 0};
  };

  // A status with a message would allocate, and having nothing to keep is no error.
  std::optional<Eigen::Matrix3d> kept_map_from_ray;
  if (state->map.width == map.width && state->map.height == map.height &&
      IsSameLight(state->light, light)) {
    const absl::StatusOr<Eigen::Matrix3d> map_from_ray = MapFromRay(state->map_from_world, light);
    if (map_from_ray.ok()) kept_map_from_ray = *map_from_ray;
  }
  if (!kept_map_from_ray.has_value()) {
    absl::StatusOr<LightMatrix> first = FitInputs(inputs, map, roomy);
    if (!first.ok()) return first.status();
    return replace(*std::move(first), TrackerAction::kFirst);
  }

  const ScratchVector<Eigen::Vector4d> corners = CornersOfCover(prepared->summary.cover, light);
  const bool is_update = state->frames_since_update + 1 >= options_.update_every_frames;
  Kept kept = KeepMatrix(*state, corners);
  if (options_.keeps == TrackerOptions::Keeps::kAxis) {
    const bool stays = kept.is_valid && kept.action == TrackerAction::kKept && !is_update;
    if (!stays) kept = KeepAxis(*state, inputs, *kept_map_from_ray, roomy);
  }
  std::optional<LightMatrix> figures;
  if (kept.is_valid || (!options_.hard_validity && !is_update)) {
    absl::StatusOr<LightMatrix> matrix = FiguresOf(kept, inputs, corners, map, options);
    if (matrix.ok()) figures = *std::move(matrix);
  }
  if (is_update || !figures.has_value()) {
    absl::StatusOr<LightMatrix> fresh = FitInputs(inputs, map, roomy);
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
  TrackedMatrices results(lights.size());
  absl::Status status = ValidateTrackerOptions(options_);
  if (status.ok()) status = ValidateMapSize(map, options_.fit.margin_texels);
  uint32_t light_mask = 0;
  for (const Light& light : lights) {
    if (ValidateLight(light).ok()) light_mask |= uint32_t{1} << light.shadow_bit;
  }
  if (StopPossible()) states_before_ = states_;
  const absl::StatusOr<Receivers> receivers =
      status.ok() ? FindReceivers(readback, light_mask, options_.fit.samples) : status;
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
    if (!receivers.ok()) {
      results[i] = receivers.status();
    } else if (absl::Status light_status = ValidateLight(light); !light_status.ok()) {
      results[i] = std::move(light_status);
    } else {
      results[i] = UpdateLight(*receivers, light, map, &states_[i]);
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
