#include "optimizer/sizing/map_sizes.h"

#include <algorithm>
#include <tuple>

#include "absl/strings/str_format.h"
#include "geometry/map_size.h"

namespace lightfit {

namespace {

constexpr int kSteps = 64;  // steps to the doubling of a side, and multiples that are all there

int64_t RoundedUp(int64_t value, int64_t multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

}  // namespace

absl::Status ValidateMapSizeRules(const MapSizeRules& rules,
                                  double margin_texels,
                                  absl::string_view field) {
  if (rules.multiple < 1) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s.multiple = %d texels, want 1 or more", field, rules.multiple));
  }
  if (rules.min_side < 1 || rules.max_side > kMaxMapSide || rules.min_side > rules.max_side) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s.min_side, max_side = %d, %d texels, want 1 <= min_side <= max_side "
                        "<= %d",
                        field,
                        rules.min_side,
                        rules.max_side,
                        kMaxMapSide));
  }
  const std::vector<int> sides = AllowedSides(rules);
  if (sides.empty()) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s: no %s lies in min_side ... max_side = %d ... %d texels; widen the limits",
        field,
        rules.powers_of_two ? "power of two" : absl::StrFormat("multiple of %d", rules.multiple),
        rules.min_side,
        rules.max_side));
  }
  if (sides.front() <= 2.0 * margin_texels) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s.min_side = %d texels, want more than twice options.margin_texels "
                        "= %g",
                        field,
                        rules.min_side,
                        margin_texels));
  }
  return absl::OkStatus();
}

std::vector<int> AllowedSides(const MapSizeRules& rules) {
  std::vector<int> sides;
  if (rules.powers_of_two) {
    for (int64_t side = 1; side <= rules.max_side; side *= 2) {
      if (side >= rules.min_side) sides.push_back(static_cast<int>(side));
    }
    return sides;
  }
  const int64_t multiple = rules.multiple;
  int64_t side = RoundedUp(rules.min_side, multiple);
  const int64_t longest = rules.max_side / multiple * multiple;
  while (side < longest) {
    sides.push_back(static_cast<int>(side));
    side += std::max(multiple, side / (multiple * kSteps) * multiple);
  }
  if (RoundedUp(rules.min_side, multiple) <= longest) sides.push_back(static_cast<int>(longest));
  return sides;
}

bool KeepsRules(MapSize map, const MapSizeRules& rules) {
  for (const int side : {map.width, map.height}) {
    if (side < rules.min_side || side > rules.max_side) return false;
    if (rules.powers_of_two ? (side & (side - 1)) != 0 : side % rules.multiple != 0) return false;
  }
  return true;
}

std::vector<RatedSize> WorthwhileSizes(std::vector<RatedSize> sizes) {
  std::sort(sizes.begin(), sizes.end(), [](const RatedSize& a, const RatedSize& b) {
    return std::tie(a.texels, a.cost, a.map.width) < std::tie(b.texels, b.cost, b.map.width);
  });
  std::vector<RatedSize> worthwhile;
  for (const RatedSize& size : sizes) {
    if (worthwhile.empty() || size.cost < worthwhile.back().cost) worthwhile.push_back(size);
  }
  return worthwhile;
}

}  // namespace lightfit
