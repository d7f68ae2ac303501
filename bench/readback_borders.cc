#include "bench/readback_borders.h"

#include <vector>

#include "absl/strings/str_format.h"
#include "bench/inputs.h"
#include "optimizer/evaluate.h"
#include "optimizer/figures/foretell.h"
#include "optimizer/fit.h"

namespace lightfit {
namespace {

// Empty for a lamp among what it lights.
std::string LineOf(const Input& input, const Light& light, MapSize map) {
  FitOptions dark;
  dark.border = BorderChoice::kDark;
  Readback bits_alone = input.View();
  bits_alone.facing_bits = {};
  const absl::StatusOr<LightMatrix> before = FitLight(bits_alone, light, map);
  const absl::StatusOr<LightMatrix> after = FitLight(input.View(), light, map, dark);
  if (!before.ok() || !after.ok()) return "";
  const absl::StatusOr<Figures> figures_before =
      EvaluateMatrix(input.View(), light, before->map_from_world, map, dark);
  const absl::StatusOr<Figures> figures_after =
      EvaluateMatrix(input.View(), light, after->map_from_world, map, dark);
  const absl::StatusOr<double> share_before =
      ForetellWrongShare(input.View(), light, before->map_from_world, map);
  if (!figures_before.ok() || !figures_after.ok() || !share_before.ok()) return "";
  return absl::StrFormat("%-24s %-6s %10.3f %10.3f %12.3f %10.3f\n",
                         input.name,
                         light.name,
                         figures_after->energy / figures_before->energy,
                         after->figures.energy / before->figures.energy,
                         100.0 * figures_after->wrong_share.value_or(0.0),
                         100.0 * *share_before);
}

}  // namespace

absl::StatusOr<std::string> ReadbackBordersText(const std::string& folder, MapSize map) {
  if (!HasReadbacks(folder)) {
    return absl::StrFormat("\nread-backs left out: there is no folder %s\n", folder);
  }
  constexpr int kFirstFrameOnly = 1000;
  const absl::StatusOr<std::vector<Input>> inputs = ReadInputs(folder, kFirstFrameOnly);
  if (!inputs.ok()) return inputs.status();
  std::string text = absl::StrFormat("\n%-31s %10s %10s %12s %10s\n",
                                     "dark border over bits alone",
                                     "same edges",
                                     "own edges",
                                     "foretold, %",
                                     "before, %");
  for (const Input& input : *inputs) {
    for (const Light& light : input.lights) {
      if (input.View().KnowsFacing(light.shadow_bit)) text += LineOf(input, light, map);
    }
  }
  return text;
}

}  // namespace lightfit
