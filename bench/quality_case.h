// bench/quality_case.h
//
// One light fitted by every method, each matrix judged by the same measure.
// In:   a read-back, a light, the map's size.
// Out:  energies, sample by sample, of all methods and of brute force.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "bench/brute_force.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "optimizer/fit_options.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

struct Method {
  std::string name;
  FitOptions options;
};

// What is the same for all methods: Chong & Gortler's samples, squared footprints, all receivers in
// the map. That is what brute force minimises too.
FitOptions QualityObjective();

// default, line_search_refined, line_search, as_published, focused: in this order. "default" is the
// search that FitOptions choose by default, on QualityObjective() instead of the default metric and
// cover.
std::vector<Method> QualityMethods();

struct MethodResult {
  std::string method;
  double energy = 0.0;           // of the returned matrix, sample by sample
  double energy_reported = 0.0;  // what the fit said
  double outside_texels = 0.0;   // of the receiver furthest outside the map
  int evaluations = 0;
};

struct QualityCase {
  std::string input, light;
  MapSize map;
  int num_samples = 0;
  // One for each of QualityMethods(), then "start", where the default search began, and
  // "brute_force". For these two nothing but the energy is known.
  std::vector<MethodResult> results;

  double EnergyOf(const std::string& method) const;
};

// FailedPrecondition where no single map exists or there is nothing to fit, as FitLight. Internal
// where only some of the methods find a map.
absl::StatusOr<QualityCase> MeasureQuality(const std::string& input,
                                           const Readback& readback,
                                           const Light& light,
                                           MapSize map,
                                           const BruteForceOptions& brute_force);

}  // namespace lightfit
