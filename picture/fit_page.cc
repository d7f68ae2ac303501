#include "picture/fit_page.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_format.h"
#include "optimizer/figures/footprint_image.h"
#include "picture/fit_panels.h"
#include "picture/fit_rows.h"

namespace lightfit {

namespace {

// The most maps that a plan has; 0: there is no plan.
int MostMaps(const std::vector<FitComparison>& lights) {
  size_t most = 0;
  for (const FitComparison& light : lights) {
    if (light.ok() && light.plan.has_value()) {
      most = std::max(most, (*light.plan)->plan.maps.size());
    }
  }
  return static_cast<int>(most);
}

}  // namespace

absl::StatusOr<Canvas> DrawPicture(const Surfaces& surfaces,
                                   const std::vector<FitComparison>& lights,
                                   const PictureOptions& options,
                                   const Typeface& typeface) {
  const Readback& readback = surfaces.readback;
  const absl::StatusOr<std::vector<Eigen::Vector3d>> receivers = ReceiverPositions(readback);
  if (!receivers.ok()) return receivers.status();
  const int most_maps = MostMaps(lights);
  const FitLayout layout(readback, most_maps > 0);
  std::vector<LightPanels> panels;
  std::vector<std::vector<std::string>> messages;  // empty where there are panels
  for (const FitComparison& light : lights) {
    absl::StatusOr<LightPanels> made =
        MakeLightPanels(surfaces, *receivers, light, options.samples, options.guard_texels);
    if (!made.ok()) return made.status();
    panels.push_back(*std::move(made));
    messages.push_back(typeface.Wrapped(
        std::string(panels.back().status.message()), layout.TextWidth(), {.size_px = 16}));
    if (panels.back().status.ok()) messages.back().clear();
  }

  FitRows page(layout, ScaleOf(panels), FitRows::Height(layout, messages), typeface);
  page.DrawTitle(
      options.title,
      absl::StrFormat(
          "read-back %d x %d pixels, %s", readback.width(), readback.height(), options.maps));
  for (size_t i = 0; i < lights.size(); ++i) {
    if (!panels[i].status.ok()) {
      page.DrawFailedRow(
          lights[i].light.name, options.has_plans ? "no plan" : "no matrix", messages[i]);
    } else if (panels[i].plan.has_value()) {
      page.DrawPlanRow(readback, lights[i], panels[i]);
    } else {
      page.DrawMatrixRow(readback, lights[i], panels[i], options.final_label);
    }
  }
  if (most_maps > 0) {
    page.DrawPlanLegend(most_maps);
  } else {
    page.DrawLegend();
  }
  return page.TakeCanvas();
}

}  // namespace lightfit
