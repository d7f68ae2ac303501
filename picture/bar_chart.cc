#include "picture/bar_chart.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "picture/theme.h"

namespace lightfit {
namespace {

// Pixels.
constexpr int kMaxPitch = 34;
constexpr int kTextGap = 10;
constexpr int kTextSize = 15;

}  // namespace

void DrawBarChart(int x,
                  int y,
                  int width,
                  int height,
                  const std::vector<Bar>& bars,
                  const Typeface& typeface,
                  Canvas* canvas) {
  if (bars.empty()) return;
  int name_width = 0, value_width = 0;
  int64_t longest = 0;
  const TextStyle style = {.size_px = kTextSize, .color = kTextColor};
  for (const Bar& bar : bars) {
    name_width = std::max(name_width, typeface.Width(bar.name, style));
    value_width = std::max(value_width, typeface.Width(absl::StrCat(bar.value), style));
    longest = std::max(longest, bar.value);
  }
  const int pitch = std::clamp(height / static_cast<int>(bars.size()), 2, kMaxPitch);
  const int bar_height = std::max(1, pitch * 3 / 5);
  const int bar_x = x + name_width + kTextGap;
  const int room = std::max(1, width - name_width - value_width - 2 * kTextGap);
  for (size_t i = 0; i < bars.size(); ++i) {
    const int bar_y = y + static_cast<int>(i) * pitch;
    const int length =
        longest > 0 ? static_cast<int>(std::lround(room * static_cast<double>(bars[i].value) /
                                                   static_cast<double>(longest)))
                    : 0;
    const int baseline = bar_y + bar_height / 2 + kTextSize / 3;
    typeface.Draw(x, baseline, bars[i].name, style, canvas);
    canvas->FillRectangle(bar_x, bar_y, length, bar_height, bars[i].color);
    typeface.Draw(bar_x + length + kTextGap, baseline, absl::StrCat(bars[i].value), style, canvas);
  }
}

}  // namespace lightfit
