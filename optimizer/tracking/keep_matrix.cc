#include "optimizer/tracking/keep_matrix.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "absl/strings/str_format.h"
#include "geometry/homography.h"
#include "optimizer/fit_matrix.h"
#include "optimizer/search/axis_evaluator.h"

namespace lightfit {

namespace {

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

}  // namespace

bool IsSameLight(const Light& a, const Light& b) {
  return a.kind == b.kind && a.position == b.position && a.direction == b.direction;
}

absl::Status ValidateUpdates(int update_every_frames, double cover_margin_percent) {
  if (update_every_frames < 1) {
    return absl::InvalidArgumentError(
        absl::StrFormat("options.update_every_frames = %d, want at least 1", update_every_frames));
  }
  if (!(cover_margin_percent >= 0.0 && cover_margin_percent <= 1000.0)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "options.cover_margin_percent = %g, want 0 ... 1000", cover_margin_percent));
  }
  return absl::OkStatus();
}

std::optional<double> WholeTexelShift(double low, double high, double first, double last) {
  const double middle = 0.5 * (first + last) - 0.5 * (low + high);
  for (const double shift : {std::round(middle), std::floor(middle), std::ceil(middle)}) {
    if (low + shift >= first && high + shift <= last) return shift;
  }
  return std::nullopt;
}

ScratchVector<Eigen::Vector4d> CornersOfCover(const RayCover& cover, const Light& light) {
  const Eigen::Matrix3d ray_from_normalized = cover.normalized_from_ray.inverse();
  const bool is_point = light.kind == Light::Kind::kPoint;
  const Eigen::Matrix3d axes_from_world =
      is_point ? Eigen::Matrix3d(RayFromWorld(light).leftCols<3>()) : FrameAlong(light.direction);
  ScratchVector<Eigen::Vector4d> corners;
  if (cover.nothing_to_cover) return corners;
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
      WholeTexelShift(landing.texels.min().x(), landing.texels.max().x(), 0.0, state.map.width);
  const std::optional<double> v =
      WholeTexelShift(landing.texels.min().y(), landing.texels.max().y(), 0.0, state.map.height);
  if (!u.has_value() || !v.has_value()) return kept;
  kept.map_from_world.row(0) += *u * kept.map_from_world.row(3);
  kept.map_from_world.row(1) += *v * kept.map_from_world.row(3);
  kept.action = TrackerAction::kShifted;
  kept.is_valid = true;
  return kept;
}

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

absl::StatusOr<LightMatrix> FiguresOfKept(const Kept& kept,
                                          const SearchInputs& inputs,
                                          const ScratchVector<Eigen::Vector4d>& corners,
                                          MapSize map,
                                          const FitOptions& options) {
  if (inputs.summary.cover.nothing_to_cover) {
    LightMatrix unused;
    unused.light_name = inputs.light.name;
    unused.map = map;
    unused.map_from_world = kept.map_from_world;
    unused.figures.samples = inputs.summary.counts;
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

}  // namespace lightfit
