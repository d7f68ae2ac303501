#include "optimizer/figures/stability.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

#include "absl/strings/str_format.h"
#include "geometry/affine_depth.h"
#include "optimizer/figures/pixel_footprint.h"
#include "optimizer/readback/samples.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {
namespace {

// Points of a frame are at most about this many: the root mean square of as many is good to 1 %.
constexpr int64_t kMaxPoints = 1 << 14;

absl::Status Validate(const MappedFrame& frame, const char* name) {
  if (absl::Status status = ValidateReadback(frame.readback); !status.ok()) {
    return absl::InvalidArgumentError(absl::StrFormat("%s: %s", name, status.message()));
  }
  if (!frame.map_from_world.allFinite()) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s.map_from_world has values that are not finite, want a matrix to texels", name));
  }
  if (frame.map.width < 1 || frame.map.height < 1) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s.map = %dx%d, want at least 1x1 texels", name, frame.map.width, frame.map.height));
  }
  return absl::OkStatus();
}

// Which world points a read-back sees.
class Sight {
 public:
  Sight(const Readback& readback, const SampleOptions& options)
      : readback_(readback),
        options_(options),
        affine_depth_(AffineDepthOf(readback)),
        screen_from_world_(readback.camera.ScreenFromWorld()) {}

  bool Sees(const Eigen::Vector3d& position) const {
    constexpr double kDepthTolerance = 1e-3;  // coarse depth buffers, far away
    const Eigen::Vector4d screen = screen_from_world_ * position.homogeneous();
    if (!(screen.w() > 0.0)) return false;
    const Eigen::Vector3d at = screen.hnormalized();
    if (!(at.x() >= 0.0 && at.x() < readback_.width())) return false;
    if (!(at.y() >= 0.0 && at.y() < readback_.height())) return false;
    const int x = static_cast<int>(at.x()), y = static_cast<int>(at.y());
    DepthGradient gradient;
    if (!DepthGradientAt(readback_, affine_depth_, options_, x, y, &gradient)) return false;
    // Exact on a plane, however steep.
    const double expected =
        gradient.d + gradient.d_x * (at.x() - x - 0.5) + gradient.d_y * (at.y() - y - 0.5);
    const double tolerance = 0.5 * (std::abs(gradient.d_x) + std::abs(gradient.d_y)) +
                             kDepthTolerance * std::abs(gradient.d);
    return std::abs(at.z() - expected) <= tolerance;
  }

 private:
  const Readback& readback_;
  const SampleOptions& options_;
  AffineDepth affine_depth_;
  Eigen::Matrix4d screen_from_world_;
};

std::optional<Eigen::Vector2d> TexelOf(const MappedFrame& frame, const Eigen::Vector3d& position) {
  const Eigen::Vector4d map = frame.map_from_world * position.homogeneous();
  if (!(map.w() > 0.0)) return std::nullopt;
  const Eigen::Vector2d texel = map.head<2>() / map.w();
  const bool is_inside = texel.x() >= 0.0 && texel.x() < frame.map.width && texel.y() >= 0.0 &&
                         texel.y() < frame.map.height;
  return is_inside ? std::optional<Eigen::Vector2d>(texel) : std::nullopt;
}

// Surfaces of the earlier frame. Returns whether any is seen in the later, inside the maps or not.
bool MeasurePoints(const Readback& readback,
                   const Sight& sight_after,
                   const CrawlOf& of,
                   Crawl* crawl) {
  const AffineDepth affine_depth = AffineDepthOf(readback);
  const Eigen::Matrix4d world_from_screen = readback.camera.WorldFromScreen();
  const double num_pixels = static_cast<double>(readback.width()) * readback.height();
  const int step = static_cast<int>(std::ceil(std::sqrt(num_pixels / kMaxPoints)));
  bool any_seen = false;
  int64_t num_moved = 0;
  double sum = 0.0;
  for (int y = step / 2; y < readback.height(); y += step) {
    for (int x = step / 2; x < readback.width(); x += step) {
      const float depth = readback.depth[readback.Index(x, y)];
      if (!affine_depth.IsSurface(depth)) continue;
      const Eigen::Vector4d screen(x + 0.5, y + 0.5, affine_depth.At(x, y, depth), 1.0);
      const Eigen::Vector3d position = (world_from_screen * screen).hnormalized();
      if (!sight_after.Sees(position)) continue;
      any_seen = true;
      const std::optional<PointDrift> drift = of.drift_at(position);
      if (!drift.has_value()) continue;
      ++crawl->num_points;
      sum += drift->texels.squaredNorm();
      if (drift->is_redrawn || drift->texels.norm() > kPhaseTolerance) ++num_moved;
    }
  }
  if (crawl->num_points > 0) {
    const auto num_points = static_cast<double>(crawl->num_points);
    crawl->phase_drift_texels = std::sqrt(sum / num_points);
    crawl->moved_share = static_cast<double>(num_moved) / num_points;
  }
  return any_seen;
}

