#include "cli/reports/fit_cells.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "base/number.h"
#include "optimizer/figures/foretell.h"

namespace lightfit::cli {

std::string WrongText(const absl::StatusOr<JudgedMatrix>& map) {
  return map.ok() ? PercentText(map->figures.wrong_share.value_or(0.0)) : "-";
}

std::string RatioText(const absl::StatusOr<JudgedMatrix>& before, const Figures& answer) {
  if (!before.ok() || !(answer.wrong_share.value_or(0.0) > 0.0)) return "-";
  const double ratio = before->figures.wrong_share.value_or(0.0) / *answer.wrong_share;
  if (ratio < kSameForecast && ratio > 1.0 / kSameForecast) return "same";
  return absl::StrCat(FigureText(ratio), "x");
}

std::string CoverText(const FitOptions& options) {
  if (options.cover == Cover::kReceivers) return "visible";
  if (options.border == BorderChoice::kDark) return "lit, dark border";
  return options.border == BorderChoice::kAutomatic ? "shadowed or lit, the border by forecast"
                                                    : "shadowed";
}

bool HasDarkBorder(const std::vector<FitComparison>& comparisons) {
  return std::any_of(comparisons.begin(), comparisons.end(), [](const FitComparison& comparison) {
    return comparison.ok() && comparison.border() == Border::kDark;
  });
}

}  // namespace lightfit::cli
