// jobs/plan_advice.h
//
// What to do about a light that has no single map.
// In:   the error of its fit.
// Out:  the same error, which says how many maps would do.
#pragma once

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "optimizer/fit_options.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

// For a lamp that hangs among its receivers; other errors come back as they are. `field` is what
// asks for so many maps, where the caller is. `map` is that of the fit. Takes a plan or a few.
absl::Status WithNumMaps(const absl::Status& status,
                         const Surfaces& surfaces,
                         const Light& light,
                         MapSize map,
                         const FitOptions& options,
                         absl::string_view field);

}  // namespace lightfit
