// base/exact_sum.h
//
// Sums of doubles without any rounding: the same number in whatever order it is added up.
// In:   finite doubles, products of them, other sums.
// Out:  the exact sum, as doubles that add up to it; its nearest double; its sign.
//
// J. R. Shewchuk, "Adaptive Precision Floating-Point Arithmetic", 1997: a number as the unevaluated
// sum of doubles of falling size that do not overlap.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace lightfit {

// Exact as long as nothing overflows (1e300) and no product is so small that its rounding error
// cannot be told (1e-290).
class ExactSum {
 public:
  ExactSum() = default;

  void Add(double term);
  void AddProduct(double a, double b);
  void Add(const ExactSum& other);

  // The sum as doubles, largest first: each is the nearest to what those before it leave. Equal
  // sums have equal parts, bit for bit; zero has none.
  std::vector<double> Parts() const;

  // The nearest double.
  double Value() const;

  // -1, 0 or 1.
  int Sign() const;

 private:
  // Smallest first, not overlapping, none zero.
  std::vector<double> parts_;
};

// The sign of det [a b c], exactly: on which side of the plane of the rays a and b the ray c lies.
int OrientationOfRays(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);

}  // namespace lightfit
