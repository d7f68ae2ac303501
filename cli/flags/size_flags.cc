#include "cli/flags/size_flags.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace lightfit::cli {
namespace {

constexpr const char* kSizeFlags[] = {"--multiple", "--power-of-two", "--min-side", "--max-side"};

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

absl::StatusOr<MapSize> ParseMapSize(const std::string& text) {
  const std::vector<std::string> sides = absl::StrSplit(text, 'x');
  MapSize map;
  if (sides.size() != 2 || !absl::SimpleAtoi(sides[0], &map.width) ||
      !absl::SimpleAtoi(sides[1], &map.height)) {
    return absl::InvalidArgumentError(
        absl::StrCat("\"", text, "\" is no size, want WIDTHxHEIGHT in texels such as 1024x1024"));
  }
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
  const absl::StatusOr<MapSize> size = ParseMapSize(text);
  if (size.ok()) return TexelsOf(*size);
  return absl::InvalidArgumentError(
      absl::StrCat(size.status().message(), ", or a number of texels such as 16777216"));
}

}  // namespace lightfit::cli
