// bench/plans/plan_table.h
//
// The tables of bench_plans.
// In:   wrong pixels of every row on every light.
// Out:  ratios to other rows over all lights, indoors and per scene; on how many lights plans are
//       behind; a CSV file.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "bench/plans/plan_rows.h"

namespace lightfit {

struct MeasuredPlan {
  bool is_there = false;
  double ideal = 0.0, practical = 0.0, outside = 0.0;
  double seconds = 0.0;
  int num_maps = 0;

  // Of matrices: maps that hold a receiver, draws for each caster; wrong pixels foretold.
  bool is_plan = false;
  double overlap = 0.0, draws = 0.0, foretold = 0.0;
};

struct PlannedLightRow {
  std::string scene, light;
  std::vector<MeasuredPlan> rows;
};

// To stdout. Every light has a MeasuredPlan for each row.
void PrintPlanTables(const std::vector<PlanRow>& rows, const std::vector<PlannedLightRow>& lights);

absl::Status WritePlanCsv(const std::string& path,
                          const std::vector<PlanRow>& rows,
                          const std::vector<PlannedLightRow>& lights);

}  // namespace lightfit
