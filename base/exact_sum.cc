#include "base/exact_sum.h"

#include <cmath>
#include <cstddef>

namespace lightfit {

namespace {

// a + b = sum + error, exactly.
struct TwoDoubles {
  double sum, error;
};

TwoDoubles TwoSum(double a, double b) {
  const double sum = a + b;
  const double b_part = sum - a;
  const double a_part = sum - b_part;
  return {sum, (a - a_part) + (b - b_part)};
}

TwoDoubles TwoProduct(double a, double b) {
  const double product = a * b;
  return {product, std::fma(a, b, -product)};
}

}  // namespace

void ExactSum::Add(double term) {
  size_t kept = 0;
  for (const double part : parts_) {
    const TwoDoubles two = TwoSum(term, part);
    if (two.error != 0.0) parts_[kept++] = two.error;
    term = two.sum;
  }
  parts_.resize(kept);
  if (term != 0.0) parts_.push_back(term);
}

void ExactSum::AddProduct(double a, double b) {
  const TwoDoubles product = TwoProduct(a, b);
  Add(product.error);
  Add(product.sum);
}

void ExactSum::Add(const ExactSum& other) {
  // By value: a sum may be added to itself.
  const std::vector<double> terms = other.parts_;
  for (const double term : terms) Add(term);
}

std::vector<double> ExactSum::Parts() const {
  std::vector<double> parts;
  ExactSum rest = *this;
  while (!rest.parts_.empty()) {
    parts.push_back(rest.Value());
    rest.Add(-parts.back());
  }
  return parts;
}

double ExactSum::Value() const {
  if (parts_.empty()) return 0.0;
  // Until a part no longer fits, sums are exact; the first that does not leaves an error, and what
  // is smaller yet matters only where that error is exactly half of the last bit.
  size_t i = parts_.size() - 1;
  double value = parts_[i];
  double error = 0.0;
  while (i > 0 && error == 0.0) {
    const TwoDoubles two = TwoSum(value, parts_[--i]);
    value = two.sum;
    error = two.error;
  }
  if (i > 0 && error != 0.0 && (error > 0.0) == (parts_[i - 1] > 0.0)) {
    const double up = value + 2.0 * error;
    if (up - value == 2.0 * error) value = up;
  }
  return value;
}

int ExactSum::Sign() const {
  if (parts_.empty()) return 0;
  return parts_.back() > 0.0 ? 1 : -1;
}

int OrientationOfRays(const Eigen::Vector3d& a,
                      const Eigen::Vector3d& b,
                      const Eigen::Vector3d& c) {
  // Rounding of the six products and their sum stays below this share of their absolute values.
  constexpr double kRoundingShare = 8.0 * 2.220446049250313e-16;
  double determinant = 0.0, magnitude = 0.0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    determinant += c(i) * (a(j) * b(k) - a(k) * b(j));
    magnitude += std::abs(c(i)) * (std::abs(a(j) * b(k)) + std::abs(a(k) * b(j)));
  }
  if (std::abs(determinant) > kRoundingShare * magnitude) return determinant > 0.0 ? 1 : -1;
  ExactSum exact;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const TwoDoubles plus = TwoProduct(a(j), b(k)), minus = TwoProduct(-a(k), b(j));
    for (const double factor : {plus.sum, plus.error, minus.sum, minus.error}) {
      exact.AddProduct(c(i), factor);
    }
  }
  return exact.Sign();
}

}  // namespace lightfit
