#include "partition/published/trapezoid_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "geometry/convex_hull.h"
#include "partition/plan.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::Random;
using testing::StatusIs;

constexpr double kRounding = 1e-12;  // relative, of a few operations a row

Trapezoid RandomTrapezoid(Random& random) {
  Trapezoid trapezoid;
  trapezoid.centre = random.Uniform(-3.0, 3.0);
  trapezoid.base = random.LogUniform(1e-3, 1e3);
  trapezoid.slope = random.Coin() ? random.LogUniform(1e-3, 10.0) : random.Uniform(0.0, 0.5);
  trapezoid.length = trapezoid.base * random.LogUniform(0.01, 300.0);
  return trapezoid;
}

RowOptions RandomOptions(Random& random) {
  RowOptions options;
  options.zeta = random.Uniform(0.02, 0.49);
  options.sigma = random.LogUniform(0.05, 3.0);
  options.max_columns = random.Int(1, 8);
  return options;
}

// The area of rows `begin` to `end` of the trapezoid, by its corners.
double AreaBetween(const Trapezoid& trapezoid, double begin, double end) {
  const double near = 0.5 * trapezoid.WidthAt(begin), far = 0.5 * trapezoid.WidthAt(end);
  const Polygon corners = {{-near, begin}, {near, begin}, {far, end}, {-far, end}};
  return Area(corners);
}

// Formula (1) of the paper, written out, with as many rows as it takes.
TEST(TrapezoidRows, HaveTheSizesOfThePaper) {
  Random random(1);
  int num_rows = 0;
  for (int i = 0; i < 500; ++i) {
    const Trapezoid trapezoid = RandomTrapezoid(random);
    RowOptions options = RandomOptions(random);
    options.max_columns = 1;
    options.max_rows = kMaxPlanMaps;
    const std::vector<TrapezoidRow> rows = TrapezoidRows(trapezoid, options);
    ASSERT_FALSE(rows.empty());
    EXPECT_EQ(rows.back().end, trapezoid.length);
    const double t = trapezoid.slope, zeta = options.zeta;
    for (size_t k = 0; k < rows.size(); ++k) {
      const TrapezoidRow& row = rows[k];
      EXPECT_EQ(row.begin, k == 0 ? 0.0 : rows[k - 1].end);
      // As wide as the trapezoid is at the far side.
      EXPECT_LT(testing::RelativeError(row.width, trapezoid.WidthAt(row.end)), kRounding);
      if (k + 1 == rows.size()) continue;  // cut, or stretched
      const double width = trapezoid.base * std::pow(1.0 / (1.0 - 2.0 * std::min(t, zeta)),
                                                     static_cast<double>(k) + 1.0);
      const double length = t < zeta ? width : zeta / t * width;
      EXPECT_LT(testing::RelativeError(row.width, width), 1e-11);
      EXPECT_LT(testing::RelativeError(row.length(), length), 1e-9);  // a difference of sums
      ++num_rows;
    }
  }
  EXPECT_GT(num_rows, 1000);
}

TEST(TrapezoidRows, WasteIsTheRectanglesShareOutsideOfTheTrapezoid) {
  Random random(2);
  int num_full = 0;
  for (int i = 0; i < 500; ++i) {
    const Trapezoid trapezoid = RandomTrapezoid(random);
    RowOptions options = RandomOptions(random);
    options.max_columns = 1;
    options.max_rows = kMaxPlanMaps;
    const std::vector<TrapezoidRow> rows = TrapezoidRows(trapezoid, options);
    const bool is_complete = rows.size() < static_cast<size_t>(options.max_rows);
    for (const TrapezoidRow& row : rows) {
      const double rectangle = row.width * row.length();
      const double waste = 1.0 - AreaBetween(trapezoid, row.begin, row.end) / rectangle;
      EXPECT_NEAR(row.Waste(trapezoid), waste, 1e-9);
      if (is_complete) {
        EXPECT_LE(row.Waste(trapezoid), options.zeta * (1.0 + kRounding));
      }
      const bool is_last = &row == &rows.back();
      if (!is_last && trapezoid.slope > options.zeta) {
        EXPECT_NEAR(row.Waste(trapezoid), options.zeta, 1e-9);
        ++num_full;
      }
    }
  }
  EXPECT_GT(num_full, 1000);
}

