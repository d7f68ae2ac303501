#include "bench/wrong_ratio.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"

namespace lightfit {

void WrongRatio::Add(double wrong, double of_other) {
  constexpr double kEnoughPixels = 300.0;
  ++count_;
  sum_ += wrong;
  sum_of_other_ += of_other;
  log_sum_ += std::log((wrong + 1.0) / (of_other + 1.0));
  if (of_other >= kEnoughPixels) worst_ = std::max(worst_, wrong / of_other);
}

double WrongRatio::total() const { return sum_ / std::max(1.0, sum_of_other_); }

double WrongRatio::mean() const { return std::exp(log_sum_ / std::max(1, count_)); }

std::string WrongRatio::Text(bool with_worst) const {
  if (count_ == 0) return "-";
  std::string text = absl::StrFormat("%.2f %.2f", total(), mean());
  if (with_worst) absl::StrAppendFormat(&text, " %.2f", worst_);
  return text;
}

}  // namespace lightfit
