#include "jobs/shot/totals.h"

#include <cmath>

namespace lightfit {
namespace {

class Mean {
 public:
  void Add(double value) {
    sum_ += value;
    ++count_;
  }
  std::optional<double> Value() const {
    if (count_ == 0) return std::nullopt;
    return sum_ / count_;
  }

 private:
  double sum_ = 0.0;
  int count_ = 0;
};

}  // namespace

std::optional<double> EnergyRatio(const ShotRows& rows, const ShotRow& row) {
  const auto& frame = rows[static_cast<size_t>(ShotMode::kPerFrame)][row.frame];
  if (row.light >= frame.size()) return std::nullopt;
  const ShotRow& best = frame[row.light];
  if (!row.error.empty() || !best.error.empty()) return std::nullopt;
  if (row.border != best.border) return std::nullopt;  // other edges
  if (!(row.energy > 0.0) || !(best.energy > 0.0)) return std::nullopt;
  return row.energy / best.energy;
}

ShotTotals TotalsOf(const ShotRows& rows, ShotMode mode, std::optional<size_t> light) {
  ShotTotals totals;
  Mean log_ratio, drift, edge_crawl, wrong;
  for (const std::vector<ShotRow>& frame : rows[static_cast<size_t>(mode)]) {
    for (const ShotRow& row : frame) {
      if (light.has_value() && row.light != *light) continue;
      if (!row.error.empty()) {
        ++totals.num_failed;
        continue;
      }
      ++totals.num_frames;
      totals.num_updates += row.num_moved > 0 ? 1 : 0;
      totals.num_maps += row.num_maps;
      totals.num_moved += row.num_moved;
      wrong.Add(row.wrong_share);
      if (const std::optional<double> ratio = EnergyRatio(rows, row)) {
        log_ratio.Add(std::log(*ratio));
      }
      if (!row.crawl.has_value()) continue;
      if (row.crawl->num_points > 0) drift.Add(row.crawl->phase_drift_texels);
      if (row.crawl->num_edge_points > 0) edge_crawl.Add(row.crawl->edge_crawl_px);
    }
  }
  if (log_ratio.Value()) totals.energy_ratio = std::exp(*log_ratio.Value());
  totals.phase_drift_texels = drift.Value();
  totals.edge_crawl_px = edge_crawl.Value();
  totals.wrong_share = wrong.Value();
  return totals;
}

}  // namespace lightfit