TEST(TrapezoidRows, AreInNoMoreColumnsThanCellsAreTooWide) {
  Random random(3);
  int num_several = 0;
  for (int i = 0; i < 3000; ++i) {
    const Trapezoid trapezoid = RandomTrapezoid(random);
    const RowOptions options = RandomOptions(random);
    const std::vector<TrapezoidRow> rows = TrapezoidRows(trapezoid, options);
    EXPECT_LE(rows.size(), 4u);
    EXPECT_LE(NumCells(rows), 4 * options.max_columns);
    for (const TrapezoidRow& row : rows) {
      EXPECT_GE(row.num_columns, 1);
      EXPECT_LE(row.num_columns, options.max_columns);
      const double most = (1.0 + options.sigma) * row.length();
      if (&row != &rows.back()) {
        // N_w of the paper, but for quotients that are whole numbers.
        const double wanted = std::ceil(row.width / most - 1e-9);
        EXPECT_EQ(row.num_columns, std::min(wanted, 1.0 * options.max_columns));
      }
      if (row.num_columns < options.max_columns && &row != &rows.back()) {
        EXPECT_LE(row.width / row.num_columns, most * (1.0 + kRounding));
      }
      if (row.num_columns > 1) {
        EXPECT_GT(row.width / (row.num_columns - 1), most * (1.0 - 1e-9));
        ++num_several;
      }
    }
  }
  EXPECT_GT(num_several, 300);
}

TEST(TrapezoidRows, TheLastIsStretchedToTheEnd) {
  const Trapezoid trapezoid = {0.0, 1.0, 1.0, 100.0};
  RowOptions options;
  options.max_rows = 3;
  const std::vector<TrapezoidRow> rows = TrapezoidRows(trapezoid, options);
  ASSERT_EQ(rows.size(), 3u);
  // W = 2, 4; H = W / 4.
  EXPECT_DOUBLE_EQ(rows[0].end, 0.5);
  EXPECT_DOUBLE_EQ(rows[1].end, 1.5);
  EXPECT_DOUBLE_EQ(rows[2].end, 100.0);
  EXPECT_DOUBLE_EQ(rows[2].width, 201.0);
  EXPECT_EQ(rows[0].num_columns, 2);  // W / H = 4, at most 1.5 a column
  EXPECT_EQ(rows[2].num_columns, 2);  // 201 / 98.5
  EXPECT_GT(rows[2].Waste(trapezoid), options.zeta);
}

TEST(TrapezoidRows, OfARectangleAreSquares) {
  const Trapezoid trapezoid = {0.0, 2.0, 0.0, 5.0};
  const std::vector<TrapezoidRow> rows = TrapezoidRows(trapezoid, {});
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_DOUBLE_EQ(rows[0].end, 2.0);
  EXPECT_DOUBLE_EQ(rows[1].end, 4.0);
  EXPECT_DOUBLE_EQ(rows[2].end, 5.0);
  EXPECT_EQ(NumCells(rows), 3);
}

TEST(ValidateRowOptions, SaysWhatIsWrong) {
  RowOptions options;
  EXPECT_THAT(ValidateRowOptions(options), IsOk());
  for (const double zeta : {0.0, 0.5, -1.0, std::nan("")}) {
    options.zeta = zeta;
    EXPECT_THAT(ValidateRowOptions(options),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("zeta = ")));
  }
  options = {};
  options.sigma = 0.0;
  EXPECT_THAT(ValidateRowOptions(options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("sigma = 0")));
  options = {};
  options.max_rows = 0;
  EXPECT_THAT(ValidateRowOptions(options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("max_rows = 0")));
  options = {};
  options.max_columns = 9;
  EXPECT_THAT(ValidateRowOptions(options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("max_columns = 9")));
}

}  // namespace
}  // namespace lightfit