// Samples near the shadow's edge in the later frame.
void MeasureEdge(const Surfaces& surfaces,
                 const Light& light,
                 const Sight& sight_before,
                 const CrawlOf& of,
                 const SampleOptions& options,
                 Crawl* crawl) {
  const Samples samples = SelectSamples(
      surfaces, light, options, Eigen::Matrix3d::Identity(), /*with_edge_normals=*/true);
  const size_t step = (samples.size() + kMaxPoints - 1) / kMaxPoints;
  double sum = 0.0;
  for (size_t i = 0; i < samples.size(); i += step) {
    const Eigen::Vector4d screen(samples.x[i], samples.y[i], samples.d[i], 1.0);
    const Eigen::Vector3d position = (surfaces.world_from_screen * screen).hnormalized();
    if (!sight_before.Sees(position)) continue;
    const std::optional<PointDrift> drift = of.drift_at(position);
    if (!drift.has_value()) continue;
    const std::optional<Eigen::Matrix2d> J_screen_map = of.J_screen_map_at(
        static_cast<int>(samples.x[i]), static_cast<int>(samples.y[i]), position);
    if (!J_screen_map.has_value()) continue;
    const Eigen::Vector2d on_screen = *J_screen_map * drift->texels;
    const Eigen::Vector2d normal(samples.edge_normal_x[i], samples.edge_normal_y[i]);
    const double across = normal.isZero() ? on_screen.norm() : normal.dot(on_screen);
    ++crawl->num_edge_points;
    sum += across * across;
  }
  if (crawl->num_edge_points > 0) {
    crawl->edge_crawl_px = std::sqrt(sum / static_cast<double>(crawl->num_edge_points));
  }
}

}  // namespace

Eigen::Vector2d PhaseChange(const Eigen::Vector2d& texel_before,
                            const Eigen::Vector2d& texel_after) {
  const Eigen::Vector2d change = texel_after - texel_before;
  return {change.x() - std::round(change.x()), change.y() - std::round(change.y())};
}

absl::StatusOr<Crawl> MeasureCrawl(const Readback& before,
                                   const Readback& after,
                                   const Surfaces* surfaces_after,
                                   const Light& light,
                                   const CrawlOf& of,
                                   const SampleOptions& options) {
  Crawl crawl;
  const Sight sight_before(before, options), sight_after(after, options);
  if (!MeasurePoints(before, sight_after, of, &crawl)) return crawl;
  if (surfaces_after != nullptr) {
    MeasureEdge(*surfaces_after, light, sight_before, of, options, &crawl);
    return crawl;
  }
  const absl::StatusOr<Surfaces> found =
      FindSurfaces(after, uint32_t{1} << light.shadow_bit, options);
  if (!found.ok()) return found.status();
  MeasureEdge(*found, light, sight_before, of, options, &crawl);
  return crawl;
}

absl::StatusOr<Crawl> MeasureCrawl(const MappedFrame& before,
                                   const MappedFrame& after,
                                   const Light& light,
                                   const SampleOptions& options) {
  if (absl::Status status = ValidateSampleOptions(options); !status.ok()) return status;
  if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  if (absl::Status status = Validate(before, "before"); !status.ok()) return status;
  if (absl::Status status = Validate(after, "after"); !status.ok()) return status;
  const absl::StatusOr<PixelFootprints> footprints =
      PixelFootprints::Create(after.readback, light, after.map_from_world, options);
  if (!footprints.ok()) return footprints.status();
  // One and the same point in both maps, so that what its depth was rounded by does not count.
  const auto drift_at = [&](const Eigen::Vector3d& world) -> std::optional<PointDrift> {
    const std::optional<Eigen::Vector2d> from = TexelOf(before, world);
    const std::optional<Eigen::Vector2d> to = TexelOf(after, world);
    if (!from.has_value() || !to.has_value()) return std::nullopt;
    return PointDrift{PhaseChange(*from, *to)};
  };
  const auto J_screen_map_at =
      [&](int x, int y, const Eigen::Vector3d&) -> std::optional<Eigen::Matrix2d> {
    const std::optional<PixelFootprint> pixel = footprints->At(x, y);
    if (!pixel.has_value() || pixel->is_behind) return std::nullopt;
    return pixel->J_screen_map;
  };
  return MeasureCrawl(
      before.readback, after.readback, after.surfaces, light, {drift_at, J_screen_map_at}, options);
}

}  // namespace lightfit
