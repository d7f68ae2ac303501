// jobs/compare/totals.h
//
// What a comparison over many lights comes to.
// In:   LightComparisons with the same rows.
// Out:  MethodTotals of each row, over the lights that both it and lightfit have a result for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/types/span.h"
#include "jobs/compare/rows.h"

namespace lightfit {

// How many times as many: this method's over lightfit's. Absent where lightfit's is 0.
std::optional<double> RatioOf(double value, double lightfit_value);

// Of one kind of wrong pixels, and of energies; absent also where either row has none.
std::optional<double> WrongRatio(const ComparedRow& row,
                                 const ComparedRow& lightfit,
                                 int64_t WrongPixels::*kind);
std::optional<double> EnergyRatio(const ComparedRow& row, const ComparedRow& lightfit);

struct MethodTotals {
  std::string name;
  int num_lights = 0;        // with maps of this method and of lightfit: what is counted below
  int num_failed = 0;        // without maps of this method
  int num_dark = 0;          // of num_lights: whose maps have a dark border
  double mean_maps = 0.0;    // over num_lights
  double mean_texels = 0.0;  // likewise, of all maps of a light

  // Wrong pixels; absent without truth or without lights.
  struct Pixels {
    int64_t total = 0;
    int64_t lightfit_total = 0;
    std::optional<double> ratio;  // of the totals

    // Geometric mean over the lights of (wrong + 1) / (lightfit's wrong + 1): every light counts
    // the same, and none of them divides by zero.
    double mean_ratio = 1.0;

    int num_wins = 0;  // lights with fewer wrong pixels than lightfit
  };
  std::optional<Pixels> ideal, practical;

  // Geometric mean of the ratios of energies over `num_energy_lights`; absent when that is 0.
  std::optional<double> mean_energy_ratio;
  int num_energy_lights = 0;

  // Over the lights for which both have it, PooledCrawl(); absent where there are none.
  std::optional<MapCrawl> crawl;
  int num_crawl_lights = 0;
};

std::vector<MethodTotals> TotalsOf(absl::Span<const LightComparison> lights);

}  // namespace lightfit
