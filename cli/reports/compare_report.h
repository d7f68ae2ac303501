// cli/reports/compare_report.h
//
// A comparison in words and figures, for the terminal.
// In:   CompareHeading, and every method on every light (jobs/compare/rows.h).
// Out:  text that ends in a newline.
#pragma once

#include <string>
#include <vector>

#include "absl/types/span.h"
#include "jobs/compare/rows.h"
#include "jobs/compare/totals.h"

namespace lightfit::cli {

// "map 400 x 400 texels".
std::string MapText(MapSize map);

// What is above the tables.
struct CompareHeading {
  std::string source;                       // the scene or the read-back
  int screen_width = 0, screen_height = 0;  // 0: only a read-back is known
  int readback_width = 0, readback_height = 0;
  std::string maps;        // what every method may spend: MapText(), PlanSizeText()
  bool has_plans = false;  // whether methods may have several maps
  int phases = 1;          // of the counts of wrong pixels
  std::string fit;         // of the row "lightfit", see MethodText(), PlanMethodText()
  std::string next;        // the frame that crawl is measured to; empty: none is
};

// What the columns mean, whichever there are.
std::string CompareLegend();

// One light: a table of it. More: one table over all lights, after one of each if `per_light`.
std::string CompareReportText(const CompareHeading& heading,
                              absl::Span<const LightComparison> lights,
                              bool per_light,
                              bool has_legend = false);

}  // namespace lightfit::cli
