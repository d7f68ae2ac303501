#include "cli/flags/size_flags.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>
#include <limits>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"

namespace lightfit::cli {
namespace {

constexpr const char* kSizeFlags[] = {"--multiple", "--power-of-two", "--min-side", "--max-side"};
constexpr char kTimesSign[] = "\u00d7";

// "1024", or in thousands as sizes of textures are counted: "2k" is 2048.
std::optional<int> ParseSide(absl::string_view text) {
  constexpr int kThousand = 1024;
  const bool is_thousands = absl::ConsumeSuffix(&text, "k");
  int side = 0;
  if (text.empty() || !absl::ascii_isdigit(text.back()) || !absl::SimpleAtoi(text, &side)) {
    return std::nullopt;
  }
  if (!is_thousands) return side;
  if (side > std::numeric_limits<int>::max() / kThousand) return std::nullopt;
  return kThousand * side;
}

}  // namespace

void DeclareSizeFlags(CLI::App* app, const std::string& group, MapSizeRules* rules) {
  CLI::Option* multiple =
      app->add_option("--multiple", rules->multiple, "Sides are multiples of this [64]")
          ->type_name("TEXELS")
          ->group(group);
  app->add_flag("--power-of-two", rules->powers_of_two, "Sides are powers of two")
      ->excludes(multiple)
      ->group(group);
  app->add_option("--min-side", rules->min_side, "No side is shorter [64]")
      ->type_name("TEXELS")
      ->group(group);
  app->add_option("--max-side", rules->max_side, "No side is longer [16384]")
      ->type_name("TEXELS")
      ->group(group);
}

bool HasSizeFlags(const CLI::App& app) {
  return std::any_of(std::begin(kSizeFlags), std::end(kSizeFlags), [&](const char* flag) {
    return app.count(flag) > 0;
  });
}

std::optional<std::pair<int, int>> ParseSides(const std::string& text) {
  const std::string plain = absl::StrReplaceAll(absl::AsciiStrToLower(text), {{kTimesSign, "x"}});
  const std::vector<std::string> sides = absl::StrSplit(plain, 'x');
  if (sides.size() != 2) return std::nullopt;
  const std::optional<int> width = ParseSide(sides[0]), height = ParseSide(sides[1]);
  if (!width.has_value() || !height.has_value()) return std::nullopt;
  return std::make_pair(*width, *height);
}

absl::StatusOr<MapSize> ParseMapSize(const std::string& text) {
  std::optional<std::pair<int, int>> sides = ParseSides(text);
  if (const std::optional<int> side = ParseSide(absl::AsciiStrToLower(text)); side.has_value()) {
    sides = {*side, *side};
  }
  if (!sides.has_value()) {
    return absl::InvalidArgumentError(absl::StrCat("\"",
                                                   text,
                                                   "\" is no size, want WIDTHxHEIGHT in texels "
                                                   "such as 1024x512, or 1024 for 1024x1024"));
  }
  const MapSize map = {sides->first, sides->second};
  if (std::min(map.width, map.height) < 1 || std::max(map.width, map.height) > kMaxMapSide) {
    return absl::InvalidArgumentError(
        absl::StrCat(text, ": want 1 to ", kMaxMapSide, " texels along each side"));
  }
  return map;
}

absl::StatusOr<int64_t> ParseTexels(const std::string& text) {
  int64_t texels = 0;
  if (absl::SimpleAtoi(text, &texels)) {
    if (texels >= 1) return texels;
    return absl::InvalidArgumentError(absl::StrCat(text, ": want at least 1 texel"));
  }
  if (!ParseSides(text).has_value()) {
    return absl::InvalidArgumentError(absl::StrCat("\"",
                                                   text,
                                                   "\" is no size, want WIDTHxHEIGHT in texels "
                                                   "such as 4096x4096, or a number of texels such "
                                                   "as 16777216"));
  }
  const absl::StatusOr<MapSize> size = ParseMapSize(text);
  if (!size.ok()) return size.status();
  return TexelsOf(*size);
}

}  // namespace lightfit::cli
