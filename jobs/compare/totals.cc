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

MethodTotals TotalsOfRow(absl::Span<const LightComparison> lights, size_t row) {
  MethodTotals totals;
  totals.name = lights.front().maps[row].name;
  PixelSum ideal, practical;
  double log_energy_ratio = 0.0;
  std::vector<MapCrawl> crawls;
  for (const LightComparison& light : lights) {
    const ComparedMap& map = light.maps[row];
    const ComparedMap& lightfit = light.lightfit();
    if (!map.status.ok()) ++totals.num_failed;
    if (!map.status.ok() || !lightfit.status.ok()) continue;
    ++totals.num_lights;
    if (map.border == Border::kDark) ++totals.num_dark;
    if (map.wrong.has_value() && lightfit.wrong.has_value()) {
      ideal.Add(map.wrong->ideal, lightfit.wrong->ideal);
      practical.Add(map.wrong->practical, lightfit.wrong->practical);
    }
    if (map.crawl.has_value() && lightfit.crawl.has_value()) crawls.push_back(*map.crawl);
    if (map.figures.has_value() && lightfit.figures.has_value() && map.figures->energy > 0.0 &&
        lightfit.figures->energy > 0.0) {
      ++totals.num_energy_lights;
      log_energy_ratio += std::log(map.figures->energy / lightfit.figures->energy);
    }
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

std::optional<double> WrongRatio(const ComparedMap& map,
                                 const ComparedMap& lightfit,
                                 int64_t WrongPixels::*kind) {
  if (!map.wrong.has_value() || !lightfit.wrong.has_value()) return std::nullopt;
  return RatioOf(static_cast<double>((*map.wrong).*kind),
                 static_cast<double>((*lightfit.wrong).*kind));
}

std::optional<double> EnergyRatio(const ComparedMap& map, const ComparedMap& lightfit) {
  if (!map.figures.has_value() || !lightfit.figures.has_value()) return std::nullopt;
  return RatioOf(map.figures->energy, lightfit.figures->energy);
}

std::vector<MethodTotals> TotalsOf(absl::Span<const LightComparison> lights) {
  std::vector<MethodTotals> totals;
  if (lights.empty()) return totals;
  for (size_t row = 0; row < lights.front().maps.size(); ++row) {
    totals.push_back(TotalsOfRow(lights, row));
  }
  return totals;
}

}  // namespace lightfit
