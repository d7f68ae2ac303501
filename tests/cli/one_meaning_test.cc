// The same map of the same light has the same figures, whichever command prints them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "absl/strings/str_split.h"
#include "base/number.h"
#include "lightfit/v1/comparison.pb.h"
#include "tests/cli/examples.h"
#include "tests/testing/process.h"
#include "wire/proto_json.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;

// The cells of the first row of a light in what `lightfit fit` prints: name, three shares of wrong
// pixels, two ratios, rms of the focused and the final map, 99 % of both, time.
std::vector<std::string> RowOf(const std::string& light, const std::string& table) {
  for (const absl::string_view line : absl::StrSplit(table, '\n')) {
    const std::vector<std::string> cells = absl::StrSplit(line, ' ', absl::SkipEmpty());
    if (cells.size() == 11 && cells[0] == light) return cells;
  }
  return {};
}

TEST(OneMeaning, OfTheFocusedMapsFootprintInFitAndCompare) {
  const TemporaryFolder folder;
  const std::vector<std::string> fit = {"fit", kYard, "--lights", kYardLights, "--legend"};
  const auto run = [&](std::vector<std::string> more) {
    more.insert(more.begin(), fit.begin(), fit.end());
    const ProcessResult result = RunLightfit(more);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out;
  };
  const std::string by_default = run({}), as_published = run({"--as-published"});
  EXPECT_THAT(by_default, HasSubstr("pixels that a fit takes by default"));
  run({"--search",
       "focused",
       "--affine",
       "rectangle",
       "--cover",
       "receivers",
       "--json",
       folder.Path("focused.json")});

  const ProcessResult compare = RunLightfit({"compare",
                                             kYard,
                                             "--lights",
                                             kYardLights,
                                             "--legend",
                                             "--map",
                                             "1024x1024",
                                             "--matrix",
                                             "mine=" + folder.Path("focused.json"),
                                             "--json",
                                             folder.Path("compare.json")});
  ASSERT_EQ(compare.exit_code, 0) << compare.err;
  EXPECT_THAT(compare.out, HasSubstr("pixels that a fit takes by default"));
  v1::Comparison comparison;
  const absl::Status status = JsonToProto(ReadFile(folder.Path("compare.json")), comparison);
  ASSERT_TRUE(status.ok()) << status;
  int num_compared = 0;
  for (const v1::LightComparison& light : comparison.lights()) {
    const std::vector<std::string> first = RowOf(light.light().name(), by_default);
    const std::vector<std::string> second = RowOf(light.light().name(), as_published);
    ASSERT_EQ(first.size(), 11u) << by_default;
    ASSERT_EQ(second.size(), 11u) << as_published;
    EXPECT_EQ(first[6], second[6]);  // rms
    EXPECT_EQ(first[8], second[8]);  // 99 %
    EXPECT_EQ(first[1], second[1]);  // wrong pixels
    for (const v1::MethodComparison& method : light.methods()) {
      if (method.method() != "mine") continue;
      EXPECT_EQ(FigureText(method.footprint().rms()), first[6]);
      EXPECT_EQ(FigureText(method.footprint().p99()), first[8]);
      ++num_compared;
    }
  }
  EXPECT_EQ(num_compared, 3);
}

}  // namespace
}  // namespace lightfit
