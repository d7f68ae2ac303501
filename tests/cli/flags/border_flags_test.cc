// Who looks at a result's border chooses it; who may not, gets a lit one.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <string>
#include <utility>

#include "cli/flags/allocate_flags.h"
#include "cli/flags/compare_flags.h"
#include "cli/flags/fit_flags.h"
#include "cli/flags/fit_inputs.h"
#include "cli/flags/shot_flags.h"

namespace lightfit::cli {
namespace {

using ::testing::HasSubstr;

// The options of a fit as these words have them, or the message of what is wrong with them.
template <typename Flags>
std::pair<FitFlags, std::string> Parsed(void (*declare)(CLI::App*, Flags*),
                                        FitFlags Flags::*fit,
                                        std::string words) {
  CLI::App app("", "test");
  Flags flags;
  declare(&app, &flags);
  try {
    app.parse(std::move(words));
  } catch (const CLI::ParseError& error) {
    return {flags.*fit, error.what()};
  }
  return {flags.*fit, ""};
}

struct Whole {
  FitFlags flags;
};

void DeclareWhole(CLI::App* app, Whole* whole) { DeclareFitFlags(app, &whole->flags); }

std::pair<FitFlags, std::string> ParsedFit(const std::string& words) {
  return Parsed(&DeclareWhole, &Whole::flags, "a.exr --lights a.json " + words);
}

TEST(BorderFlag, FitShotAndCompareChooseByThemselves) {
  EXPECT_EQ(ParsedFit("").first.options.border, BorderChoice::kAutomatic);
  EXPECT_EQ(Parsed(&DeclareCompareFlags, &CompareFlags::fit, "a.exr").first.options.border,
            BorderChoice::kAutomatic);
  EXPECT_EQ(Parsed(&DeclareShotFlags, &ShotFlags::fit, "a.exr").first.options.border,
            BorderChoice::kAutomatic);
  EXPECT_EQ(FitOptions().border, BorderChoice::kLit);
}

TEST(BorderFlag, OtherVerbsStayAtLit) {
  EXPECT_EQ(Parsed(&DeclareAllocateFlags, &AllocateFlags::fit, "a.exr").first.options.border,
            BorderChoice::kLit);
}

TEST(BorderFlag, TakesItsWordsAndNamesThemForOthers) {
  for (const auto& [word, border] : {std::pair("lit", BorderChoice::kLit),
                                     std::pair("dark", BorderChoice::kDark),
                                     std::pair("auto", BorderChoice::kAutomatic)}) {
    const auto [flags, message] = ParsedFit(std::string("--border ") + word);
    EXPECT_EQ(message, "");
    EXPECT_EQ(flags.options.border, border);
    EXPECT_TRUE(flags.has_border);
    EXPECT_EQ(Parsed(&DeclareShotFlags, &ShotFlags::fit, std::string("a.exr --border ") + word)
                  .first.options.border,
              border);
  }
  EXPECT_THAT(ParsedFit("--border drak").second, HasSubstr("want lit, dark, auto"));
  EXPECT_FALSE(ParsedFit("").first.has_border);
}

TEST(BorderFlag, ThePublishedAlgorithmHasALitOne) {
  EXPECT_THAT(ParsedFit("--as-published --border dark").second, HasSubstr("--border"));
  EXPECT_EQ(FitOptions::AsPublished().border, BorderChoice::kLit);
}

TEST(ChannelFlags, NameTheOptionalChannels) {
  const ReadbackExrOptions defaults = ReadbackOptionsOf(ParsedFit("").first);
  EXPECT_EQ(defaults.facing_channel_format, "facing.{light}");
  EXPECT_EQ(defaults.mapped_channel_format, "mapped.{light}");
  const ReadbackExrOptions options = ReadbackOptionsOf(
      ParsedFit("--facing-channel {light}.lambert --mapped-channel {light}.map").first);
  EXPECT_EQ(options.facing_channel_format, "{light}.lambert");
  EXPECT_EQ(options.mapped_channel_format, "{light}.map");
}

}  // namespace
}  // namespace lightfit::cli
