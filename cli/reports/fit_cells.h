// cli/reports/fit_cells.h
//
// What the tables of `lightfit fit` have in common: cells, and words about covers and borders.
// In:   judged maps and their figures; FitOptions.
// Out:  the text of one cell; words.
#pragma once

#include <string>
#include <vector>

#include "jobs/fit_comparison.h"

namespace lightfit::cli {

// In the row of a light that has none.
inline constexpr char kNoMatrix[] = "no matrix, see below";
inline constexpr char kNoPlan[] = "no plan, see below";

// Per cent of the image's pixels foretold to be wrong; "-" without a map.
std::string WrongText(const absl::StatusOr<JudgedMatrix>& map);

// "1.86x": how many times as many wrong pixels `before` has as the answer; "same" where the
// forecast cannot tell, "-" where there is nothing to compare.
std::string RatioText(const absl::StatusOr<JudgedMatrix>& before, const Figures& answer);

// "shadowed or lit, the border by forecast": what maps have room for.
std::string CoverText(const FitOptions& options);

bool HasDarkBorder(const std::vector<FitComparison>& comparisons);

}  // namespace lightfit::cli
