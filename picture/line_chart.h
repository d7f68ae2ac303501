// picture/line_chart.h
//
// Numbers over a time line: lines in one rectangle, with ticks on both axes.
// In:   x, the same for all lines; per line a value or none for each x.
// Out:  the chart, drawn on a Canvas.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "picture/canvas.h"
#include "picture/text.h"

namespace lightfit {

struct ChartLine {
  std::vector<std::optional<double>> values;  // by x; where there is none the line is interrupted
  std::vector<bool> dots;                     // by x: whether the value has a dot; empty: none
  Rgb color;
};

struct LineChart {
  std::vector<double> x;         // rising
  std::vector<bool> breaks;      // by x: whether lines are interrupted before it; empty: nowhere
  std::vector<ChartLine> lines;  // later ones on top
  bool log_y = false;            // values that are not positive have no place on it
};

// From the least value to the greatest, or from 0 on a linear axis, with some room.
struct ChartAxis {
  double min = 0.0, max = 1.0;
  bool log = false;

  // 0 at min, 1 at max.
  double Position(double value) const;
};
ChartAxis AxisFor(const LineChart& chart);

// Round values within the axis, as many as there is room for at least `min_gap` apart, as a share
// of the axis.
std::vector<double> AxisTicks(const ChartAxis& axis, double min_gap);

// Fills the rectangle; the left of it, kChartLabelWidth, holds the labels of the y axis, the
// bottom, kChartLabelHeight, those of the x axis.
inline constexpr int kChartLabelWidth = 56;   // pixels
inline constexpr int kChartLabelHeight = 26;  // pixels
void DrawLineChart(int x,
                   int y,
                   int width,
                   int height,
                   const LineChart& chart,
                   const Typeface& typeface,
                   Canvas* canvas);

}  // namespace lightfit
