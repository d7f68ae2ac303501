// tests/testing/matchers.h
//
// Matchers that print both sides: matrices within a tolerance, statuses with their message.
#pragma once

#include <gmock/gmock.h>

#include <Eigen/Core>
#include <cmath>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace lightfit::testing {

inline const absl::Status& StatusOf(const absl::Status& status) { return status; }
template <typename T>
const absl::Status& StatusOf(const absl::StatusOr<T>& result) {
  return result.status();
}

// EXPECT_THAT(result, IsOk()), for a Status or a StatusOr.
MATCHER(IsOk, "is OK") {
  *result_listener << StatusOf(arg).ToString();
  return StatusOf(arg).ok();
}

// EXPECT_THAT(result, StatusIs(code, HasSubstr("light \"sun\""))).
MATCHER_P2(StatusIs, code, message_matcher, "has code " + absl::StatusCodeToString(code)) {
  *result_listener << StatusOf(arg).ToString();
  return StatusOf(arg).code() == code &&
         ::testing::Matches(message_matcher)(std::string(StatusOf(arg).message()));
}

// Every entry within `tolerance` of the entry of `expected`.
MATCHER_P2(MatrixNear, expected, tolerance, "is near\n" + ::testing::PrintToString(expected)) {
  if (arg.rows() != expected.rows() || arg.cols() != expected.cols()) return false;
  const double difference = (arg - expected).cwiseAbs().maxCoeff();
  *result_listener << "whose largest difference is " << difference << ", allowed " << tolerance;
  return difference <= tolerance;
}

// |a - b| in units of the larger of the two; 0 when both are 0.
inline double RelativeError(double a, double b) {
  const double scale = std::max(std::abs(a), std::abs(b));
  return scale > 0.0 ? std::abs(a - b) / scale : 0.0;
}

// Matrices that differ by a positive factor only, as homogeneous ones may: |a - s b| / |a| with the
// best s.
template <typename A, typename B>
double HomogeneousError(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b) {
  const double scale = a.cwiseProduct(b).sum() / b.squaredNorm();
  if (!(scale > 0.0)) return std::numeric_limits<double>::infinity();
  return (a - scale * b).norm() / a.norm();
}

}  // namespace lightfit::testing
