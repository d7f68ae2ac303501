// bench/allocation.cc : what it buys to split a budget of texels by the summaries of the lights.
//
// In:   read-backs of a renderer (../shared/readbacks, or --readbacks), each with several lights; a
//       few budgets of texels.
// Out:  per frame and budget the sum of energies over the lights (the default metric: footprints
//       across shadow edges, to first order twice the wrong pixels), relative to an equal split
//       into square maps:
//         by hand    the largest equal power-of-two squares that fit the budget
//         hand 2:1   ... and the first sun's map doubled in width where the budget still allows
//         ideal      ours, before rounding
//         64, pow2   ours in multiples of 64 and in powers of two
//       and the texels that each spends, as a share of the budget. Below 1 is better.
//
// Every energy is that of a fit of its own to the read-back at that size. A light without a matrix
// at any size is left out for all.
#include "optimizer/sizing/allocation.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/number.h"
#include "base/table.h"
#include "bench/inputs.h"
#include "optimizer/fit.h"
#include "optimizer/sizing/map_shapes.h"

namespace lightfit {
namespace {

// The sum of energies, and what it took.
struct Split {
  double energy = 0.0;
  int64_t texels = 0;
};

absl::StatusOr<Split> FitAll(const Input& input,
                             const std::vector<AllocationLight>& lights,
                             const std::vector<MapSize>& maps) {
  Split split;
  for (size_t i = 0; i < lights.size(); ++i) {
    const absl::StatusOr<LightMatrix> fit = FitLight(input.View(), lights[i].light, maps[i]);
    if (!fit.ok()) return fit.status();
    split.energy += lights[i].weight * fit->figures.energy;
    split.texels += TexelsOf(maps[i]);
  }
  return split;
}

std::vector<MapSize> EqualSquares(size_t num_lights, double budget_texels) {
  const int side = static_cast<int>(std::sqrt(budget_texels / static_cast<double>(num_lights)));
  return std::vector<MapSize>(num_lights, {side, side});
}

std::vector<MapSize> PowersByHand(size_t num_lights, double budget_texels) {
  int side = 1;
  while (4.0 * side * side * static_cast<double>(num_lights) <= budget_texels) side *= 2;
  return std::vector<MapSize>(num_lights, {side, side});
}

// The first sun's map doubled, if there is room.
std::vector<MapSize> SunTwiceAsWide(const std::vector<AllocationLight>& lights,
                                    std::vector<MapSize> maps,
                                    double budget_texels) {
  double texels = 0.0;
  for (const MapSize& map : maps) texels += static_cast<double>(TexelsOf(map));
  for (size_t i = 0; i < lights.size(); ++i) {
    if (lights[i].light.kind != Light::Kind::kDirectional) continue;
    if (texels + static_cast<double>(TexelsOf(maps[i])) <= budget_texels) maps[i].width *= 2;
    break;
  }
  return maps;
}

absl::StatusOr<Split> Allocated(const Input& input,
                                const std::vector<AllocationLight>& lights,
                                int64_t budget_texels,
                                const MapSizeRules& rules,
                                double* ideal_energy) {
  const absl::StatusOr<Allocation> allocation = AllocateBudget(lights, budget_texels, rules);
  if (!allocation.ok()) return allocation.status();
  *ideal_energy = allocation->ideal_energy;
  std::vector<MapSize> maps;
  for (const AllocatedMap& map : allocation->maps) {
    if (!map.matrix.ok()) return map.matrix.status();
    maps.push_back(map.matrix->map);
  }
  return FitAll(input, lights, maps);
}

// Columns of the table, and the logarithms of their ratios for the geometric means.
class Ratios {
 public:
  Ratios() {
    table_.AddColumn("", "frame");
    table_.AddColumn("", "lights");
    table_.AddColumn("", "budget");
    for (const char* name : kNames) table_.AddColumn("energy / equal squares", name);
    for (const char* name : {"equal", "by hand", "hand 2:1", "64", "pow2"}) {
      table_.AddColumn("texels spent, %", name);
    }
  }

  void Add(std::vector<std::string> cells, const std::vector<double>& ratios) {
    for (size_t i = 0; i < ratios.size(); ++i) {
      cells.insert(cells.begin() + 3 + static_cast<int>(i), FigureText(ratios[i]));
      log_sums_[i] += std::log(ratios[i]);
      worst_[i] = std::max(worst_[i], ratios[i]);
    }
    ++count_;
    table_.AddRow(cells);
  }

