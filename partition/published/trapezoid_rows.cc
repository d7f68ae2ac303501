#include "partition/published/trapezoid_rows.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"
#include "partition/plan.h"

namespace lightfit {

namespace {

int NumColumns(double width_over_length, const RowOptions& options) {
  // Far more than there may be is as good as infinitely many.
  const double most = options.max_columns;
  return static_cast<int>(
      std::clamp(std::ceil(width_over_length / (1.0 + options.sigma)), 1.0, most));
}

}  // namespace

absl::Status ValidateRowOptions(const RowOptions& options) {
  if (!(options.zeta > 0.0) || !(options.zeta < 0.5)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "tang: zeta = %g, want more than 0 and less than 1/2; the paper has 0.25", options.zeta));
  }
  if (!(options.sigma > 0.0) || !std::isfinite(options.sigma)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "tang: sigma = %g, want finite and more than 0; the paper has 0.5", options.sigma));
  }
  if (options.max_rows < 1 || options.max_columns < 1 || options.max_rows > kMaxPlanMaps ||
      options.max_columns > kMaxPlanMaps / options.max_rows) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "tang: max_rows = %d, max_columns = %d, want at least 1 and a product of at most %d",
        options.max_rows,
        options.max_columns,
        kMaxPlanMaps));
  }
  return absl::OkStatus();
}

std::vector<TrapezoidRow> TrapezoidRows(const Trapezoid& trapezoid, const RowOptions& options) {
  const double growth = 1.0 / (1.0 - 2.0 * std::min(trapezoid.slope, options.zeta));
  const double length_over_width =
      trapezoid.slope > options.zeta ? options.zeta / trapezoid.slope : 1.0;
  std::vector<TrapezoidRow> rows;
  TrapezoidRow row;
  row.width = trapezoid.base;
  row.num_columns = NumColumns(1.0 / length_over_width, options);
  while (row.end < trapezoid.length) {
    row.begin = row.end;
    row.width *= growth;
    row.end += row.width * length_over_width;
    const bool is_last_allowed = static_cast<int>(rows.size()) + 1 == options.max_rows;
    if (row.end >= trapezoid.length || is_last_allowed) {
      // Cut, the row keeps the columns of (1); stretched, it is another shape.
      const bool is_stretched = row.end < trapezoid.length;
      row.end = trapezoid.length;
      row.width = trapezoid.WidthAt(row.end);
      if (is_stretched) row.num_columns = NumColumns(row.width / row.length(), options);
    }
    rows.push_back(row);
  }
  return rows;
}

int NumCells(const std::vector<TrapezoidRow>& rows) {
  int sum = 0;
  for (const TrapezoidRow& row : rows) sum += row.num_columns;
  return sum;
}

}  // namespace lightfit
