#include "picture/color_map.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"

namespace lightfit {
namespace {

// Equally spaced control points, after Turbo (Mikhailov 2019) with its dark ends lifted.
constexpr uint32_t kHeatColors[] = {0x3b3f9e,
                                    0x4569d8,
                                    0x3f93f5,
                                    0x23bde0,
                                    0x1fdfb4,
                                    0x58f580,
                                    0xa4f94e,
                                    0xdde83e,
                                    0xfcc23a,
                                    0xfb8d2c,
                                    0xec5a1a,
                                    0xc72f12};
constexpr int kNumHeatColors = sizeof(kHeatColors) / sizeof(kHeatColors[0]);

// Shares of the values that may lie beyond the ends of the scale.
constexpr double kLowOutliers = 0.005;
constexpr double kHighOutliers = 0.002;

// The largest 1, 2 or 5 times a power of ten that does not exceed `value`, or the smallest that is
// not below it. The factor forgives rounding in 10^n.
double RoundToTick(double value, bool up) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  const double ticks[] = {1, 2, 5, 10};
  double below = decade;
  for (const double tick : ticks) {
    if (up && tick * decade >= value * (1 - 1e-9)) return tick * decade;
    if (tick * decade <= value * (1 + 1e-9)) below = tick * decade;
  }
  return below;
}

}  // namespace

Rgb HeatColor(double position) {
  const double scaled = std::clamp(position, 0.0, 1.0) * (kNumHeatColors - 1);
  const int index = std::min(static_cast<int>(scaled), kNumHeatColors - 2);
  return Mix(HexColor(kHeatColors[index]),
             HexColor(kHeatColors[index + 1]),
             static_cast<float>(scaled - index));
}

double LogScale::Position(double value) const {
  if (!(value > min)) return 0;
  return std::min(1.0, std::log(value / min) / std::log(max / min));
}

std::vector<double> LogScale::Ticks() const {
  std::vector<double> ticks;
  const int last_decade = static_cast<int>(std::ceil(std::log10(max)));
  for (int decade = static_cast<int>(std::floor(std::log10(min))); decade <= last_decade;
       ++decade) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double value = factor * std::pow(10.0, decade);
      if (value >= min * (1 - 1e-9) && value <= max * (1 + 1e-9)) ticks.push_back(value);
    }
  }
  return ticks;
}

LogScale ScaleFor(absl::Span<const float> values) {
  std::vector<float> positive;
  for (const float value : values) {
    if (value > 0 && std::isfinite(value)) positive.push_back(value);
  }
  if (positive.empty()) return {};
  const auto quantile = [&positive](double share) {
    const auto nth = positive.begin() + static_cast<ptrdiff_t>(share * (positive.size() - 1));
    std::nth_element(positive.begin(), nth, positive.end());
    return static_cast<double>(*nth);
  };
  LogScale scale;
  scale.min = RoundToTick(quantile(kLowOutliers), /*up=*/false);
  scale.max = RoundToTick(quantile(1 - kHighOutliers), /*up=*/true);
  if (scale.max < 2 * scale.min) scale.max = RoundToTick(2 * scale.min, /*up=*/true);
  return scale;
}

std::string TickLabel(double value) { return absl::StrFormat("%g", value); }

}  // namespace lightfit
