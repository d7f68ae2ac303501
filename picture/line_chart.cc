#include "picture/line_chart.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "absl/strings/str_format.h"
#include "picture/theme.h"

namespace lightfit {
namespace {

// Pixels.
constexpr int kTextSize = 13;
constexpr double kLineWidth = 2.0;
constexpr double kDenseLineWidth = 1.2;  // where points are closer than kDensePitch
constexpr double kDensePitch = 3.0;
constexpr double kMaxDotRadius = 3.5;
constexpr double kTickGapY = 24.0;
constexpr int kTickGapX = 18;  // between labels

// 1, 2 or 5 times a power of ten, not below `least`.
double RoundStep(double least) {
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= least * (1.0 - 1e-9)) return factor * power;
  }
  return 10.0 * power;
}

std::vector<double> LinearTicks(double min, double max, double least_step) {
  const double step = RoundStep(least_step);
  std::vector<double> ticks;
  const double first = std::ceil(min / step - 1e-9), last = std::floor(max / step + 1e-9);
  for (double i = first; i <= last && ticks.size() < 1000; ++i) ticks.push_back(i * step);
  return ticks;
}

// Powers of ten first, then what fits between them, coarse before fine.
std::vector<double> LogTicks(const ChartAxis& axis, double min_gap) {
  std::vector<double> ticks;
  const int low = static_cast<int>(std::floor(std::log10(axis.min)));
  const int high = static_cast<int>(std::ceil(std::log10(axis.max)));
  for (const double factor : {1.0, 2.0, 5.0, 3.0, 1.5, 1.2, 7.0, 1.1, 1.3, 1.05, 1.02, 1.01}) {
    for (int power = low; power <= high; ++power) {
      const double tick = factor * std::pow(10.0, power);
      if (tick < axis.min * (1 - 1e-9) || tick > axis.max * (1 + 1e-9)) continue;
      const bool has_room = std::all_of(ticks.begin(), ticks.end(), [&](double other) {
        return std::abs(axis.Position(tick) - axis.Position(other)) >= min_gap;
      });
      if (has_room) ticks.push_back(tick);
    }
  }
  std::sort(ticks.begin(), ticks.end());
  return ticks;
}

// Zero has no sign.
std::string Label(double value) { return absl::StrFormat("%.6g", value == 0.0 ? 0.0 : value); }

// Draws within one rectangle.
class Plot {
 public:
  Plot(int left, int top, int width, int height, const LineChart& chart, Canvas* canvas)
      : left_(left),
        top_(top),
        width_(width),
        height_(height),
        chart_(chart),
        axis_(AxisFor(chart)),
        canvas_(*canvas) {
    canvas_.FillRectangle(left_, top_, width_, height_, kPanelColor);
  }

  void DrawTicks(const Typeface& typeface) {
    const TextStyle right = {
        .size_px = kTextSize, .color = kFaintTextColor, .anchor = Anchor::kRight};
    for (const double tick : AxisTicks(axis_, kTickGapY / height_)) {
      const int y = static_cast<int>(std::lround(Y(tick)));
      canvas_.FillRectangle(left_, y, width_, 1, kRuleColor);
      typeface.Draw(left_ - 8, y + kTextSize / 3 + 1, Label(tick), right, &canvas_);
    }
    if (chart_.x.empty()) return;
    const TextStyle middle = {
        .size_px = kTextSize, .color = kFaintTextColor, .anchor = Anchor::kMiddle};
    const double first = chart_.x.front(), last = chart_.x.back();
    const int label =
        std::max(typeface.Width(Label(first), middle), typeface.Width(Label(last), middle)) +
        kTickGapX;
    const double least_step = std::max(1.0, (last - first) * label / width_);
    for (const double tick : LinearTicks(first, last, least_step)) {
      const int x = static_cast<int>(std::lround(X(tick)));
      canvas_.FillRectangle(x, top_ + height_, 1, 4, kFaintTextColor);
      typeface.Draw(x, top_ + height_ + kTextSize + 7, Label(tick), middle, &canvas_);
    }
  }

