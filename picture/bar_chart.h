// picture/bar_chart.h
//
// Counts as horizontal bars, one below the other.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "picture/canvas.h"
#include "picture/text.h"

namespace lightfit {

struct Bar {
  std::string name;
  int64_t value = 0;  // >= 0
  Rgb color;
};

// Fills the rectangle with the bars from its top, the longest as long as there is room beside names
// and numbers.
void DrawBarChart(int x,
                  int y,
                  int width,
                  int height,
                  const std::vector<Bar>& bars,
                  const Typeface& typeface,
                  Canvas* canvas);

}  // namespace lightfit
