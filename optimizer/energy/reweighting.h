// optimizer/energy/reweighting.h
//
// Rounds of reweighting: fit, weigh by the fit, fit again.   math.md 4
// In:   of each round what came of it, and its value.
// Out:  the best of all rounds, and whether another is worth its time.
//
// Iteratively reweighted least squares need not go down in every round, nor does the maximum under
// Lawson's weights, so that what is kept is the best and not the last.
#pragma once

#include <utility>

namespace lightfit {

template <typename Result>
class BestOfRounds {
 public:
  // A round that brings the value down by less than this share gains nothing. >= 0.
  explicit BestOfRounds(double least_gain = 0.0) : least_gain_(least_gain) {}

  // Keeps `result` if its value is less than that of every round before. Whether it gained; the
  // first always does.
  bool Offer(double value, Result result) {
    const bool gained = is_empty_ || value < (1.0 - least_gain_) * value_;
    if (is_empty_ || value < value_) {
      value_ = value;
      best_ = std::move(result);
      is_empty_ = false;
    }
    return gained;
  }

  // Require an offer.
  const Result& Best() const& { return best_; }
  Result&& Best() && { return std::move(best_); }

 private:
  double least_gain_;
  bool is_empty_ = true;
  double value_ = 0.0;
  Result best_;
};

}  // namespace lightfit
