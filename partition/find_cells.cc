#include "partition/find_cells.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

#include "base/stop.h"
#include "optimizer/energy/reweighting.h"
#include "partition/divided_maps.h"
#include "partition/split_cell.h"

namespace lightfit {

namespace {

constexpr int kMaxRounds = 12;

// A cell, and what cutting it would give.
struct Leaf {
  Cell cell;
  bool is_looked_at = false;
  std::optional<std::pair<Cell, Cell>> halves;
  double gain = 0.0;  // of the sum of PlanTerm
};

void LookAt(const CellFitter& fitter, Leaf* leaf) {
  if (leaf->is_looked_at) return;
  leaf->is_looked_at = true;
  leaf->halves = SplitCell(fitter, leaf->cell);
  if (!leaf->halves.has_value()) return;
  leaf->gain = PlanTerm(fitter, leaf->cell.map.energy) -
               PlanTerm(fitter, leaf->halves->first.map.energy) -
               PlanTerm(fitter, leaf->halves->second.map.energy);
}

// The bins of each map by what `label` says of them; cells without any are dropped.
template <typename Label>
Cells Relabelled(const CellFitter& fitter, const Cells& cells, const Label& label) {
  Cells moved;
  for (const Cell& cell : cells) moved.push_back({{}, cell.map});
  for (size_t k = 0; k < cells.size(); ++k) {
    for (const int bin : cells[k].bins) {
      const int to = label(fitter.rays().bins[bin]);
      moved[to < 0 ? k : to].bins.push_back(bin);
    }
  }
  Cells kept;
  for (Cell& cell : moved) {
    const bool covers = std::any_of(cell.bins.begin(), cell.bins.end(), [&](int bin) {
      return !fitter.rays().bins[bin].hull.empty();
    });
    if (covers) {
      std::sort(cell.bins.begin(), cell.bins.end());
      kept.push_back(std::move(cell));
    } else if (!cell.bins.empty() && !kept.empty()) {
      // Lit samples that nothing dark is near.
      kept.front().bins.insert(kept.front().bins.end(), cell.bins.begin(), cell.bins.end());
      std::sort(kept.front().bins.begin(), kept.front().bins.end());
    }
  }
  return kept;
}

bool SameBins(const Cells& a, const Cells& b) {
  return a.size() == b.size() &&
         std::equal(a.begin(), a.end(), b.begin(), [](const Cell& x, const Cell& y) {
           return x.bins == y.bins;
         });
}

// Rounds of labels and fits.
template <typename Label>
void Alternate(const CellFitter& fitter,
               Cells cells,
               double texels,
               const Label& label,
               BestOfRounds<Cells>* best) {
  for (int round = 0; round < kMaxRounds; ++round) {
    if (StopRequested()) return;
    const DividedMaps maps(fitter, cells, texels);
    Cells moved = Relabelled(fitter, cells, [&](const RayBin& bin) { return label(maps, bin); });
    if (moved.empty() || SameBins(moved, cells)) return;
    for (Cell& cell : moved) {
      const std::optional<CellMap> map = fitter.Refit(cell.bins, cell.map);
      if (!map.has_value()) return;
      cell.map = *map;
    }
    cells = std::move(moved);
    best->Offer(DividedMaps(fitter, cells, texels).Energy(), cells);
  }
}

}  // namespace

ScratchVector<Cells> GrowCells(const CellFitter& fitter, int max_cells) {
  ScratchVector<Cells> plans;
  Leaf root;
  root.cell.bins.resize(fitter.rays().bins.size());
  std::iota(root.cell.bins.begin(), root.cell.bins.end(), 0);
  const std::optional<CellMap> map = fitter.Fit(root.cell.bins);
  if (!map.has_value()) return plans;
  root.cell.map = *map;
  ScratchVector<Leaf> leaves = {std::move(root)};
  while (true) {
    Cells& plan = plans.emplace_back();
    for (const Leaf& leaf : leaves) plan.push_back(leaf.cell);
    if (static_cast<int>(leaves.size()) >= max_cells || StopRequested()) return plans;
    size_t best = 0;
    for (size_t i = 0; i < leaves.size(); ++i) {
      LookAt(fitter, &leaves[i]);
      if (leaves[i].gain > leaves[best].gain) best = i;
    }
    if (!leaves[best].halves.has_value() || !(leaves[best].gain > 0.0)) return plans;
    std::pair<Cell, Cell> halves = *std::move(leaves[best].halves);
    Leaf first, second;
    first.cell = std::move(halves.first);
    second.cell = std::move(halves.second);
    leaves[best] = std::move(first);
    leaves.push_back(std::move(second));
  }
}

Cells AlternateCells(const CellFitter& fitter, const Cells& cells, double texels) {
  BestOfRounds<Cells> best;
  best.Offer(DividedMaps(fitter, cells, texels).Energy(), cells);
  if (fitter.rays().has_single_cover) {
    // By density alone cells move freely, and may die. All around a lamp that would send every ray
    // to the map that looks the other way.
    Alternate(
        fitter,
        cells,
        texels,
        [](const DividedMaps& maps, const RayBin& bin) {
          return maps.At(bin.middle, /*in_rectangle=*/false);
        },
        &best);
  }
  // To maps that hold all of the bin: the old maps stay possible for the new cells.
  const Cells from = best.Best();
  Alternate(
      fitter,
      from,
      texels,
      [](const DividedMaps& maps, const RayBin& bin) { return maps.At(bin.middle, bin.hull); },
      &best);
  return std::move(best).Best();
}

}  // namespace lightfit
