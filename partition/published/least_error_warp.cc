#include "partition/published/least_error_warp.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lightfit {

namespace {

// M_v over some factor.
double ErrorOf(absl::Span<const WarpCorner> corners, double length, double one_over_n) {
  double largest = 0.0;
  for (const WarpCorner& corner : corners) {
    const double w = 1.0 + corner.b * one_over_n;
    largest = std::max(largest, w * w / corner.pixel_width);
  }
  return largest / (1.0 + length * one_over_n);
}

}  // namespace

double LeastErrorWarp(absl::Span<const WarpCorner> corners) {
  if (corners.empty()) return 0.0;
  WarpCorner end = corners[0];
  double least_width = end.pixel_width;
  for (const WarpCorner& corner : corners) {
    if (corner.b > end.b) end = corner;
    least_width = std::min(least_width, corner.pixel_width);
  }
  if (!(end.b > 0.0)) return 0.0;
  // Each corner's error is a quadratic over a linear function, so the largest is convex; at the far
  // end it alone is more from here on than without a warp.
  double low = 0.0, high = std::max(end.pixel_width / least_width - 1.0, 0.0) / end.b;
  // Golden section.
  constexpr int kSteps = 80;
  const double share = 0.5 * (std::sqrt(5.0) - 1.0);
  double left = high - share * (high - low), right = low + share * (high - low);
  double left_error = ErrorOf(corners, end.b, left), right_error = ErrorOf(corners, end.b, right);
  for (int i = 0; i < kSteps; ++i) {
    if (left_error <= right_error) {
      high = std::exchange(right, left);
      right_error = left_error;
      left = high - share * (high - low);
      left_error = ErrorOf(corners, end.b, left);
    } else {
      low = std::exchange(left, right);
      left_error = right_error;
      right = low + share * (high - low);
      right_error = ErrorOf(corners, end.b, right);
    }
  }
  return 0.5 * (low + high);
}

}  // namespace lightfit