  void Print() {
    std::vector<std::string> means = {"geometric mean", "", ""}, worst = {"largest", "", ""};
    for (size_t i = 0; i < kNumNames; ++i) {
      means.push_back(FigureText(std::exp(log_sums_[i] / count_)));
      worst.push_back(FigureText(worst_[i]));
    }
    table_.AddRow(means);
    table_.AddRow(worst);
    std::printf("%s", table_.Text().c_str());
  }

 private:
  static constexpr size_t kNumNames = 5;
  static constexpr const char* kNames[kNumNames] = {"by hand", "hand 2:1", "ideal", "64", "pow2"};

  Table table_;
  double log_sums_[kNumNames] = {}, worst_[kNumNames] = {};
  int count_ = 0;
};

std::string ShareText(const Split& split, int64_t budget_texels) {
  return absl::StrCat(static_cast<int>(100 * split.texels / budget_texels));
}

absl::Status AddFrame(const Input& input, Ratios* ratios) {
  std::vector<AllocationLight> lights;
  for (const Light& light : input.lights) {
    absl::StatusOr<Summary> summary = SummarizeForAnyAspect(input.View(), light, FitOptions());
    if (!summary.ok() || !Fit(*summary, light, {1024, 1024}).ok()) continue;
    lights.push_back({light, *std::move(summary), 1.0});
  }
  if (lights.empty()) return absl::OkStatus();
  MapSizeRules powers;
  powers.powers_of_two = true;
  for (const MapSize& budget : {MapSize{1024, 1024}, MapSize{3000, 2000}, MapSize{4096, 4096}}) {
    const int64_t texels = TexelsOf(budget);
    const auto budget_texels = static_cast<double>(texels);
    const std::vector<MapSize> by_hand = PowersByHand(lights.size(), budget_texels);
    double ideal = 0.0;
    const absl::StatusOr<Split> splits[] = {
        FitAll(input, lights, EqualSquares(lights.size(), budget_texels)),
        FitAll(input, lights, by_hand),
        FitAll(input, lights, SunTwiceAsWide(lights, by_hand, budget_texels)),
        Allocated(input, lights, texels, MapSizeRules(), &ideal),
        Allocated(input, lights, texels, powers, &ideal)};
    for (const absl::StatusOr<Split>& split : splits) {
      if (!split.ok()) return split.status();
    }
    std::vector<std::string> cells = {
        input.name, absl::StrCat(lights.size()), absl::StrCat(budget.width, "x", budget.height)};
    for (const absl::StatusOr<Split>& split : splits) cells.push_back(ShareText(*split, texels));
    const double equal = splits[0]->energy;
    ratios->Add(cells,
                {splits[1]->energy / equal,
                 splits[2]->energy / equal,
                 ideal / equal,
                 splits[3]->energy / equal,
                 splits[4]->energy / equal});
  }
  return absl::OkStatus();
}

absl::Status Run(const std::string& folder, int frame_step) {
  const absl::StatusOr<std::vector<Input>> inputs = ReadInputs(folder, frame_step);
  if (!inputs.ok()) return inputs.status();
  if (inputs->empty()) {
    return absl::NotFoundError(absl::StrCat(folder, ": no read-backs; name others: --readbacks"));
  }
  Ratios ratios;
  for (const Input& input : *inputs) {
    if (absl::Status status = AddFrame(input, &ratios); !status.ok()) return status;
  }
  ratios.Print();
  return absl::OkStatus();
}

}  // namespace
}  // namespace lightfit

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): options are ours
  std::string folder = lightfit::DefaultReadbackFolder();
  int frame_step = 1;
  CLI::App app("A budget of texels, split by hand and by the summaries of the lights.");
  app.add_option("--readbacks", folder, "Folder of sets")->capture_default_str();
  app.add_option("--frame-step", frame_step, "Every n-th frame of a set")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const absl::Status status = lightfit::Run(folder, frame_step);
  if (status.ok()) return 0;
  std::fprintf(stderr, "allocation: %s\n", std::string(status.message()).c_str());
  return 1;
}
