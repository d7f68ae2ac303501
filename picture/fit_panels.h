// picture/fit_panels.h
//
// What the picture of a fit shows of one light, before anything is drawn.
// In:   surfaces, a FitComparison.
// Out:  LightPanels: footprints over the image and what lands in the maps, before and after.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "jobs/fit_comparison.h"
#include "optimizer/readback/surfaces.h"
#include "picture/color_map.h"
#include "picture/map_panel.h"
#include "picture/plan_panel.h"

namespace lightfit {

// What is drawn of one matrix.
struct MatrixPanels {
  std::vector<float> footprints;
  MapView view;
};

// What is drawn of a plan.
struct PlanPanels {
  std::vector<float> footprints;
  PlanView view;
};

struct LightPanels {
  absl::Status status;  // of the light's answer: without one there is nothing else
  std::vector<uint8_t> samples;

  // The focused map, or beside a plan the single map; absent where there is none.
  std::optional<MatrixPanels> before;
  std::optional<MatrixPanels> after;  // one of the two
  std::optional<PlanPanels> plan;
};

// One for before and after and for all lights, so that a colour means the same in all of them.
LogScale ScaleOf(absl::Span<const LightPanels> lights);

// `receivers` are ReceiverPositions(); `samples` as used by the fit.
absl::StatusOr<LightPanels> MakeLightPanels(const Surfaces& surfaces,
                                            const std::vector<Eigen::Vector3d>& receivers,
                                            const FitComparison& light,
                                            const SampleOptions& samples,
                                            double guard_texels);

}  // namespace lightfit
