#include "picture/fit_page.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/number.h"
#include "geometry/affine_depth.h"
#include "optimizer/figures/footprint_image.h"
#include "optimizer/readback/needed_surfaces.h"
#include "picture/color_map.h"
#include "picture/heat_panel.h"
#include "picture/map_panel.h"
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

constexpr int kTitleSize = 26;
constexpr int kLightNameSize = 21;
constexpr int kPanelTitleSize = 16;
constexpr int kCaptionSize = 14;

// What is drawn of one matrix.
struct Panels {
  std::vector<float> footprints;
  MapView view;
};

// Everything that is drawn for one light.
struct Row {
  absl::Status status;
  std::vector<uint8_t> samples;
  std::optional<Panels> before;  // absent where there is no focused map
  Panels after;
};

struct Layout {
  PanelSize heat;
  int map_panel = 0;
  int panel_height = 0;
  int width = 0;

  int HeatX(int panel) const { return kMargin + panel * (heat.width + kGap); }
  int BarX() const { return HeatX(1) + heat.width + kGap; }
  int MapX(int panel) const { return BarX() + kColorBarSpace + panel * (map_panel + kGap); }
};

Layout LayoutFor(const Readback& readback) {
  Layout layout;
  layout.heat = HeatPanelSize(readback);
  layout.map_panel = std::clamp(layout.heat.height, kMinMapPanel, kMaxMapPanel);
  layout.panel_height = std::max(layout.heat.height, layout.map_panel);
  layout.width = layout.MapX(1) + layout.map_panel + kMargin;
  return layout;
}

// The roles of the pixels that are receivers, in the order of ReceiverPositions().
std::vector<ReceiverRole> RolesOfReceivers(const Surfaces& surfaces,
                                           const Light& light,
                                           Border border,
                                           const std::vector<uint8_t>& samples) {
  const Readback& readback = surfaces.readback;
  const AffineDepth depth(readback.camera, readback.depth_kind);
  const NeededSurfaces needed(surfaces, light, border);
  std::vector<ReceiverRole> roles;
  for (size_t pixel = 0; pixel < samples.size(); ++pixel) {
    if (!depth.IsSurface(readback.depth[pixel])) continue;
    const bool needs_room = ((needed.words()[pixel] >> light.shadow_bit) & 1u) != 0;
    roles.push_back({needs_room, samples[pixel] != 0});
  }
  return roles;
}

absl::StatusOr<Row> MakeRow(const Surfaces& surfaces,
                            const std::vector<Eigen::Vector3d>& receivers,
                            const FitComparison& light,
                            MapSize map,
                            const SampleOptions& options) {
  const Readback& readback = surfaces.readback;
  Row row;
  row.status = light.final.status();
  if (!row.status.ok()) return row;
  absl::StatusOr<std::vector<uint8_t>> samples = SampleImage(surfaces, light.light, options);
  if (!samples.ok()) return samples.status();
  row.samples = *std::move(samples);
  const auto panels_of = [&](const JudgedMatrix& map_of_light) -> absl::StatusOr<Panels> {
    const Eigen::Matrix4d& matrix = map_of_light.matrix.map_from_world;
    const std::vector<ReceiverRole> roles =
        RolesOfReceivers(surfaces, light.light, map_of_light.matrix.border, row.samples);
    if (roles.size() != receivers.size()) {
      return absl::InternalError("picture: receivers and surface pixels differ in number");
    }
    absl::StatusOr<std::vector<float>> footprints =
        FootprintImage(readback, light.light, matrix, options);
    if (!footprints.ok()) return footprints.status();
    return Panels{*std::move(footprints), ViewMap(receivers, roles, matrix, map)};
  };
  absl::StatusOr<Panels> after = panels_of(*light.final);
  if (!after.ok()) return after.status();
  row.after = *std::move(after);
  if (!light.focused.ok()) return row;
  absl::StatusOr<Panels> before = panels_of(*light.focused);
  if (!before.ok()) return before.status();
  row.before = *std::move(before);
  return row;
}

// One scale for before and after; every light has its own, as lights may differ a thousandfold.
LogScale SharedScale(const Row& row) {
  std::vector<float> all = row.after.footprints;
  if (row.before.has_value()) {
    all.insert(all.end(), row.before->footprints.begin(), row.before->footprints.end());
  }
  return ScaleFor(all);
}

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

