#include "picture/shot_page.h"

#include <algorithm>
#include <functional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "jobs/shot/totals.h"
#include "picture/line_chart.h"
#include "picture/theme.h"

namespace lightfit {
namespace {

// Pixels.
constexpr int kMargin = 28;
constexpr int kTitleHeight = 92;
constexpr int kNameHeight = 34;
constexpr int kCaptionHeight = 26;
constexpr int kChartHeight = 200;
constexpr int kChartGap = 14;
constexpr int kColumnGap = 24;
constexpr int kLegendGap = 30;
constexpr int kNumCharts = 3;
constexpr int kBlockHeight = kNameHeight + kNumCharts * (kCaptionHeight + kChartHeight + kChartGap);

constexpr int kMaxColumns = 4;
constexpr int kMinColumnWidth = 520;
constexpr int kOneColumnWidth = 1000;

Rgb ModeColor(ShotMode mode) {
  switch (mode) {
    case ShotMode::kPerFrame:
      return kReceiverColor;
    case ShotMode::kTracked:
      return kGainColor;
    case ShotMode::kPerShot:
      return kWarningColor;
  }
  return kTextColor;
}

using Value = std::function<std::optional<double>(const ShotRow&)>;

struct ChartKind {
  std::string caption;
  Value value;
  bool log_y = false;
  bool has_dots = false;
};

std::optional<double> EdgeCrawl(const ShotRow& row) {
  if (!row.crawl.has_value() || row.crawl->num_edge_points == 0) return std::nullopt;
  return row.crawl->edge_crawl_px;
}

std::vector<ChartKind> ChartKinds(const ShotJob& job, const ShotRows& rows) {
  const bool has_ratio = job.Has(ShotMode::kPerFrame);
  const ChartKind energy = {has_ratio ? "energy, as a multiple of per-frame" : "energy",
                            [&rows, has_ratio](const ShotRow& row) -> std::optional<double> {
                              if (has_ratio) return EnergyRatio(rows, row);
                              if (!row.error.empty()) return std::nullopt;
                              return row.energy;
                            },
                            /*log_y=*/true,
                            /*has_dots=*/true};
  const ChartKind footprint = {"rms footprint, read-back pixels per texel",
                               [](const ShotRow& row) -> std::optional<double> {
                                 if (!row.error.empty()) return std::nullopt;
                                 return row.footprint.rms;
                               }};
  return {energy, footprint, {"crawl of shadow edges, read-back pixels per frame", EdgeCrawl}};
}

LineChart ChartOf(const ShotJob& job, const ShotRows& rows, size_t light, const ChartKind& kind) {
  LineChart chart;
  chart.log_y = kind.log_y;
  for (const ShotFrame& frame : job.frames) {
    chart.x.push_back(frame.number.value());
    chart.breaks.push_back(frame.is_after_gap);
  }
  for (const ShotMode mode : kShotModes) {
    if (!job.Has(mode)) continue;
    ChartLine line;
    line.color = ModeColor(mode);
    for (const std::vector<ShotRow>& frame : rows[static_cast<size_t>(mode)]) {
      const ShotRow* row = light < frame.size() ? &frame[light] : nullptr;
      line.values.push_back(row == nullptr ? std::nullopt : kind.value(*row));
      line.dots.push_back(kind.has_dots && mode == ShotMode::kTracked && row != nullptr &&
                          row->num_moved > 0);
    }
    chart.lines.push_back(std::move(line));
  }
  return chart;
}

void DrawTitle(const ShotJob& job, const Typeface& typeface, Canvas* canvas) {
  const TextStyle bold = {.size_px = 24, .color = kTextColor, .bold = true};
  const std::string what = absl::StrFormat(
      ": %d %s, %s", job.frames.size(), job.frames.size() == 1 ? "frame" : "frames", MapsText(job));
  const int room = canvas->width() - 2 * kMargin - typeface.Width(what, bold);
  typeface.Draw(
      kMargin, 42, absl::StrCat(typeface.Fitted(job.name, room, bold), what), bold, canvas);
  int x = kMargin;
  const int baseline = 76;
  const TextStyle style = {.size_px = 16, .color = kTextColor};
  for (const ShotMode mode : kShotModes) {
    if (!job.Has(mode)) continue;
    canvas->FillRectangle(x, baseline - 7, 26, 3, ModeColor(mode));
    if (mode == ShotMode::kTracked) {
      canvas->DrawDot({x + 13.0, baseline - 5.5}, 4.5, ModeColor(mode));
    }
    std::string name = ShotModeName(mode);
    if (mode == ShotMode::kTracked) name += " (dot: a map moves)";
    typeface.Draw(x + 36, baseline, name, style, canvas);
    x += 36 + typeface.Width(name, style) + kLegendGap;
  }
}

}  // namespace

Canvas DrawShotPlot(const ShotJob& job, const ShotRows& rows, const Typeface& typeface) {
  const auto num_lights = static_cast<int>(job.lights.size());
  const int columns = std::clamp(num_lights, 1, kMaxColumns);
  const int blocks = (num_lights + columns - 1) / columns;
  const int column_width = std::max(kMinColumnWidth, kOneColumnWidth / columns);
  Canvas canvas(2 * kMargin + columns * column_width + (columns - 1) * kColumnGap,
                kTitleHeight + blocks * kBlockHeight + kMargin,
                kPageColor);
  DrawTitle(job, typeface, &canvas);
  const std::vector<ChartKind> kinds = ChartKinds(job, rows);
  for (int light = 0; light < num_lights; ++light) {
    const int x = kMargin + light % columns * (column_width + kColumnGap);
    int y = kTitleHeight + light / columns * kBlockHeight;
    typeface.Draw(x + kChartLabelWidth,
                  y + 22,
                  job.lights[light].name,
                  {.size_px = 19, .color = kTextColor, .bold = true},
                  &canvas);
    y += kNameHeight;
    for (const ChartKind& kind : kinds) {
      typeface.Draw(x + kChartLabelWidth,
                    y + 18,
                    kind.caption,
                    {.size_px = 14, .color = kFaintTextColor},
                    &canvas);
      y += kCaptionHeight;
      DrawLineChart(
          x, y, column_width, kChartHeight, ChartOf(job, rows, light, kind), typeface, &canvas);
      y += kChartHeight + kChartGap;
    }
  }
  return canvas;
}

}  // namespace lightfit
