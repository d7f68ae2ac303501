#include "cli/flags/number_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace lightfit::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// What is said of the word; empty where it is taken.
std::string Answer(const CLI::Validator& check, std::string word) { return check(word); }

TEST(NumberChecks, TakeTheirEndsAndNothingBeyond) {
  const CLI::Validator share = NumberIn(0.0, 1.0);
  for (const char* good : {"0", "1", "0.5", "1e-3", "-0", ".25"}) {
    EXPECT_THAT(Answer(share, good), IsEmpty()) << good;
  }
  for (const char* bad : {"-1e-9", "1.0000001", "inf", "-inf", "1e999"}) {
    EXPECT_THAT(Answer(share, bad), HasSubstr("want a number from 0 to 1")) << bad;
  }
  EXPECT_THAT(Answer(NumberIn(0.0, kInfinity), "inf"), IsEmpty());
  EXPECT_THAT(Answer(NumberIn(0.0, kInfinity), "-1"), HasSubstr("from 0 on"));
  EXPECT_THAT(Answer(NumberAboveZero(), "1e-300"), IsEmpty());
  for (const char* bad : {"0", "-1", "inf"}) {
    EXPECT_THAT(Answer(NumberAboveZero(), bad), HasSubstr("want a number above 0")) << bad;
  }
  EXPECT_THAT(Answer(NumberAboveZeroOrInfinite(), "inf"), IsEmpty());
  EXPECT_THAT(Answer(NumberAboveZeroOrInfinite(), "0"), HasSubstr("above 0, or inf"));
}

TEST(NumberChecks, TakeNothingThatIsNoNumber) {
  for (const CLI::Validator& check : {NumberIn(0.0, 1.0),
                                      NumberIn(0.0, kInfinity),
                                      NumberAboveZero(),
                                      NumberAboveZeroOrInfinite()}) {
    for (const std::string bad : {"nan", "NaN", "-nan", "nan(1)", "", "many", "0.5x"}) {
      EXPECT_THAT(Answer(check, bad), HasSubstr("\"" + bad + "\", want a number"));
    }
  }
}

}  // namespace
}  // namespace lightfit::cli