std::string Verdict(const FitComparison& light) {
  const Figures& final = light.final->figures;
  std::string text = light.focused.ok()
                         ? absl::StrCat("wrong pixels foretold: ",
                                        GainText(light.focused->figures, final, "focused"))
                         : "no focused map has room for all receivers";
  if (light.published.ok()) {
    absl::StrAppend(&text, ", ", GainText(light.published->figures, final, "as published"));
  }
  return text;
}

// A drawing in progress: the page, and how far down it is filled.
class Page {
 public:
  Page(const Layout& layout, int height, const Typeface& typeface)
      : layout_(layout), typeface_(typeface), canvas_(layout.width, height, kPageColor) {}

  Canvas TakeCanvas() { return std::move(canvas_); }

  void DrawTitle(const Readback& readback, MapSize map, const std::string& title) {
    Text(kMargin, kMargin + 20, title, {.size_px = kTitleSize, .color = kTextColor, .bold = true});
    Text(layout_.width - kMargin,
         kMargin + 18,
         absl::StrFormat("read-back %d x %d pixels, shadow map %d x %d texels",
                         readback.width(),
                         readback.height(),
                         map.width,
                         map.height),
         {.size_px = 17, .color = kFaintTextColor, .anchor = Anchor::kRight});
    y_ = kTitleHeight;
  }

  void DrawFailedRow(const std::string& light_name, const std::vector<std::string>& message) {
    RowHeader(light_name, "no matrix", kWarningColor);
    for (const std::string& line : message) {
      Text(kMargin, y_ + 16, line, {.size_px = 16, .color = kTextColor});
      y_ += kMessageLineHeight;
    }
    y_ += kRowGap;
  }

  void DrawRow(const Readback& readback,
               const FitComparison& light,
               const Row& row,
               MapSize map,
               const std::string& final_label) {
    const bool is_behind =
        light.focused.ok() && light.final->figures.wrong_share > light.focused->figures.wrong_share;
    RowHeader(light.light.name, Verdict(light), is_behind ? kWarningColor : kGainColor);
    const SampleCounts& counts = light.final->matrix.figures.samples;
    Text(layout_.width - kMargin,
         y_ - kRowHeaderHeight + 30,
         absl::StrFormat("%d of %d shadow-edge pixels used", counts.used, counts.candidates),
         {.size_px = kPanelTitleSize, .color = kFaintTextColor, .anchor = Anchor::kRight});
    const LogScale scale = SharedScale(row);
    const int panels_y = y_ + kPanelHeaderHeight;
    const auto draw = [&](int column,
                          const std::string& heat_title,
                          const std::string& map_title,
                          const JudgedMatrix& judged,
                          const Panels& panels) {
      const Figures& figures = judged.figures;
      const bool is_dark = judged.matrix.border == Border::kDark;
      PanelHeader(layout_.HeatX(column),
                  heat_title,
                  absl::StrFormat("%s %% of the image wrong; texel footprint: rms %s, 99 %% %s px",
                                  PercentText(figures.wrong_share.value_or(0.0)),
                                  FigureText(figures.footprint.rms),
                                  FigureText(figures.footprint.p99)));
      canvas_.DrawImage(
          layout_.HeatX(column),
          panels_y,
          DrawHeatPanel(readback, light.light, panels.footprints, row.samples, scale));
      PanelHeader(layout_.MapX(column),
                  map_title,
                  absl::StrFormat("%s hull fills %.0f %% of the map",
                                  is_dark ? "dark border; the lit surfaces'" : "the shadows'",
                                  100 * panels.view.hull_share));
      canvas_.DrawCanvas(layout_.MapX(column),
                         panels_y,
                         DrawMapPanel(panels.view, map, layout_.map_panel, typeface_));
    };
    if (row.before.has_value()) {
      draw(0, "Before: focused map", "Map before", *light.focused, *row.before);
    } else {
      PanelHeader(
          layout_.HeatX(0), "Before: none", "the focused map would have to look all around");
    }
    draw(1, absl::StrCat("After: ", final_label), "Map after", *light.final, row.after);
    Text(layout_.BarX(), panels_y - 10, "px / texel", {.size_px = 13, .color = kFaintTextColor});
    DrawColorBar(layout_.BarX(), panels_y, layout_.heat.height, scale, typeface_, &canvas_);
    y_ = panels_y + layout_.panel_height + kRowGap;
  }

