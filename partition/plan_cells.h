// partition/plan_cells.h
//
// The cells of a light's plans, of any number of maps.
// In:   ServedRays, options.
// Out:  fitted cells, grown or clustered, then alternated.   docs/mathematics.md 11
#pragma once

#include "absl/status/statusor.h"
#include "base/scratch.h"
#include "geometry/light.h"
#include "optimizer/fit_options.h"
#include "partition/cell_fit.h"
#include "partition/cells.h"
#include "partition/plan_options.h"
#include "partition/served_rays.h"

namespace lightfit {

class PlanCells {
 public:
  // Of `options` count texels and the most maps. All must outlive the object.
  PlanCells(const ServedRays& rays,
            const Light& light,
            const FitOptions& fit,
            const PlanOptions& options);

  // Perhaps fewer than so many. FailedPrecondition where there are none; CancelledError once a
  // StopScope says so.
  absl::StatusOr<Cells> Of(int num_maps) const;

  const CellFitter& fitter() const { return fitter_; }

 private:
  double TexelsOf(int num_maps) const;
  absl::Status SurroundedByError(int num_maps) const;

  const Light& light_;
  const PlanOptions& options_;
  CellFitter fitter_;
  ScratchVector<Cells> grown_;
};

}  // namespace lightfit
