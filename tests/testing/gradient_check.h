// tests/testing/gradient_check.h
//
// One analytic gradient against its three references.
// In:   a function written for any scalar type, a point, the analytic gradient there.
// Out:  relative errors against ceres::Jet, central differences and the linearisation; a failed
//       check prints analytic, numeric and difference.
#pragma once

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace lightfit::testing {

// Autodiff differs by rounding alone; differences also by the curvature of the function.
inline constexpr double kAutodiffTolerance = 1e-11;
inline constexpr double kDifferenceTolerance = 1e-6;

struct GradientErrors {
  double autodiff = 0.0;    // |analytic - Jet| / |Jet|
  double difference = 0.0;  // |analytic - central differences| / |central differences|
};

template <int kSize, typename Function>
Eigen::Matrix<double, kSize, 1> AutodiffGradient(const Function& function,
                                                 const Eigen::Matrix<double, kSize, 1>& at) {
  using Jet = ceres::Jet<double, kSize>;
  Eigen::Matrix<Jet, kSize, 1> x;
  for (int k = 0; k < kSize; ++k) x(k) = Jet(at(k), k);
  return function(x).v;
}

// Fourth order, so that the step can be large against rounding.
template <int kSize, typename Function>
Eigen::Matrix<double, kSize, 1> CentralDifferences(const Function& function,
                                                   const Eigen::Matrix<double, kSize, 1>& at,
                                                   double step) {
  Eigen::Matrix<double, kSize, 1> gradient;
  for (int k = 0; k < kSize; ++k) {
    const Eigen::Matrix<double, kSize, 1> h = step * Eigen::Matrix<double, kSize, 1>::Unit(k);
    gradient(k) = (8.0 * (function(Eigen::Matrix<double, kSize, 1>(at + h)) -
                          function(Eigen::Matrix<double, kSize, 1>(at - h))) -
                   (function(Eigen::Matrix<double, kSize, 1>(at + 2.0 * h)) -
                    function(Eigen::Matrix<double, kSize, 1>(at - 2.0 * h)))) /
                  (12.0 * step);
  }
  return gradient;
}

// f(x + w) against f(x) + g.w: the larger remainder of w and -w, where the even and the odd part of
// the remainder cannot cancel.
template <int kSize, typename Function>
double LinearisationRemainder(const Function& function,
                              const Eigen::Matrix<double, kSize, 1>& at,
                              const Eigen::Matrix<double, kSize, 1>& analytic,
                              const Eigen::Matrix<double, kSize, 1>& w) {
  const double here = function(at);
  const double ahead = function(Eigen::Matrix<double, kSize, 1>(at + w)) - here;
  const double behind = function(Eigen::Matrix<double, kSize, 1>(at - w)) - here;
  return std::max(std::abs(ahead - analytic.dot(w)), std::abs(behind + analytic.dot(w)));
}

// The remainder falls with the square of w: a hundredfold when w falls tenfold, within a factor of
// two, down to rounding.
template <int kSize, typename Function>
void ExpectLinearisation(const Function& function,
                         const Eigen::Matrix<double, kSize, 1>& at,
                         const Eigen::Matrix<double, kSize, 1>& analytic,
                         const Eigen::Matrix<double, kSize, 1>& w) {
  constexpr double kRounding = 1e-12;
  const double coarse = LinearisationRemainder<kSize>(function, at, analytic, w);
  const double fine = LinearisationRemainder<kSize>(
      function, at, analytic, Eigen::Matrix<double, kSize, 1>(0.1 * w));
  EXPECT_LE(fine, 0.02 * coarse + kRounding * std::abs(function(at)))
      << "at " << at.transpose() << "\nanalytic " << analytic.transpose() << "\nw "
      << w.transpose();
}

template <int kSize, typename Function>
GradientErrors ExpectGradient(const Function& function,
                              const Eigen::Matrix<double, kSize, 1>& at,
                              const Eigen::Matrix<double, kSize, 1>& analytic,
                              double step) {
  const Eigen::Matrix<double, kSize, 1> autodiff = AutodiffGradient<kSize>(function, at);
  const Eigen::Matrix<double, kSize, 1> differences = CentralDifferences<kSize>(function, at, step);
  GradientErrors errors;
  errors.autodiff = (analytic - autodiff).norm() / autodiff.norm();
  errors.difference = (analytic - differences).norm() / differences.norm();
  EXPECT_LE(errors.autodiff, kAutodiffTolerance)
      << "at " << at.transpose() << "\nanalytic   " << analytic.transpose() << "\nautodiff   "
      << autodiff.transpose() << "\ndifference " << (analytic - autodiff).transpose();
  EXPECT_LE(errors.difference, kDifferenceTolerance)
      << "at " << at.transpose() << "\nanalytic   " << analytic.transpose() << "\nnumeric    "
      << differences.transpose() << "\ndifference " << (analytic - differences).transpose();
  return errors;
}

}  // namespace lightfit::testing
