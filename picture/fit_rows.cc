#include "picture/fit_rows.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/number.h"
#include "base/table.h"
#include "picture/color_map.h"
#include "picture/theme.h"

namespace lightfit {
namespace {

// Pixels.
constexpr int kMargin = 36;
constexpr int kGap = 18;
constexpr int kColorBarSpace = 84;
constexpr int kTitleHeight = 74;
constexpr int kRowHeaderHeight = 44;
constexpr int kPanelHeaderHeight = 50;
constexpr int kRowGap = 34;
constexpr int kMessageLineHeight = 24;
constexpr int kLegendHeight = 84;
constexpr int kMinMapPanel = 420;
constexpr int kMaxMapPanel = 560;
constexpr int kLegendSquare = 14;

constexpr int kTitleSize = 26;
constexpr int kLightNameSize = 21;
constexpr int kPanelTitleSize = 16;
constexpr int kCaptionSize = 14;

constexpr int kMostNameCharacters = 40;

constexpr int kMostMapsInLegend = 8;  // of a plan; the others have their numbers in the picture

// "3.08 times fewer than focused", or more: never a ratio below 1, which has to be read twice.
std::string GainText(const Figures& before, const Figures& after, absl::string_view name) {
  const double wrong_before = before.wrong_share.value_or(0.0);
  const double wrong_after = after.wrong_share.value_or(0.0);
  if (!(wrong_after > 0.0 && wrong_before > 0.0)) return absl::StrCat("beside ", name);
  const double gain = wrong_before / wrong_after;
  return absl::StrCat(FigureText(gain < 1 ? 1 / gain : gain),
                      gain < 1 ? " times more than " : " times fewer than ",
                      name);
}

// The answer beside a map of that name and the published one; or why there is no such map.
std::string Verdict(const FitComparison& light,
                    const absl::StatusOr<JudgedMatrix>& before,
                    const char* name,
                    const char* none) {
  std::string text = before.ok() ? absl::StrCat("wrong pixels foretold: ",
                                                GainText(before->figures, light.figures(), name))
                                 : none;
  if (light.published.ok()) {
    absl::StrAppend(
        &text, ", ", GainText(light.published->figures, light.figures(), "as published"));
  }
  return text;
}

std::string FiguresText(const Figures& figures) {
  return absl::StrFormat("%s %% of the image wrong; texel footprint: rms %s, 99 %% %s px",
                         PercentText(figures.wrong_share.value_or(0.0)),
                         FigureText(figures.footprint.rms),
                         FigureText(figures.footprint.p99));
}

bool IsBehind(const FitComparison& light, const absl::StatusOr<JudgedMatrix>& before) {
  return before.ok() && light.figures().wrong_share > before->figures.wrong_share;
}

}  // namespace

FitLayout::FitLayout(const Readback& readback, bool has_plans) : heat(HeatPanelSize(readback)) {
  map_panel = std::clamp(heat.height, kMinMapPanel, kMaxMapPanel);
  panel_height = std::max(heat.height, map_panel);
  const int last_x = has_plans ? std::max(MapX(1), PlanMapsX()) : MapX(1);
  width = last_x + map_panel + kMargin;
}

int FitLayout::HeatX(int panel) const { return kMargin + panel * (heat.width + kGap); }
int FitLayout::BarX() const { return HeatX(1) + heat.width + kGap; }
int FitLayout::MapX(int panel) const {
  return BarX() + kColorBarSpace + panel * (map_panel + kGap);
}
int FitLayout::PlanMapsX() const { return CellsX() + heat.width + kGap; }
int FitLayout::TextWidth() const { return width - 2 * kMargin; }

int FitRows::Height(const FitLayout& layout,
                    const std::vector<std::vector<std::string>>& messages) {
  int height = kTitleHeight + kLegendHeight;
  for (const std::vector<std::string>& lines : messages) {
    height += kRowHeaderHeight + kRowGap;
    height += lines.empty() ? kPanelHeaderHeight + layout.panel_height
                            : kMessageLineHeight * static_cast<int>(lines.size());
  }
  return height;
}

FitRows::FitRows(const FitLayout& layout,
                 const LogScale& scale,
                 int height,
                 const Typeface& typeface)
    : layout_(layout),
      scale_(scale),
      typeface_(typeface),
      canvas_(layout.width, height, kPageColor) {}

void FitRows::DrawTitle(const std::string& title, const std::string& sizes) {
  const TextStyle style = {.size_px = kTitleSize, .color = kTextColor, .bold = true};
  Text(kMargin, kMargin + 20, typeface_.Fitted(title, layout_.width - 2 * kMargin, style), style);
  Text(layout_.width - kMargin,
       kMargin + 18,
       sizes,
       {.size_px = 17, .color = kFaintTextColor, .anchor = Anchor::kRight});
  y_ = kTitleHeight;
}

void FitRows::DrawFailedRow(const std::string& light_name,
                            const std::string& words,
                            const std::vector<std::string>& message) {
  HeaderLine(light_name, words, kWarningColor);
  for (const std::string& line : message) {
    Text(kMargin, y_ + 16, line, {.size_px = 16, .color = kTextColor});
    y_ += kMessageLineHeight;
  }
  y_ += kRowGap;
}

void FitRows::DrawMatrixRow(const Readback& readback,
                            const FitComparison& light,
                            const LightPanels& panels,
                            const std::string& after) {
  RowHeader(light,
            Verdict(light, light.focused, "focused", "no focused map has room for all receivers"),
            IsBehind(light, light.focused));
  const auto draw = [&](int column,
                        const std::string& heat_title,
                        const std::string& map_title,
                        const JudgedMatrix& judged,
                        const MatrixPanels& of_matrix) {
    PanelHeader(layout_.HeatX(column), heat_title, FiguresText(judged.figures));
    HeatPanel(column, readback, light, panels, of_matrix.footprints);
    PanelHeader(
        layout_.MapX(column),
        map_title,
        absl::StrFormat("%s hull fills %.0f %% of the map",
                        judged.matrix.border == Border::kDark ? "dark border; the lit surfaces'"
                                                              : "the shadows'",
                        100 * of_matrix.view.hull_share));
    canvas_.DrawCanvas(
        layout_.MapX(column),
        panels_y(),
        DrawMapPanel(of_matrix.view, judged.matrix.map, layout_.map_panel, typeface_));
  };
  if (panels.before.has_value()) {
    draw(0, "Before: focused map", "Map before", *light.focused, *panels.before);
  } else {
    PanelHeader(layout_.HeatX(0), "Before: none", "the focused map would have to look all around");
  }
  draw(1, absl::StrCat("After: ", after), "Map after", *light.final, *panels.after);
  ScaleBar();
  EndRow();
}

void FitRows::DrawPlanRow(const Readback& readback,
                          const FitComparison& light,
                          const LightPanels& panels) {
  RowHeader(light,
            Verdict(light, light.final, "one map", "no single map has room for all receivers"),
            IsBehind(light, light.final));
  const JudgedPlan& judged = **light.plan;
  const Plan plan = PlanOf(judged.plan);
  if (panels.before.has_value()) {
    const MapSize one = light.final->matrix.map;
    PanelHeader(layout_.HeatX(0),
                absl::StrFormat("Before: one map, %d x %d", one.width, one.height),
                FiguresText(light.final->figures));
    HeatPanel(0, readback, light, panels, panels.before->footprints);
  } else {
    PanelHeader(layout_.HeatX(0), "Before: none", "a single map would have to look all around");
  }
  PanelHeader(
      layout_.HeatX(1),
      absl::StrCat("After: a plan of ", plan.maps.size(), plan.maps.size() == 1 ? " map" : " maps"),
      FiguresText(judged.figures));
  HeatPanel(1, readback, light, panels, panels.plan->footprints);
  ScaleBar();
  PanelHeader(layout_.CellsX(),
              "Which map a pixel asks",
              absl::StrFormat("%.3g %% of the surfaces outside of all maps: %s",
                              100 * panels.plan->view.outside_share,
                              plan.border == Border::kDark ? "dark" : "lit"));
  canvas_.DrawCanvas(
      layout_.CellsX(),
      panels_y(),
      DrawCellsPanel(readback, light.light, panels.plan->view, panels.samples, typeface_));
  PanelHeader(layout_.PlanMapsX(),
              "The maps",
              absl::StrCat(NumTexels(plan), " texels in all; grey: asks another map"));
  canvas_.DrawCanvas(layout_.PlanMapsX(),
                     panels_y(),
                     DrawPlanMaps(panels.plan->view,
                                  plan,
                                  layout_.width - kMargin - layout_.PlanMapsX(),
                                  layout_.panel_height,
                                  typeface_));
  EndRow();
}

void FitRows::DrawLegend() {
  Legend({{FootprintColor(0.15), "texels finer than a pixel"},
          {FootprintColor(0.5), "as fine"},
          {FootprintColor(0.85), "coarser"},
          {Mix(FootprintColor(0.5), {}, 0.4f), "darker: in shadow"},
          {kBoundaryColor, "shadow edge that counts"},
          {kUnratedColor, "not rated: turned away or edge-on"},
          {kReceiverColor, "visible surface in the map"},
          {kSampleColor, "shadow edge in the map"},
          {kHullColor, "hull of what needs room"}},
         "Footprint: how many read-back pixels one shadow-map texel covers across, on the screen. "
         "Below 1 the map is finer than the read-back, above 1 coarser. Wrong: shadow pixels that "
         "will be wrong, foretold from the read-back. One colour scale for all lights.");
}

void FitRows::DrawPlanLegend(int max_maps) {
  std::vector<LegendEntry> entries = {{FootprintColor(0.15), "texels finer than a pixel"},
                                      {FootprintColor(0.5), "as fine"},
                                      {FootprintColor(0.85), "coarser"},
                                      {kBoundaryColor, "shadow edge that counts"},
                                      {kUnratedColor, "not rated, or in no map"},
                                      {kUnratedColor, "outside of all maps", true}};
  for (int k = 0; k < std::min(max_maps, kMostMapsInLegend); ++k) {
    entries.push_back({MapColor(k), absl::StrCat("map ", k)});
  }
  Legend(entries,
         "A pixel asks the map with the finest texels of those that hold it; darker: in shadow. "
         "Footprint: how many read-back pixels one texel covers across, on the screen. Wrong: "
         "shadow pixels that will be wrong, foretold from the read-back. One colour scale for all "
         "lights.");
}

void FitRows::Legend(const std::vector<LegendEntry>& entries, const std::string& text) {
  canvas_.FillRectangle(kMargin, y_ - 14, layout_.width - 2 * kMargin, 1, kRuleColor);
  int x = kMargin;
  for (const LegendEntry& entry : entries) {
    if (entry.is_hatched) {
      DrawHatchedSquare(x, y_ + 3, kLegendSquare, &canvas_);
    } else {
      canvas_.FillRectangle(x, y_ + 3, kLegendSquare, kLegendSquare, entry.color);
    }
    const TextStyle style = {.size_px = kCaptionSize, .color = kTextColor};
    Text(x + 21, y_ + 15, entry.text, style);
    x += 21 + typeface_.Width(entry.text, style) + 30;
  }
  Text(kMargin, y_ + 44, text, {.size_px = kCaptionSize, .color = kFaintTextColor});
}

void FitRows::Text(int x, int baseline, absl::string_view text, const TextStyle& style) {
  typeface_.Draw(x, baseline, text, style, &canvas_);
}

void FitRows::HeaderLine(const std::string& name, const std::string& words, Rgb color) {
  canvas_.FillRectangle(kMargin, y_, layout_.width - 2 * kMargin, 1, kRuleColor);
  const TextStyle style = {.size_px = kLightNameSize, .color = kTextColor, .bold = true};
  const std::string shown = Shortened(name, kMostNameCharacters);
  Text(kMargin, y_ + 30, shown, style);
  Text(kMargin + typeface_.Width(shown, style) + 22,
       y_ + 30,
       words,
       {.size_px = 18, .color = color});
  y_ += kRowHeaderHeight;
}

void FitRows::RowHeader(const FitComparison& light, const std::string& verdict, bool is_behind) {
  HeaderLine(light.light.name, verdict, is_behind ? kWarningColor : kGainColor);
  Text(layout_.width - kMargin,
       y_ - kRowHeaderHeight + 30,
       absl::StrFormat(
           "%d of %d shadow-edge pixels used", light.samples().used, light.samples().candidates),
       {.size_px = kPanelTitleSize, .color = kFaintTextColor, .anchor = Anchor::kRight});
}

void FitRows::PanelHeader(int x, const std::string& title, const std::string& caption) {
  Text(x, y_ + 17, title, {.size_px = kPanelTitleSize, .color = kTextColor, .bold = true});
  Text(x, y_ + 39, caption, {.size_px = kCaptionSize, .color = kFaintTextColor});
}

void FitRows::HeatPanel(int column,
                        const Readback& readback,
                        const FitComparison& light,
                        const LightPanels& panels,
                        const std::vector<float>& footprints) {
  canvas_.DrawImage(layout_.HeatX(column),
                    panels_y(),
                    DrawHeatPanel(readback, light.light, footprints, panels.samples, scale_));
}

void FitRows::ScaleBar() {
  Text(layout_.BarX(), panels_y() - 10, "px / texel", {.size_px = 13, .color = kFaintTextColor});
  DrawColorBar(layout_.BarX(), panels_y(), layout_.heat.height, scale_, typeface_, &canvas_);
}

int FitRows::panels_y() const { return y_ + kPanelHeaderHeight; }

void FitRows::EndRow() { y_ = panels_y() + layout_.panel_height + kRowGap; }

}  // namespace lightfit
