// tests/testing/refiners.h
//
// The refiners of this build: with Ceres or without.
#pragma once

#include <vector>

#include "optimizer/search/refine_ceres.h"
#include "optimizer/search/search_options.h"

namespace lightfit::testing {

inline std::vector<Refiner> Refiners() {
  if (!HasCeres()) return {Refiner::kTinySolver};
  return {Refiner::kTinySolver, Refiner::kCeres};
}

}  // namespace lightfit::testing
