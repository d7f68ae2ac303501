#include "picture/fit_panels.h"

#include <utility>

#include "geometry/affine_depth.h"
#include "optimizer/figures/footprint_image.h"
#include "optimizer/readback/needed_surfaces.h"

namespace lightfit {
namespace {

// The roles of the pixels that are receivers, in the order of ReceiverPositions().
std::vector<ReceiverRole> RolesOfReceivers(const Surfaces& surfaces,
                                           const Light& light,
                                           Border border,
                                           const std::vector<uint8_t>& samples) {
  const Readback& readback = surfaces.readback;
  const AffineDepth depth = AffineDepthOf(readback);
  const NeededSurfaces needed(surfaces, light, border);
  std::vector<ReceiverRole> roles;
  for (size_t pixel = 0; pixel < samples.size(); ++pixel) {
    if (!depth.IsSurface(readback.depth[pixel])) continue;
    const bool needs_room = ((needed.words()[pixel] >> light.shadow_bit) & 1u) != 0;
    roles.push_back({needs_room, samples[pixel] != 0});
  }
  return roles;
}

absl::StatusOr<PlanPanels> PanelsOfPlan(const Readback& readback,
                                        const Light& light,
                                        const LightPlan& fitted,
                                        const SampleOptions& options,
                                        double guard_texels,
                                        const std::vector<uint8_t>& samples) {
  std::vector<SizedMatrix> maps;
  for (const LightMatrix& map : fitted.maps) maps.push_back({map.map_from_world, map.map});
  absl::StatusOr<std::vector<float>> footprints = FootprintImage(readback, light, maps, options);
  if (!footprints.ok()) return footprints.status();
  absl::StatusOr<PlanView> view = ViewPlan(readback, light, PlanOf(fitted), guard_texels, samples);
  if (!view.ok()) return view.status();
  return PlanPanels{*std::move(footprints), *std::move(view)};
}

}  // namespace

LogScale ScaleOf(absl::Span<const LightPanels> lights) {
  std::vector<float> all;
  for (const LightPanels& light : lights) {
    for (const auto* panels : {&light.before, &light.after}) {
      if (!panels->has_value()) continue;
      all.insert(all.end(), (*panels)->footprints.begin(), (*panels)->footprints.end());
    }
    if (!light.plan.has_value()) continue;
    all.insert(all.end(), light.plan->footprints.begin(), light.plan->footprints.end());
  }
  return FootprintScaleFor(all);
}

absl::StatusOr<LightPanels> MakeLightPanels(const Surfaces& surfaces,
                                            const std::vector<Eigen::Vector3d>& receivers,
                                            const FitComparison& light,
                                            const SampleOptions& options,
                                            double guard_texels) {
  const Readback& readback = surfaces.readback;
  LightPanels panels;
  panels.status = light.status();
  if (!panels.status.ok()) return panels;
  absl::StatusOr<std::vector<uint8_t>> samples = SampleImage(surfaces, light.light, options);
  if (!samples.ok()) return samples.status();
  panels.samples = *std::move(samples);
  const auto panels_of = [&](const JudgedMatrix& judged) -> absl::StatusOr<MatrixPanels> {
    const LightMatrix& matrix = judged.matrix;
    const std::vector<ReceiverRole> roles =
        RolesOfReceivers(surfaces, light.light, matrix.border, panels.samples);
    if (roles.size() != receivers.size()) {
      return absl::InternalError("picture: receivers and surface pixels differ in number");
    }
    absl::StatusOr<std::vector<float>> footprints =
        FootprintImage(readback, light.light, matrix.map_from_world, options);
    if (!footprints.ok()) return footprints.status();
    return MatrixPanels{*std::move(footprints),
                        ViewMap(receivers, roles, matrix.map_from_world, matrix.map)};
  };
  if (light.plan.has_value()) {
    absl::StatusOr<PlanPanels> plan = PanelsOfPlan(
        readback, light.light, (*light.plan)->plan, options, guard_texels, panels.samples);
    if (!plan.ok()) return plan.status();
    panels.plan = *std::move(plan);
  } else {
    absl::StatusOr<MatrixPanels> after = panels_of(*light.final);
    if (!after.ok()) return after.status();
    panels.after = *std::move(after);
  }
  const absl::StatusOr<JudgedMatrix>& before = light.plan.has_value() ? light.final : light.focused;
  if (!before.ok()) return panels;
  absl::StatusOr<MatrixPanels> before_panels = panels_of(*before);
  if (!before_panels.ok()) return before_panels.status();
  panels.before = *std::move(before_panels);
  return panels;
}

}  // namespace lightfit
