#include "base/exact_sum.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <vector>

#include "absl/types/span.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::Random;
using Rational = boost::multiprecision::cpp_rational;

Rational SumOf(absl::Span<const double> terms) {
  Rational sum = 0;
  for (const double term : terms) sum += Rational(term);
  return sum;
}

// Terms of very different sizes, some of which cancel.
std::vector<double> RandomTerms(Random& random, int count) {
  std::vector<double> terms;
  for (int i = 0; i < count; ++i) {
    const double magnitude = random.LogUniform(1e-40, 1e40);
    terms.push_back((random.Coin() ? 1.0 : -1.0) * magnitude);
    if (random.Int(0, 3) == 0) terms.push_back(-terms.back());
  }
  return terms;
}

ExactSum Added(const std::vector<double>& terms) {
  ExactSum sum;
  for (const double term : terms) sum.Add(term);
  return sum;
}

TEST(ExactSum, EqualsRationalArithmetic) {
  Random random(101);
  for (int i = 0; i < 300; ++i) {
    const std::vector<double> terms = RandomTerms(random, random.Int(1, 20));
    const ExactSum sum = Added(terms);
    const Rational expected = SumOf(terms);
    EXPECT_EQ(SumOf(sum.Parts()), expected);
    EXPECT_EQ(sum.Sign(), expected.sign());
    // The nearest double: none of its neighbours is nearer.
    const double value = sum.Value();
    const Rational error = abs(Rational(value) - expected);
    for (const double infinity : {-HUGE_VAL, HUGE_VAL}) {
      EXPECT_LE(error, abs(Rational(std::nextafter(value, infinity)) - expected));
    }
  }
}

TEST(ExactSum, HasTheSamePartsInAnyOrderAndGrouping) {
  Random random(102);
  for (int i = 0; i < 200; ++i) {
    std::vector<double> terms = RandomTerms(random, random.Int(2, 20));
    const std::vector<double> parts = Added(terms).Parts();
    for (int k = 0; k < 5; ++k) {
      for (size_t j = terms.size(); j > 1; --j) {
        std::swap(terms[j - 1], terms[random.Int(0, static_cast<int>(j) - 1)]);
      }
      const auto middle = terms.begin() + random.Int(0, static_cast<int>(terms.size()));
      ExactSum sum = Added({terms.begin(), middle});
      sum.Add(Added({middle, terms.end()}));
      EXPECT_EQ(sum.Parts(), parts);
    }
    // What is written down and read again is the same number.
    EXPECT_EQ(Added(parts).Parts(), parts);
  }
}

TEST(ExactSum, RoundsTiesByWhatIsSmallerYet) {
  const double half_ulp = 0x1p-53;
  EXPECT_EQ(Added({1.0, half_ulp}).Value(), 1.0);
  EXPECT_EQ(Added({1.0, half_ulp, 1e-40}).Value(), 1.0 + 0x1p-52);
  EXPECT_EQ(Added({1.0, half_ulp, -1e-40}).Value(), 1.0);
  EXPECT_EQ(Added({-1.0, -half_ulp, -1e-40}).Value(), -1.0 - 0x1p-52);
}

TEST(ExactSum, OfNothingIsZero) {
  EXPECT_EQ(ExactSum().Value(), 0.0);
  EXPECT_EQ(ExactSum().Sign(), 0);
  EXPECT_TRUE(ExactSum().Parts().empty());
  EXPECT_TRUE(Added({1e30, 1.0, -1e30, -1.0}).Parts().empty());
}

TEST(ExactSum, AddsProductsAndItself) {
  Random random(103);
  for (int i = 0; i < 200; ++i) {
    const double a = random.Uniform(-10.0, 10.0), b = random.Uniform(-10.0, 10.0);
    ExactSum sum;
    sum.AddProduct(a, b);
    EXPECT_EQ(SumOf(sum.Parts()), Rational(a) * Rational(b));
    sum.Add(sum);
    EXPECT_EQ(SumOf(sum.Parts()), 2 * Rational(a) * Rational(b));
  }
}

TEST(OrientationOfRays, IsTheSignOfTheExactDeterminant) {
  Random random(104);
  int num_exact = 0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d a = random.UnitVector(), b = random.UnitVector();
    Eigen::Vector3d c = random.UnitVector();
    // Half of them within rounding of the plane of a and b.
    if (i % 2 == 0) c = random.Uniform(-1.0, 1.0) * a + random.Uniform(-1.0, 1.0) * b;
    Rational determinant = 0;
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3, m = (k + 2) % 3;
      determinant += Rational(c(k)) * (Rational(a(l)) * Rational(b(m)) -  //
                                       Rational(a(m)) * Rational(b(l)));
    }
    EXPECT_EQ(OrientationOfRays(a, b, c), determinant.sign());
    EXPECT_EQ(OrientationOfRays(b, a, c), -determinant.sign());
    num_exact += std::abs(a.cross(b).dot(c)) < 1e-15;
  }
  EXPECT_GE(num_exact, 500);
  const Eigen::Vector3d a(0.1, 0.2, 0.3);
  EXPECT_EQ(OrientationOfRays(a, 2.0 * a, random.UnitVector()), 0);
}

}  // namespace
}  // namespace lightfit
