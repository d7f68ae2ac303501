#include "bench/forecast_table.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_format.h"

namespace lightfit {
namespace {

constexpr double kLeastMeasured = 30.0;
// Measured counts closer than this are not told apart, whatever is foretold.
constexpr double kToldApart = 1.1;

using Pixels = ForecastTable::Pixels;

// Of log(measured / foretold).
double LogRatio(const Pixels& pixels) {
  return std::log((pixels.measured + 1.0) / (pixels.foretold + 1.0));
}

struct Spread {
  double sum = 0.0, sum_squares = 0.0;
  int count = 0;

  void Add(double value) {
    sum += value;
    sum_squares += value * value;
    ++count;
  }
  double mean() const { return count > 0 ? sum / count : 0.0; }
  double deviation() const {
    return count > 0 ? std::sqrt(std::max(0.0, sum_squares / count - mean() * mean())) : 0.0;
  }
};

struct Pairs {
  int wrong = 0, all = 0;

  void Add(const Pixels& a, const Pixels& b) {
    const double measured = (a.measured + 1.0) / (b.measured + 1.0);
    if (measured < kToldApart && measured > 1.0 / kToldApart) return;
    ++all;
    wrong += (a.foretold < b.foretold) != (a.measured < b.measured) ? 1 : 0;
  }
  std::string Text() const {
    return absl::StrFormat("%4.1f %% of %-4d", all > 0 ? 100.0 * wrong / all : 0.0, all);
  }
};

// One line of the table.
struct Quality {
  Spread lights;  // of our rows
  Spread within;  // of all rows about their light's mean
  Pairs ours, all;

  void Add(const std::vector<Pixels>& rows, size_t ours) {
    lights.Add(LogRatio(rows[ours]));
    Spread about;
    for (const Pixels& row : rows) about.Add(LogRatio(row));
    for (const Pixels& row : rows) within.Add(LogRatio(row) - about.mean());
    for (size_t i = 0; i < rows.size(); ++i) {
      for (size_t j = 0; j < i; ++j) {
        all.Add(rows[i], rows[j]);
        if (i == ours || j == ours) this->ours.Add(rows[i], rows[j]);
      }
    }
  }

  std::string Text(const std::string& name) const {
    return absl::StrFormat("%-20s %6d %8.2f %8.2f %8.2f   %s %s\n",
                           name,
                           lights.count,
                           std::exp(lights.mean()),
                           std::exp(lights.deviation()),
                           std::exp(within.deviation()),
                           ours.Text(),
                           all.Text());
  }
};

}  // namespace

void ForecastTable::Add(const std::string& scene, const std::vector<Pixels>& rows, size_t ours) {
  if (rows[ours].measured >= kLeastMeasured) lights_.push_back({scene, rows, ours});
}

std::string ForecastTable::Text(const std::string& title) const {
  std::string text = absl::StrFormat("%-20s %6s %8s %8s %8s   %-14s %s\n",
                                     title,
                                     "lights",
                                     "bias",
                                     "scatter",
                                     "within",
                                     "ours wrong",
                                     "all wrong");
  std::vector<std::pair<std::string, Quality>> scenes;
  Quality all;
  for (const Light& light : lights_) {
    if (scenes.empty() || scenes.back().first != light.scene) {
      scenes.emplace_back(light.scene, Quality());
    }
    scenes.back().second.Add(light.rows, light.ours);
    all.Add(light.rows, light.ours);
  }
  for (const auto& [scene, quality] : scenes) text += quality.Text(scene);
  return text + all.Text("all");
}

}  // namespace lightfit
