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

// Blue and red are told apart by whoever sees two of the three colours; the middle is paler than
// both, and dark enough for white lines over it.
constexpr uint32_t kFootprintColors[] = {
    0x1c2f8c, 0x2a55c8, 0x4486e6, 0x7fb0e4, 0xcfc8a8, 0xeeb06c, 0xee7f35, 0xd8431f, 0xa01515};

// Of footprints: what lies beyond is as fine, or as coarse, as anybody needs to know.
constexpr double kFootprintEnds[] = {5.0, 10.0, 20.0, 50.0};

// Shares of the values that may lie beyond the ends of the scale.
constexpr double kLowOutliers = 0.005;
constexpr double kHighOutliers = 0.002;

Rgb ColorAlong(absl::Span<const uint32_t> colors, double position) {
  const auto last = static_cast<int>(colors.size()) - 1;
  const double scaled = std::clamp(position, 0.0, 1.0) * last;
  const int index = std::min(static_cast<int>(scaled), last - 1);
  return Mix(
      HexColor(colors[index]), HexColor(colors[index + 1]), static_cast<float>(scaled - index));
}

// The value that so large a share of the others lies below. Not for no values; changes their order.
double Quantile(double share, std::vector<float>* values) {
  const auto nth =
      values->begin() + static_cast<ptrdiff_t>(share * static_cast<double>(values->size() - 1));
  std::nth_element(values->begin(), nth, values->end());
  return *nth;
}

std::vector<float> PositiveOf(absl::Span<const float> values) {
  std::vector<float> positive;
  for (const float value : values) {
    if (value > 0 && std::isfinite(value)) positive.push_back(value);
  }
  return positive;
}

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

Rgb HeatColor(double position) { return ColorAlong(kHeatColors, position); }

Rgb FootprintColor(double position) { return ColorAlong(kFootprintColors, position); }

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
  std::vector<float> positive = PositiveOf(values);
  if (positive.empty()) return {};
  LogScale scale;
  scale.min = RoundToTick(Quantile(kLowOutliers, &positive), /*up=*/false);
  scale.max = RoundToTick(Quantile(1 - kHighOutliers, &positive), /*up=*/true);
  if (scale.max < 2 * scale.min) scale.max = RoundToTick(2 * scale.min, /*up=*/true);
  return scale;
}

LogScale FootprintScaleFor(absl::Span<const float> values) {
  std::vector<float> positive = PositiveOf(values);
  double end = 1.0;
  if (!positive.empty()) {
    end = std::max(1.0 / Quantile(kLowOutliers, &positive), Quantile(1 - kHighOutliers, &positive));
  }
  LogScale scale;
  scale.color_at = &FootprintColor;
  for (const double tick : kFootprintEnds) {
    scale.max = tick;
    if (end <= tick) break;
  }
  scale.min = 1.0 / scale.max;
  return scale;
}

std::string TickLabel(double value) { return absl::StrFormat("%g", value); }

}  // namespace lightfit