  void DrawLines() {
    for (const ChartLine& line : chart_.lines) {
      std::optional<Eigen::Vector2d> before;
      bool is_joined = false;
      for (size_t i = 0; i < chart_.x.size() && i < line.values.size(); ++i) {
        if (before && i < chart_.breaks.size() && chart_.breaks[i]) {
          if (!is_joined) canvas_.DrawDot(*before, kLineWidth, line.color);
          before.reset();
          is_joined = false;
        }
        std::optional<Eigen::Vector2d> point;
        if (HasPlace(line.values[i])) point.emplace(X(chart_.x[i]), Y(*line.values[i]));
        if (point && before) canvas_.DrawLine(*before, *point, LineWidth(), line.color);
        // A value between two gaps would not be seen.
        if (before && !point && !is_joined) canvas_.DrawDot(*before, kLineWidth, line.color);
        is_joined = point.has_value() && before.has_value();
        before = point;
        if (point && i < line.dots.size() && line.dots[i]) {
          canvas_.DrawDot(*point, DotRadius(), line.color);
        }
      }
      if (before && !is_joined) canvas_.DrawDot(*before, kLineWidth, line.color);
    }
  }

 private:
  bool HasPlace(const std::optional<double>& value) const {
    return value.has_value() && std::isfinite(*value) && (!axis_.log || *value > 0.0);
  }

  // Half a step of room at both ends.
  double X(double x) const {
    const double first = chart_.x.front(), last = chart_.x.back();
    const double room = std::min(20.0, 0.5 * width_ / static_cast<double>(chart_.x.size()));
    const double share = last > first ? (x - first) / (last - first) : 0.5;
    return left_ + room + share * (width_ - 2 * room);
  }
  double Y(double value) const { return top_ + height_ * (1.0 - axis_.Position(value)); }

  double Pitch() const { return width_ / static_cast<double>(chart_.x.size()); }
  double LineWidth() const { return Pitch() < kDensePitch ? kDenseLineWidth : kLineWidth; }
  double DotRadius() const { return std::clamp(0.4 * Pitch(), 0.5 * kLineWidth, kMaxDotRadius); }

  const int left_, top_, width_, height_;
  const LineChart& chart_;
  const ChartAxis axis_;
  Canvas& canvas_;
};

}  // namespace

double ChartAxis::Position(double value) const {
  if (!log) return (value - min) / (max - min);
  return std::log(value / min) / std::log(max / min);
}

ChartAxis AxisFor(const LineChart& chart) {
  double least = std::numeric_limits<double>::infinity(), greatest = -least;
  for (const ChartLine& line : chart.lines) {
    for (const std::optional<double>& value : line.values) {
      if (!value.has_value() || !std::isfinite(*value)) continue;
      if (chart.log_y && !(*value > 0.0)) continue;
      least = std::min(least, *value);
      greatest = std::max(greatest, *value);
    }
  }
  if (!(least <= greatest)) return {chart.log_y ? 0.1 : 0.0, 1.0, chart.log_y};
  if (chart.log_y) {
    // At least a tenth up and down, so that one value is a line in the middle.
    const double room = std::max(1.1, std::pow(greatest / least, 0.06));
    return {least / room, greatest * room, true};
  }
  least = std::min(least, 0.0);
  greatest = std::max(greatest, 0.0);
  if (least == greatest) greatest = 1.0;
  const double room = 0.06 * (greatest - least);
  return {least < 0.0 ? least - room : -0.5 * room, greatest + room, false};
}

std::vector<double> AxisTicks(const ChartAxis& axis, double min_gap) {
  if (axis.log) return LogTicks(axis, min_gap);
  return LinearTicks(axis.min, axis.max, min_gap * (axis.max - axis.min));
}

void DrawLineChart(int x,
                   int y,
                   int width,
                   int height,
                   const LineChart& chart,
                   const Typeface& typeface,
                   Canvas* canvas) {
  const int plot_width = width - kChartLabelWidth, plot_height = height - kChartLabelHeight;
  if (plot_width < 1 || plot_height < 1) return;
  Plot plot(x + kChartLabelWidth, y, plot_width, plot_height, chart, canvas);
  plot.DrawTicks(typeface);
  plot.DrawLines();
}

}  // namespace lightfit
