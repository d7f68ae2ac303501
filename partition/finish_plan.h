// partition/finish_plan.h
//
// From fitted cells to the matrices of a plan; the steps of that for maps that are there already.
// In:   the LightView, fitted cells, PlanOptions; or a cell's bins and the samples of its map.
// Out:  LightPlan: sizes in whole texels, depth rows, figures over the samples that ask each map.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "base/scratch.h"
#include "geometry/ray_maps.h"
#include "optimizer/energy/summary.h"
#include "optimizer/light_view.h"
#include "optimizer/readback/samples.h"
#include "optimizer/search/axis_search.h"
#include "partition/cell_fit.h"
#include "partition/cells.h"
#include "partition/fit_plan.h"
#include "partition/plan_options.h"

namespace lightfit {

// FailedPrecondition when the texels are too few for any map, or the guard leaves nothing of one;
// CancelledError once a StopScope says so.
absl::StatusOr<LightPlan> FinishPlan(const LightView& view,
                                     const CellFitter& fitter,
                                     const Cells& cells,
                                     const PlanOptions& options);

// What a cell's map must have room for. `near`: for point lights, the least X_3 of a covered
// receiver in the cover's rays.
struct CoverOfCell {
  CellCover cone;
  double near = 0.0;
};

struct MapOfCell {
  Eigen::Matrix3d map_from_ray;  // of ServedRays' rays; not mirrored
  MapSize size;
  CoverOfCell cover;
};

// The maps of cells, in whole texels and with their margins. FailedPrecondition as FinishPlan().
absl::StatusOr<ScratchVector<MapOfCell>> MapsOfCells(const CellFitter& fitter,
                                                     const Cells& cells,
                                                     const PlanOptions& options);

// Nothing where CoverBins() gives nothing.
std::optional<CoverOfCell> FindCoverOfCell(const ServedRays& rays, Bins bins, const Light& light);

// The view's samples that ask each of the maps, which are of its normalised rays; `guard_texels` as
// PlanLookUp has them.
ScratchVector<Samples> SamplesByMap(const LightView& view,
                                    absl::Span<const RayMap> maps,
                                    double guard_texels);

// What the matrix and the figures of one of several maps are made from (optimizer/fit_matrix.h).
// Without a search nobody asks for the energy's tensor, and it is 0.
struct CellInputs {
  Summary summary;
  Samples samples;  // that ask the map, in the rays of the cell's cover
  Eigen::Matrix3d ray_from_cover;

  // Refers to this object.
  SearchInputs Of(const LightView& view) const {
    return {*view.light, summary, samples.size() > 0 ? &samples : nullptr, view.surfaces};
  }
};
CellInputs InputsOfCell(const LightView& view,
                        const ServedRays& rays,
                        const CoverOfCell& cover,
                        Samples samples,
                        const FitOptions& options);

}  // namespace lightfit
