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
#include "partition/plan.h"

namespace lightfit {

// For a lamp that hangs among its receivers, where `most_maps` are enough and `map`, that of the
// fit, has texels for them; other errors come back as they are. `field` is what asks for so many
// maps, where the caller is.
absl::Status WithNumMaps(const absl::Status& status,
                         const Surfaces& surfaces,
                         const Light& light,
                         MapSize map,
                         const FitOptions& options,
                         absl::string_view field,
                         int most_maps = kMaxPlanMaps);

}  // namespace lightfit
