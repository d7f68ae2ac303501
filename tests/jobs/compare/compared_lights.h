// tests/jobs/compare/compared_lights.h
//
// Comparisons made by hand, for totals, tables and pictures.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "jobs/compare/rows.h"

namespace lightfit {

inline ComparedMap Row(const std::string& name, int64_t ideal, int64_t practical, double energy) {
  ComparedMap map;
  map.name = name;
  map.wrong = WrongPixels();
  map.wrong->ideal = ideal;
  map.wrong->practical = practical;
  map.figures = Figures();
  map.figures->energy = energy;
  return map;
}

inline ComparedMap FailedRow(const std::string& name, const std::string& reason) {
  ComparedMap map;
  map.name = name;
  map.status = absl::FailedPreconditionError(reason);
  return map;
}

inline LightComparison OneLight(const std::string& name, std::vector<ComparedMap> maps) {
  LightComparison light;
  light.light = Light::Directional(name, {0, -1, 0.5});
  light.maps = std::move(maps);
  return light;
}

inline std::vector<LightComparison> ThreeLights() {
  return {OneLight("a", {Row("focused", 30, 40, 8), Row("lightfit", 10, 20, 2)}),
          OneLight("b", {Row("focused", 5, 20, 2), Row("lightfit", 9, 20, 4)}),
          OneLight("c", {FailedRow("focused", "no, \"never\""), Row("lightfit", 100, 100, 1)})};
}

}  // namespace lightfit
