// cli/fit_inputs.h
//
// What `lightfit fit` works on: the lights and the read-back that the flags name.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "cli/fit_flags.h"
#include "geometry/light.h"
#include "io/readback_exr.h"

namespace lightfit {

struct FitInputs {
  std::vector<Light>
      lights;         // those of --lights, then those of --light, as far as --only keeps them
  ReadbackFile file;  // light_status[l] belongs to lights[l]
};

absl::StatusOr<FitInputs> ReadFitInputs(const FitFlags& flags);

}  // namespace lightfit
