#include "base/number.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/numbers.h"
#include "absl/strings/str_format.h"

namespace lightfit {

std::string FigureText(double value) {
  if (value == 0) return "0";
  // Rounded first, so that 0.9996 counts as 1.00.
  double size = 0;
  if (!absl::SimpleAtod(absl::StrFormat("%.2e", std::abs(value)), &size)) return "?";
  if (!(size >= 1e-4 && size < 1e6)) return absl::StrFormat("%.2e", value);
  const int num_decimals = std::max(0, 2 - static_cast<int>(std::floor(std::log10(size))));
  return absl::StrFormat("%.*f", num_decimals, value);
}

}  // namespace lightfit
