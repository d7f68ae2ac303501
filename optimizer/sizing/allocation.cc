#include "optimizer/sizing/allocation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "absl/strings/str_format.h"
#include "base/stop.h"
#include "geometry/map_size.h"
#include "optimizer/fit.h"
#include "optimizer/sizing/map_shapes.h"

namespace lightfit {

namespace {

// The cheapest way found to spend about so many texels on the first lights.
struct Spending {
  double cost = std::numeric_limits<double>::infinity();
  int64_t texels = 0;
  size_t choice = 0;    // of the last of these lights
  size_t previous = 0;  // cell of the lights before it
};

absl::Status Validate(absl::Span<const AllocationLight> lights,
                      int64_t budget_texels,
                      const MapSizeRules& rules,
                      const FitOptions& options) {
  if (absl::Status status = ValidateFitOptions(options); !status.ok()) return status;
  absl::Status status = ValidateMapSizeRules(rules, options.margin_texels);
  if (!status.ok()) return status;
  if (budget_texels < 1) {
    return absl::InvalidArgumentError(
        absl::StrFormat("budget_texels = %d, want at least 1 texel", budget_texels));
  }
  for (const AllocationLight& light : lights) {
    if (!(light.weight > 0.0) || !std::isfinite(light.weight)) {
      return absl::InvalidArgumentError(
          absl::StrFormat("light \"%s\": weight = %g, want a number above 0; to give it no texels, "
                          "leave the light out",
                          light.light.name,
                          light.weight));
    }
  }
  return absl::OkStatus();
}

}  // namespace

std::vector<double> SplitTexels(absl::Span<const double> factors,
                                double exponent,
                                double budget_texels,
                                const TexelLimits& limits) {
  // S_l = clamp(scale * share_l): the sum grows with the scale, which is found by bisection.
  std::vector<double> shares;
  for (const double factor : factors) shares.push_back(std::pow(factor, 1.0 / (1.0 + exponent)));
  const double largest = shares.empty() ? 1.0 : *std::max_element(shares.begin(), shares.end());
  const double smallest = shares.empty() ? 1.0 : *std::min_element(shares.begin(), shares.end());
  const auto split = [&](double scale) {
    std::vector<double> texels;
    texels.reserve(shares.size());
    for (const double share : shares) {
      texels.push_back(std::clamp(scale * share, limits.least, limits.most));
    }
    return texels;
  };
  double low = std::log(limits.least / largest), high = std::log(limits.most / smallest);
  constexpr int kHalvings = 100;  // to rounding
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    const std::vector<double> texels = split(std::exp(middle));
    const bool fits = std::accumulate(texels.begin(), texels.end(), 0.0) <= budget_texels;
    (fits ? low : high) = middle;
  }
  return split(std::exp(low));
}

std::vector<size_t> ChooseSizes(absl::Span<const std::vector<RatedSize>> sizes,
                                int64_t budget_texels) {
  constexpr int64_t kMaxCells = 8192;
  const int64_t cell_texels = (budget_texels + kMaxCells - 1) / kMaxCells;
  const auto num_cells = static_cast<size_t>(budget_texels / cell_texels + 1);
  std::vector<size_t> chosen(sizes.size());
  std::vector<std::vector<Spending>> after = {std::vector<Spending>(num_cells)};
  after[0][0].cost = 0.0;
  for (size_t light = 0; light < sizes.size(); ++light) {
    after.emplace_back(num_cells);
    for (size_t cell = 0; cell < num_cells; ++cell) {
      if (StopRequested()) return chosen;
      const Spending& before = after[light][cell];
      if (std::isinf(before.cost)) continue;
      for (size_t choice = 0; choice < sizes[light].size(); ++choice) {
        const int64_t texels = before.texels + sizes[light][choice].texels;
        if (texels > budget_texels) break;
        const double cost = before.cost + sizes[light][choice].cost;
        Spending& best = after[light + 1][static_cast<size_t>(texels / cell_texels)];
        if (cost < best.cost) best = {cost, texels, choice, cell};
      }
    }
  }
  const auto cheapest = std::min_element(
      after.back().begin(), after.back().end(), [](const Spending& a, const Spending& b) {
        return a.cost < b.cost;
      });
  auto cell = static_cast<size_t>(cheapest - after.back().begin());
  for (size_t light = sizes.size(); light > 0; --light) {
    chosen[light - 1] = after[light][cell].choice;
    cell = after[light][cell].previous;
  }
  return chosen;
}

absl::StatusOr<Allocation> AllocateBudget(absl::Span<const AllocationLight> lights,
                                          int64_t budget_texels,
                                          const MapSizeRules& rules,
                                          const FitOptions& options) {
  if (absl::Status status = Validate(lights, budget_texels, rules, options); !status.ok()) {
    return status;
  }
  constexpr char kSubject[] = "allocation";
  Allocation allocation;
  allocation.maps.resize(lights.size());
  std::vector<size_t> fitted;  // the lights that take part
  std::vector<double> factors;
  std::vector<std::vector<RatedSize>> sizes;
  double exponent = 1.0;
  int64_t least_texels = 0;
  for (size_t i = 0; i < lights.size(); ++i) {
    const AllocationLight& light = lights[i];
    const absl::StatusOr<MapShapes> shapes =
        light.summary.ok() ? FindMapShapes(*light.summary, light.light, options)
                           : light.summary.status();
    if (!shapes.ok()) {
      allocation.maps[i].matrix = shapes.status();
      continue;
    }
    fitted.push_back(i);
    exponent = shapes->Exponent();
    factors.push_back(light.weight * shapes->UnitEnergy());
    sizes.push_back(RateSizes(*shapes, light.weight, rules));
    least_texels += sizes.back().front().texels;
  }
  if (absl::Status status = CheckStop(kSubject); !status.ok()) return status;
  if (fitted.empty()) return allocation;
  if (budget_texels < least_texels) {
    const int side = AllowedSides(rules).front();
    return absl::InvalidArgumentError(
        absl::StrFormat("budget_texels = %d, want at least %d: %d maps of %dx%d, the smallest that "
                        "rules.min_side = %d allows",
                        budget_texels,
                        least_texels,
                        fitted.size(),
                        side,
                        side,
                        rules.min_side));
  }

  const double least_side = AllowedSides(rules).front(), most_side = AllowedSides(rules).back();
  const std::vector<double> ideal = SplitTexels(factors,
                                                exponent,
                                                static_cast<double>(budget_texels),
                                                {least_side * least_side, most_side * most_side});
  const std::vector<size_t> chosen = ChooseSizes(sizes, budget_texels);
  for (size_t n = 0; n < fitted.size(); ++n) {
    const AllocationLight& light = lights[fitted[n]];
    AllocatedMap& map = allocation.maps[fitted[n]];
    const RatedSize& size = sizes[n][chosen[n]];
    map.ideal_texels = ideal[n];
    map.ideal_energy = factors[n] / light.weight * std::pow(ideal[n], -exponent);
    map.matrix = Fit(*light.summary, light.light, size.map, options);
    if (!map.matrix.ok()) continue;
    allocation.texels += size.texels;
    allocation.energy += light.weight * map.matrix->figures.energy;
    allocation.ideal_energy += light.weight * map.ideal_energy;
  }
  if (absl::Status status = CheckStop(kSubject); !status.ok()) return status;
  return allocation;
}

}  // namespace lightfit
