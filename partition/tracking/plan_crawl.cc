#include "partition/tracking/plan_crawl.h"

#include <Eigen/Core>
#include <optional>
#include <utility>

#include "absl/strings/str_format.h"
#include "base/scratch.h"
#include "optimizer/figures/pixel_footprint.h"

namespace lightfit {

namespace {

absl::StatusOr<PlanLookUp> LookUpOf(const PlannedFrame& frame,
                                    const char* name,
                                    const Light& light,
                                    double guard_texels) {
  absl::Status status = ValidateReadback(frame.readback);
  if (status.ok()) {
    absl::StatusOr<PlanLookUp> look_up = PlanLookUp::Create(frame.plan, light, guard_texels);
    if (look_up.ok()) return look_up;
    status = look_up.status();
  }
  return absl::InvalidArgumentError(absl::StrFormat("%s: %s", name, status.message()));
}

}  // namespace

absl::StatusOr<Crawl> MeasurePlanCrawl(const PlannedFrame& before,
                                       const PlannedFrame& after,
                                       const Light& light,
                                       double guard_texels,
                                       const SampleOptions& options) {
  if (absl::Status status = ValidateSampleOptions(options); !status.ok()) return status;
  if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  const absl::StatusOr<PlanLookUp> look_up_before = LookUpOf(before, "before", light, guard_texels);
  if (!look_up_before.ok()) return look_up_before.status();
  const absl::StatusOr<PlanLookUp> look_up_after = LookUpOf(after, "after", light, guard_texels);
  if (!look_up_after.ok()) return look_up_after.status();
  ScratchVector<PixelFootprints> footprints;
  for (const PlanMap& map : after.plan.maps) {
    absl::StatusOr<PixelFootprints> of_map =
        PixelFootprints::Create(after.readback, light, map.map_from_world, options);
    if (!of_map.ok()) return of_map.status();
    footprints.push_back(*std::move(of_map));
  }
  const auto drift_at = [&](const Eigen::Vector3d& world) -> std::optional<PointDrift> {
    const PlanPlace from = look_up_before->At(world), to = look_up_after->At(world);
    if (from.map < 0 || to.map < 0) return std::nullopt;
    return PointDrift{PhaseChange(from.texel, to.texel), from.map != to.map};
  };
  const auto J_screen_map_at =
      [&](int x, int y, const Eigen::Vector3d& world) -> std::optional<Eigen::Matrix2d> {
    const int map = look_up_after->At(world).map;
    if (map < 0) return std::nullopt;
    const std::optional<PixelFootprint> pixel = footprints[map].At(x, y);
    if (!pixel.has_value() || pixel->is_behind) return std::nullopt;
    return pixel->J_screen_map;
  };
  return MeasureCrawl(
      before.readback, after.readback, after.surfaces, light, {drift_at, J_screen_map_at}, options);
}

}  // namespace lightfit
