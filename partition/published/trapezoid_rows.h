// partition/published/trapezoid_rows.h
//
// A trapezoid in rows of rectangles that waste no more than a share of their area.
// In:   a trapezoid; the share (zeta), how long a rectangle may be (sigma), the most there may be.
// Out:  rows along the axis, the near one first, each in columns of equal width.
//
// Tang et al. 2017, (1); published_plans.md (T2). A row is as wide as the trapezoid at its
// far side. The last row ends with the trapezoid: it is cut there, or stretched up to there where
// more rows would be needed than there may be, and then may waste more.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "partition/published/trapezoid.h"

namespace lightfit {

struct RowOptions {
  double zeta = 0.25;   // the most waste, in (0, 1/2)
  double sigma = 0.5;   // a cell is at most 1 + sigma as wide as it is long, > 0
  int max_rows = 4;     // >= 1
  int max_columns = 2;  // of a row, >= 1
};

absl::Status ValidateRowOptions(const RowOptions& options);

struct TrapezoidRow {
  double begin = 0.0, end = 0.0;  // along the axis
  double width = 0.0;             // W_i
  int num_columns = 1;            // N_w

  double length() const { return end - begin; }  // H_i

  // Share of the rectangle outside of the trapezoid.
  double Waste(const Trapezoid& trapezoid) const { return length() * trapezoid.slope / width; }
};

// Requires a base and a length > 0, and valid options.
std::vector<TrapezoidRow> TrapezoidRows(const Trapezoid& trapezoid, const RowOptions& options);

int NumCells(const std::vector<TrapezoidRow>& rows);

}  // namespace lightfit