  void DrawLegend() {
    canvas_.FillRectangle(kMargin, y_ - 14, layout_.width - 2 * kMargin, 1, kRuleColor);
    int x = kMargin;
    for (const auto& [color, text] :
         {std::pair{HeatColor(0.15), "fine texels"},
          std::pair{HeatColor(0.95), "coarse texels"},
          std::pair{Mix(HeatColor(0.5), {}, 0.45f), "darker: in shadow"},
          std::pair{kBoundaryColor, "shadow edge that counts"},
          std::pair{kUnratedColor, "not rated: turned away or edge-on"},
          std::pair{kReceiverColor, "visible surface in the map"},
          std::pair{kSampleColor, "shadow edge in the map"},
          std::pair{kHullColor, "hull of what needs room"}}) {
      canvas_.FillRectangle(x, y_ + 3, 14, 14, color);
      const TextStyle style = {.size_px = kCaptionSize, .color = kTextColor};
      Text(x + 21, y_ + 15, text, style);
      x += 21 + typeface_.Width(text, style) + 30;
    }
    Text(kMargin,
         y_ + 44,
         "Footprint: how many read-back pixels one shadow-map texel covers across, on the screen. "
         "Below 1 the map is finer than the read-back, above 1 coarser. Wrong: shadow pixels that "
         "will be wrong, foretold from the read-back. Each light has its own colour scale.",
         {.size_px = kCaptionSize, .color = kFaintTextColor});
  }

 private:
  void Text(int x, int baseline, absl::string_view text, const TextStyle& style) {
    typeface_.Draw(x, baseline, text, style, &canvas_);
  }

  void RowHeader(const std::string& name, const std::string& verdict, Rgb verdict_color) {
    canvas_.FillRectangle(kMargin, y_, layout_.width - 2 * kMargin, 1, kRuleColor);
    const TextStyle style = {.size_px = kLightNameSize, .color = kTextColor, .bold = true};
    Text(kMargin, y_ + 30, name, style);
    Text(kMargin + typeface_.Width(name, style) + 22,
         y_ + 30,
         verdict,
         {.size_px = 18, .color = verdict_color});
    y_ += kRowHeaderHeight;
  }

  void PanelHeader(int x, const std::string& title, const std::string& caption) {
    Text(x, y_ + 17, title, {.size_px = kPanelTitleSize, .color = kTextColor, .bold = true});
    Text(x, y_ + 39, caption, {.size_px = kCaptionSize, .color = kFaintTextColor});
  }

  const Layout& layout_;
  const Typeface& typeface_;
  Canvas canvas_;
  int y_ = 0;
};

}  // namespace

absl::StatusOr<Canvas> DrawPicture(const Surfaces& surfaces,
                                   const std::vector<FitComparison>& lights,
                                   MapSize map,
                                   const PictureOptions& options,
                                   const Typeface& typeface) {
  const Readback& readback = surfaces.readback;
  const absl::StatusOr<std::vector<Eigen::Vector3d>> receivers = ReceiverPositions(readback);
  if (!receivers.ok()) return receivers.status();
  const Layout layout = LayoutFor(readback);
  std::vector<Row> rows;
  std::vector<std::vector<std::string>> messages;
  int height = kTitleHeight + kLegendHeight;
  for (const FitComparison& light : lights) {
    absl::StatusOr<Row> row = MakeRow(surfaces, *receivers, light, map, options.samples);
    if (!row.ok()) return row.status();
    rows.push_back(*std::move(row));
    const absl::Status& status = rows.back().status;
    messages.push_back(typeface.Wrapped(
        std::string(status.message()), layout.width - 2 * kMargin, {.size_px = 16}));
    height += kRowHeaderHeight + kRowGap;
    height += status.ok() ? kPanelHeaderHeight + layout.panel_height
                          : kMessageLineHeight * static_cast<int>(messages.back().size());
  }

  Page page(layout, height, typeface);
  page.DrawTitle(readback, map, options.title);
  for (size_t i = 0; i < lights.size(); ++i) {
    if (rows[i].status.ok()) {
      page.DrawRow(readback, lights[i], rows[i], map, options.final_label);
    } else {
      page.DrawFailedRow(lights[i].light.name, messages[i]);
    }
  }
  page.DrawLegend();
  return page.TakeCanvas();
}

}  // namespace lightfit
