#include "jobs/compare/totals.h"

#include <cmath>

namespace lightfit {
namespace {

// Sums of one kind of wrong pixels.
class PixelSum {
 public:
  void Add(int64_t wrong, int64_t lightfit_wrong) {
    ++num_lights_;
    pixels_.total += wrong;
    pixels_.lightfit_total += lightfit_wrong;
    log_ratio_ +=
        std::log(static_cast<double>(wrong + 1) / static_cast<double>(lightfit_wrong + 1));
    if (wrong < lightfit_wrong) ++pixels_.num_wins;
  }

  std::optional<MethodTotals::Pixels> Result() const {
    if (num_lights_ == 0) return std::nullopt;
    MethodTotals::Pixels pixels = pixels_;
    pixels.ratio =
        RatioOf(static_cast<double>(pixels.total), static_cast<double>(pixels.lightfit_total));
    pixels.mean_ratio = std::exp(log_ratio_ / num_lights_);
    return pixels;
  }

 private:
  MethodTotals::Pixels pixels_;
  double log_ratio_ = 0.0;
  int num_lights_ = 0;
};

MethodTotals TotalsOfRow(absl::Span<const LightComparison> lights, size_t index) {
  MethodTotals totals;
  totals.name = lights.front().rows[index].name;
  PixelSum ideal, practical;
  double log_energy_ratio = 0.0;
  std::vector<MapCrawl> crawls;
  int64_t num_maps = 0, num_texels = 0;
  for (const LightComparison& light : lights) {
    const ComparedRow& row = light.rows[index];
    const ComparedRow& lightfit = light.lightfit();
    if (!row.status.ok()) ++totals.num_failed;
    if (!row.status.ok() || !lightfit.status.ok()) continue;
    ++totals.num_lights;
    num_maps += NumMaps(row.drawn);
    num_texels += NumTexels(row.drawn);
    if (row.border() == Border::kDark) ++totals.num_dark;
    if (row.wrong.has_value() && lightfit.wrong.has_value()) {
      ideal.Add(row.wrong->ideal, lightfit.wrong->ideal);
      practical.Add(row.wrong->practical, lightfit.wrong->practical);
    }
    if (row.crawl.has_value() && lightfit.crawl.has_value()) crawls.push_back(*row.crawl);
    if (row.figures.has_value() && lightfit.figures.has_value() && row.figures->energy > 0.0 &&
        lightfit.figures->energy > 0.0) {
      ++totals.num_energy_lights;
      log_energy_ratio += std::log(row.figures->energy / lightfit.figures->energy);
    }
  }
  if (totals.num_lights > 0) {
    totals.mean_maps = static_cast<double>(num_maps) / totals.num_lights;
    totals.mean_texels = static_cast<double>(num_texels) / totals.num_lights;
  }
  totals.ideal = ideal.Result();
  totals.practical = practical.Result();
  totals.crawl = PooledCrawl(crawls);
  totals.num_crawl_lights = static_cast<int>(crawls.size());
  if (totals.num_energy_lights > 0) {
    totals.mean_energy_ratio = std::exp(log_energy_ratio / totals.num_energy_lights);
  }
  return totals;
}

}  // namespace

std::optional<double> RatioOf(double value, double lightfit_value) {
  if (!(lightfit_value > 0.0)) return std::nullopt;
  return value / lightfit_value;
}

std::optional<double> WrongRatio(const ComparedRow& row,
                                 const ComparedRow& lightfit,
                                 int64_t WrongPixels::*kind) {
  if (!row.wrong.has_value() || !lightfit.wrong.has_value()) return std::nullopt;
  return RatioOf(static_cast<double>((*row.wrong).*kind),
                 static_cast<double>((*lightfit.wrong).*kind));
}

std::optional<double> EnergyRatio(const ComparedRow& row, const ComparedRow& lightfit) {
  if (!row.figures.has_value() || !lightfit.figures.has_value()) return std::nullopt;
  return RatioOf(row.figures->energy, lightfit.figures->energy);
}

std::vector<MethodTotals> TotalsOf(absl::Span<const LightComparison> lights) {
  std::vector<MethodTotals> totals;
  if (lights.empty()) return totals;
  for (size_t row = 0; row < lights.front().rows.size(); ++row) {
    totals.push_back(TotalsOfRow(lights, row));
  }
  return totals;
}

}  // namespace lightfit
