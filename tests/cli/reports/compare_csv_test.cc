// A comparison as comma-separated values.
#include "cli/reports/compare_csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "absl/strings/str_split.h"
#include "tests/jobs/compare/compared_lights.h"

namespace lightfit::cli {
namespace {

using ::testing::HasSubstr;

// Splits a line at the commas outside quotes.
std::vector<std::string> Fields(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (c == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back().push_back(c);
    }
  }
  return fields;
}

TEST(CompareCsv, HasALineForEachLightAndMethod) {
  const std::string csv = CompareCsv(ThreeLights());
  const std::vector<std::string> lines = absl::StrSplit(csv, '\n');
  ASSERT_EQ(lines.size(), 1u + 6u + 1u);
  const std::vector<std::string> names = Fields(lines[0]);
  for (size_t i = 1; i + 1 < lines.size(); ++i) {
    EXPECT_EQ(Fields(lines[i]).size(), names.size()) << lines[i];
  }
  EXPECT_EQ(lines[1].substr(0, 34), "a,sun,0,-1,0.5,focused,ok,30,40,0,");
  EXPECT_THAT(lines[5], HasSubstr("c,sun,0,-1,0.5,focused,failed,,,,,,,,,,,"));
  EXPECT_THAT(lines[5], HasSubstr("\"no, \"\"never\"\"\""));
}

}  // namespace
}  // namespace lightfit::cli
