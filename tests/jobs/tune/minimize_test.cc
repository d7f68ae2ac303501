#include "jobs/tune/minimize.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

// A bowl with steps, as counts of pixels are: 1000 at `middle` and more elsewhere.
double SteppedBowl(const std::vector<double>& point, const std::vector<double>& middle) {
  double sum = 0.0;
  for (size_t i = 0; i < point.size(); ++i) {
    sum += (1.0 + 5.0 * i) * (point[i] - middle[i]) * (point[i] - middle[i]);
  }
  return std::floor(1000.0 + 20'000.0 * sum);
}

std::vector<double> RandomPoint(testing::Random& random, double reach) {
  std::vector<double> point;
  for (int i = 0; i < 8; ++i) point.push_back(random.Uniform(-reach, reach));
  return point;
}

TEST(Minimize, ComesNearTheLeastOfAFunctionOfSteps) {
  testing::Random random(31);
  for (int i = 0; i < 10; ++i) {
    const std::vector<double> middle = RandomPoint(random, 0.15);
    const auto minimum = Minimize([&](const auto& point) { return SteppedBowl(point, middle); },
                                  std::vector<double>(8, 0.0),
                                  {.evaluations = 800});
    ASSERT_TRUE(minimum.has_value());
    const double start = SteppedBowl(std::vector<double>(8, 0.0), middle);
    // A hundredth of the way is left: some steps of the smallest size.
    EXPECT_LT(minimum->value - 1000.0, 0.01 * (start - 1000.0) + 20.0);
    EXPECT_EQ(SteppedBowl(minimum->point, middle), minimum->value);
    EXPECT_EQ(minimum->evaluations, 800);
  }
}

TEST(Minimize, ASmallBudgetSeesTheFirstPointsOfALargeOne) {
  testing::Random random(32);
  const std::vector<double> middle = RandomPoint(random, 0.1);
  std::vector<std::vector<double>> seen[2];
  for (const int i : {0, 1}) {
    const auto minimum = Minimize(
        [&](const auto& point) {
          seen[i].push_back(point);
          return SteppedBowl(point, middle);
        },
        std::vector<double>(8, 0.0),
        {.evaluations = i == 0 ? 137 : 900, .seed = 5});
    ASSERT_TRUE(minimum.has_value());
  }
  ASSERT_EQ(seen[0].size(), 137u);
  ASSERT_EQ(seen[1].size(), 900u);
  seen[1].resize(137);
  EXPECT_EQ(seen[0], seen[1]);
  EXPECT_EQ(seen[0][0], std::vector<double>(8, 0.0));
}

TEST(Minimize, KeepsTheStartWhereNothingIsBetterAndStaysInside) {
  const auto minimum = Minimize(
      [](const std::vector<double>& point) {
        double most = 0.0;
        for (const double coordinate : point) {
          EXPECT_LE(std::abs(coordinate), 0.08);
          most = std::max(most, std::abs(coordinate));
        }
        return most > 0.0 ? 1e9 : 7.0;
      },
      std::vector<double>(8, 0.0),
      {.evaluations = 300, .bound = 0.08});
  ASSERT_TRUE(minimum.has_value());
  EXPECT_EQ(minimum->value, 7.0);
  EXPECT_EQ(minimum->point, std::vector<double>(8, 0.0));
}

// A flat function converges at once, over and over.
TEST(Minimize, EndsWithItsBudgetOnAFlatFunction) {
  const auto minimum =
      Minimize([](const auto&) { return 3.0; }, std::vector<double>(8, 0.0), {.evaluations = 500});
  ASSERT_TRUE(minimum.has_value());
  EXPECT_EQ(minimum->evaluations, 500);
}

TEST(Minimize, StopsWhenTheFunctionDoes) {
  int num_asked = 0;
  const auto minimum = Minimize(
      [&](const auto&) -> std::optional<double> {
        if (++num_asked > 40) return std::nullopt;
        return 100.0 - num_asked;
      },
      std::vector<double>(8, 0.0),
      {});
  ASSERT_TRUE(minimum.has_value());
  EXPECT_EQ(minimum->evaluations, 40);
  EXPECT_EQ(minimum->value, 60.0);
  EXPECT_EQ(num_asked, 41);
  EXPECT_FALSE(Minimize([](const auto&) { return std::nullopt; }, std::vector<double>(8, 0.0), {}));
}

}  // namespace
}  // namespace lightfit
