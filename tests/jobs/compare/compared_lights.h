// tests/jobs/compare/compared_lights.h
//
// Comparisons made by hand, for totals, tables and pictures.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "jobs/compare/rows.h"
#include "jobs/schemes/scheme.h"

namespace lightfit {

// Of a row with a single map.
inline const Eigen::Matrix4d& MatrixOf(const ComparedRow& row) {
  return OnlyMap(row.drawn)->map_from_world;
}

inline ComparedRow Row(const std::string& name, int64_t ideal, int64_t practical, double energy) {
  ComparedRow row;
  row.name = name;
  row.wrong = WrongPixels();
  row.wrong->ideal = ideal;
  row.wrong->practical = practical;
  row.figures = Figures();
  row.figures->energy = energy;
  return row;
}

inline ComparedRow FailedRow(const std::string& name, const std::string& reason) {
  ComparedRow row;
  row.name = name;
  row.status = absl::FailedPreconditionError(reason);
  return row;
}

inline LightComparison OneLight(const std::string& name, std::vector<ComparedRow> rows) {
  LightComparison light;
  light.light = Light::Directional(name, {0, -1, 0.5});
  light.rows = std::move(rows);
  return light;
}

inline std::vector<LightComparison> ThreeLights() {
  return {OneLight("a", {Row("focused", 30, 40, 8), Row("lightfit", 10, 20, 2)}),
          OneLight("b", {Row("focused", 5, 20, 2), Row("lightfit", 9, 20, 4)}),
          OneLight("c", {FailedRow("focused", "no, \"never\""), Row("lightfit", 100, 100, 1)})};
}

}  // namespace lightfit
