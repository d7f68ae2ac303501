#include "bench/published/lloyd_figures.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "partition/published/lloyd_error.h"
#include "picture/color_map.h"
#include "picture/heat_panel.h"
#include "picture/line_chart.h"
#include "picture/png.h"
#include "picture/theme.h"
#include "tests/partition/published/lloyd_view.h"

namespace lightfit {
namespace {

// Pixels.
constexpr int kMargin = 28;
constexpr int kTitleHeight = 64;
constexpr int kLegendHeight = 26;
constexpr int kChartWidth = 720;
constexpr int kChartHeight = 300;
constexpr int kDiscSide = 320;
constexpr int kColorBarWidth = 90;

const Rgb kLineColors[] = {kReceiverColor, kGainColor, kWarningColor, kCropColor};

struct Line {
  std::string name;
  std::function<double(double)> value;
};

// A chart with its caption and legend.
struct Figure {
  std::string caption;
  std::vector<double> x;
  std::vector<Line> lines;
  bool log_y = true;
};

std::vector<double> Steps(double first, double last, int num_steps) {
  std::vector<double> x;
  for (int i = 0; i <= num_steps; ++i) x.push_back(first + (last - first) * i / num_steps);
  return x;
}

LineChart ChartOf(const Figure& figure) {
  LineChart chart;
  chart.x = figure.x;
  chart.log_y = figure.log_y;
  for (size_t i = 0; i < figure.lines.size(); ++i) {
    ChartLine line;
    line.color = kLineColors[i % std::size(kLineColors)];
    for (const double x : figure.x) {
      const double value = figure.lines[i].value(x);
      line.values.push_back(std::isfinite(value) ? std::optional<double>(value) : std::nullopt);
    }
    chart.lines.push_back(std::move(line));
  }
  return chart;
}

void DrawLegend(int y, const Figure& figure, const Typeface& typeface, Canvas* canvas) {
  const TextStyle style = {.size_px = 14, .color = kTextColor};
  int x = kMargin + kChartLabelWidth;
  for (size_t i = 0; i < figure.lines.size(); ++i) {
    canvas->FillRectangle(x, y - 6, 22, 3, kLineColors[i % std::size(kLineColors)]);
    typeface.Draw(x + 28, y, figure.lines[i].name, style, canvas);
    x += 28 + typeface.Width(figure.lines[i].name, style) + 22;
  }
}

Canvas NewPage(int width, int height, const std::string& title, const Typeface& typeface) {
  Canvas canvas(width, height, kPageColor);
  typeface.Draw(kMargin, 40, title, {.size_px = 21, .color = kTextColor, .bold = true}, &canvas);
  return canvas;
}

Canvas DrawPage(const std::string& title,
                const std::vector<Figure>& figures,
                const Typeface& typeface) {
  const int block = 2 * kLegendHeight + kChartHeight + kMargin;
  Canvas canvas = NewPage(2 * kMargin + kChartWidth,
                          kTitleHeight + static_cast<int>(figures.size()) * block,
                          title,
                          typeface);
  int y = kTitleHeight;
  for (const Figure& figure : figures) {
    typeface.Draw(kMargin + kChartLabelWidth,
                  y + 16,
                  figure.caption,
                  {.size_px = 14, .color = kFaintTextColor},
                  &canvas);
    DrawLegend(y + kLegendHeight + 14, figure, typeface, &canvas);
    DrawLineChart(kMargin,
                  y + 2 * kLegendHeight,
                  kChartWidth,
                  kChartHeight,
                  ChartOf(figure),
                  typeface,
                  &canvas);
    y += block;
  }
  return canvas;
}

Canvas DrawErrorsAlongTheView(const Typeface& typeface) {
  const LloydView view = {1.0, 20.0, M_PI / 4.0};
  const std::pair<std::string, double> warps[] = {
      {"n' = n", view.near},
      {"n' = n + sqrt(n f)", LispsmWarp(view)},
      {"no warp", std::numeric_limits<double>::infinity()}};
  Figure x_error = {"across the view, last factor of (7), by depth", Steps(1.0, 20.0, 380), {}};
  Figure z_error = {"along the view, last factor of (8), by depth", x_error.x, {}};
  for (const auto& [name, warp] : warps) {
    x_error.lines.push_back(
        {name, [view, warp = warp](double z) { return XError(view, warp, z) / view.far; }});
    z_error.lines.push_back({name, [view, warp = warp](double z) {
                               return ZError(view, warp, z) * ImageBeamWidth(view, 1.0) /
                                      (view.far - view.near);
                             }});
  }
  return DrawPage("Figure 5: error along the view, n = 1, f = 20", {z_error, x_error}, typeface);
}

Canvas DrawRangeOfWarps(const Typeface& typeface) {
  const LloydView view = {1.0, 100.0, M_PI / 4.0};
  const auto share = [view](double (*value)(const LloydView&, double), double eta) {
    return value(view, WarpOfEta(view, eta)) /
           std::max(value(view, WarpOfEta(view, -1.0)), value(view, view.near));
  };
  const Figure figure = {
      "as shares of their largest, by eta: -1 no warp, 0 light-space, 1 perspective maps",
      Steps(-1.0, 1.0, 400),
      {{"M_x", [share](double eta) { return share(&MaxXError, eta); }},
       {"M_z", [share](double eta) { return share(&MaxZError, eta); }},
       {"storage factor", [share](double eta) { return share(&WarpStorage, eta); }}},
      /*log_y=*/false};
  return DrawPage("Figure 6: all warps, f/n = 100, theta = 45 degrees", {figure}, typeface);
}

const LloydView kDeepView = {1.0, 1000.0, M_PI / 6.0};

Canvas DrawSplitsOverhead(const Typeface& typeface) {
  const Figure figure = {
      "storage factor by the number of slices",
      Steps(1.0, 16.0, 15),
      {{"split by depth, warped", [](double k) { return OverheadWarpStorage(kDeepView, k); }},
       {"logarithmic", [](double) { return LogarithmicZError(kDeepView); }}}};
  return DrawPage("Figure 10: light overhead, f/n = 1000, theta = 30 degrees", {figure}, typeface);
}

Canvas DrawStorageByMaps(const Typeface& typeface) {
  const std::vector<double> maps = Steps(1.0, 24.0, 23);
  const auto every_fourth = [](double (*value)(const LloydView&, double), double maps_in_all) {
    return maps_in_all < 4.0 ? std::numeric_limits<double>::quiet_NaN()
                             : value(kDeepView, std::floor(maps_in_all / 4.0));
  };
  const Figure behind = {"light behind, storage factor by the number of maps",
                         maps,
                         {{"split by depth", [](double j) { return BehindStorage(kDeepView, j); }},
                          {"by faces and depth, warped", [every_fourth](double j) {
                             return every_fourth(&BehindFaceWarpStorage, j);
                           }}}};
  const Figure overhead = {
      "light overhead",
      maps,
      {{"split by depth", [](double j) { return OverheadStorage(kDeepView, j); }},
       {"... warped", [](double j) { return OverheadWarpStorage(kDeepView, j); }},
       {"by faces and depth, warped",
        [every_fourth](double j) { return every_fourth(&OverheadWarpStorage, j); }}}};
  return DrawPage(
      "Figure 12: number of maps, f/n = 1000, theta = 30 degrees", {behind, overhead}, typeface);
}

Canvas DrawWhereFacesPay(const Typeface& typeface) {
  const Figure figure = {
      "light behind: the first number of maps with which faces need less, by log10 f/n",
      Steps(0.5, 4.0, 350),
      {{"faces need less from here on",
        [](double log_alpha) {
          const LloydView view = {1.0, std::pow(10.0, log_alpha), M_PI / 6.0};
          return static_cast<double>(testing::FirstMapsOfFaces(view));
        }}},
      /*log_y=*/false};
  return DrawPage("Figure 13: splits by depth or by faces", {figure}, typeface);
}

// Overhead in the middle, the horizon around; behind on the left.
Image DiscImage(const LloydDisc& disc, int steps, const LogScale& scale) {
  Image image(kDiscSide, kDiscSide, kPageColor);
  for (int y = 0; y < kDiscSide; ++y) {
    for (int x = 0; x < kDiscSide; ++x) {
      const double right = 2.0 * (x + 0.5) / kDiscSide - 1.0;
      const double up = 1.0 - 2.0 * (y + 0.5) / kDiscSide;
      const double radius = std::hypot(right, up);
      if (radius >= 1.0) continue;
      // SunsAbove() turns from light that travels to the left over light along the view.
      const double around = std::atan2(-right, up) / (2.0 * M_PI);
      const int ring = std::min(static_cast<int>(radius * steps), steps - 1);
      const int sector = static_cast<int>((around < 0.0 ? around + 1.0 : around) * 4 * steps);
      const double value = disc.storage[ring * 4 * steps + std::min(sector, 4 * steps - 1)];
      image.Blend(x, y, HeatColor(scale.Position(value)));
    }
  }
  return image;
}

Canvas DrawHemispheres(const std::vector<LloydDisc>& discs, int steps, const Typeface& typeface) {
  std::vector<float> values;
  for (const LloydDisc& disc : discs)
    values.insert(values.end(), disc.storage.begin(), disc.storage.end());
  const LogScale scale = ScaleFor(values);
  constexpr int kColumns = 3;
  const int rows = (static_cast<int>(discs.size()) + kColumns - 1) / kColumns;
  const int column = kDiscSide + kMargin, row = kDiscSide + kMargin + kLegendHeight;
  Canvas canvas = NewPage(kMargin + kColumns * column + kColorBarWidth,
                          kTitleHeight + rows * row,
                          "Figure 7: storage factor by the light's direction, theta = 30 degrees",
                          typeface);
  for (size_t i = 0; i < discs.size(); ++i) {
    const int x = kMargin + static_cast<int>(i) % kColumns * column;
    const int y = kTitleHeight + static_cast<int>(i) / kColumns * row;
    typeface.Draw(x, y + 16, discs[i].name, {.size_px = 14, .color = kFaintTextColor}, &canvas);
    canvas.DrawImage(x, y + kLegendHeight, DiscImage(discs[i], steps, scale));
  }
  DrawColorBar(kMargin + kColumns * column,
               kTitleHeight + kLegendHeight,
               kDiscSide,
               scale,
               typeface,
               &canvas);
  return canvas;
}

}  // namespace

absl::Status DrawLloydFigures(const std::string& folder,
                              const std::vector<LloydDisc>& discs,
                              int steps) {
  const Typeface typeface = Typeface::Find();
  const std::pair<std::string, Canvas> pages[] = {
      {"lloyd5", DrawErrorsAlongTheView(typeface)},
      {"lloyd6", DrawRangeOfWarps(typeface)},
      {"lloyd7", DrawHemispheres(discs, steps, typeface)},
      {"lloyd10", DrawSplitsOverhead(typeface)},
      {"lloyd12", DrawStorageByMaps(typeface)},
      {"lloyd13", DrawWhereFacesPay(typeface)}};
  for (const auto& [name, page] : pages) {
    const std::string path = absl::StrCat(folder, "/", name, ".png");
    if (absl::Status status = WritePng(page, path); !status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace lightfit
