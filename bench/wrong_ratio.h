// bench/wrong_ratio.h
//
// Wrong pixels of one method over those of another, over any number of lights.
// In:   both counts, light by light.
// Out:  the ratio of totals, the geometric mean, the worst light among those that count.
#pragma once

#include <string>

namespace lightfit {

class WrongRatio {
 public:
  void Add(double wrong, double of_other);

  int count() const { return count_; }
  double total() const;
  double mean() const;                     // of (wrong + 1) over (other + 1)
  double worst() const { return worst_; }  // where the other has 300 or more; 0: nowhere

  // "0.82 0.78": total and mean; "-" without a light. `with_worst`: "0.82 0.78 1.13".
  std::string Text(bool with_worst = false) const;

 private:
  int count_ = 0;
  double sum_ = 0.0, sum_of_other_ = 0.0, log_sum_ = 0.0, worst_ = 0.0;
};

}  // namespace lightfit
