// bench/fit_input.h
//
// What bench_fit runs on: inputs whose lights can all be fitted.
// In:   boxes on a floor at four sizes, 32 lights each; a renderer's read-backs, if any.
// Out:  FitInputs, the lights in an order that makes the first a typical one.
#pragma once

#include <deque>
#include <string>

#include "absl/types/span.h"
#include "bench/inputs.h"
#include "geometry/map_size.h"

namespace lightfit {

inline constexpr MapSize kFitMap = {1024, 1024};

struct FitInput {
  std::string name;  // "1920x1080", "yard_640"

  // Only lights that can be fitted. The first is the median one in the number of matrices that the
  // published search evaluates: it stops early where a light's angles leave no receiver in front.
  Input input;

  int64_t num_pixels() const { return static_cast<int64_t>(input.depth.size()); }
  int num_lights() const { return static_cast<int>(input.lights.size()); }
  absl::Span<const Light> Lights(int count) const {
    return {input.lights.data(), static_cast<size_t>(count)};
  }
};

// Inputs without any light that can be fitted are left out. A deque keeps them in place.
std::deque<FitInput> MakeFitInputs();

}  // namespace lightfit
