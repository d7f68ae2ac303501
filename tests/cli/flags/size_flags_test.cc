#include "cli/flags/size_flags.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <string>

#include "tests/testing/matchers.h"

namespace lightfit::cli {
namespace {

using ::testing::HasSubstr;
using testing::StatusIs;

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

TEST(ParseMapSize, TakesSidesThatAMapMayHave) {
  EXPECT_EQ(ParseMapSize("1024x512")->width, 1024);
  EXPECT_EQ(ParseMapSize("1x65536")->height, 65536);
  EXPECT_EQ(ParseMapSize("1024")->height, 1024);
  EXPECT_EQ(ParseMapSize("4K")->width, 4096);
  EXPECT_EQ(ParseMapSize("2kx1K")->height, 1024);
  EXPECT_EQ(ParseMapSize("8X9")->height, 9);
  for (const std::string bad : {"1024x",
                                "0x64",
                                "64x-1",
                                "65537x64",
                                "64x64x64",
                                "axb",
                                "",
                                "k",
                                "0",
                                "-4",
                                "65537",
                                "9999999k",
                                "1.5k",
                                "1 024",
                                "x",
                                "4kk"}) {
    EXPECT_THAT(ParseMapSize(bad), StatusIs(kInvalid, HasSubstr(bad)));
  }
}

TEST(ParseTexels, TakesANumberOrASize) {
  EXPECT_EQ(*ParseTexels("4096x4096"), 16777216);
  EXPECT_EQ(*ParseTexels("65536x65536"), int64_t{1} << 32);
  EXPECT_EQ(*ParseTexels("5000000000"), 5000000000);
  for (const std::string bad : {"0", "-4", "many", "10x", "65537x1", "4k", "1e6"}) {
    EXPECT_THAT(ParseTexels(bad), StatusIs(kInvalid, HasSubstr(bad)));
  }
}

TEST(SizeFlags, KnowsWhetherAnyWasGiven) {
  for (const std::string words : {"", "--multiple 8", "--power-of-two", "--max-side 512"}) {
    CLI::App app;
    MapSizeRules rules;
    DeclareSizeFlags(&app, "Sizes", &rules);
    app.parse(words);
    EXPECT_EQ(HasSizeFlags(app), !words.empty()) << words;
  }
}

}  // namespace
}  // namespace lightfit::cli
