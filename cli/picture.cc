#include "cli/picture.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "cli/color_map.h"
#include "cli/heat_panel.h"
#include "cli/map_panel.h"
#include "cli/number.h"
#include "cli/theme.h"
#include "optimizer/footprint_image.h"

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

// Everything that is drawn for one light.
struct Row {
  absl::Status status;
  std::vector<uint8_t> samples;
  std::vector<float> footprints[2];  // before, after
  MapView views[2];
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

// Pixels that are receivers, in the order of ReceiverPositions(), tell which receivers are samples.
std::vector<uint8_t> SamplesOfReceivers(const Readback& readback,
                                        const std::vector<uint8_t>& samples) {
  const AffineDepth depth(readback.camera, readback.depth_kind);
  std::vector<uint8_t> chosen;
  for (size_t pixel = 0; pixel < samples.size(); ++pixel) {
    if (depth.IsSurface(readback.depth[pixel])) chosen.push_back(samples[pixel]);
  }
  return chosen;
}

absl::StatusOr<Row> MakeRow(const Readback& readback,
                            const std::vector<Eigen::Vector3d>& receivers,
                            const Comparison& light,
                            MapSize map,
                            const SampleOptions& options) {
  Row row;
  row.status = light.final.ok() ? light.focused.status() : light.final.status();
  if (!row.status.ok()) return row;
  absl::StatusOr<std::vector<uint8_t>> samples = SampleImage(readback, light.light, options);
  if (!samples.ok()) return samples.status();
  row.samples = *std::move(samples);
  const std::vector<uint8_t> receiver_is_sample = SamplesOfReceivers(readback, row.samples);
  if (receiver_is_sample.size() != receivers.size()) {
    return absl::InternalError("picture: receivers and surface pixels differ in number");
  }
  const Eigen::Matrix4d matrices[] = {light.focused->map_from_world, light.final->map_from_world};
  for (int i = 0; i < 2; ++i) {
    absl::StatusOr<std::vector<float>> footprints =
        FootprintImage(readback, light.light, matrices[i], options);
    if (!footprints.ok()) return footprints.status();
    row.footprints[i] = *std::move(footprints);
    row.views[i] = ViewMap(receivers, receiver_is_sample, matrices[i], map);
  }
  return row;
}

// One scale for before and after; every light has its own, as lights may differ a thousandfold.
LogScale SharedScale(const Row& row) {
  std::vector<float> all = row.footprints[0];
  all.insert(all.end(), row.footprints[1].begin(), row.footprints[1].end());
  return ScaleFor(all);
}

// "3.08 times lower than focused", or higher: never a ratio below 1, which has to be read twice.
std::string GainText(const LightMatrix& before, const LightMatrix& after, absl::string_view name) {
  if (!(after.energy > 0 && before.energy > 0)) return "";
  const double gain = before.energy / after.energy;
  return absl::StrCat(FigureText(gain < 1 ? 1 / gain : gain),
                      gain < 1 ? " times higher than " : " times lower than ",
                      name);
}

std::string Verdict(const Comparison& light) {
  std::string text = absl::StrCat("energy ", GainText(*light.focused, *light.final, "focused"));
  if (light.published.ok()) {
    absl::StrAppend(&text, ", ", GainText(*light.published, *light.final, "as published"));
  }
  return text;
}

// Breaks at spaces so that no line is wider than `max_width` pixels.
std::vector<std::string> Wrapped(absl::string_view text,
                                 int max_width,
                                 const TextStyle& style,
                                 const Typeface& typeface) {
  std::vector<std::string> lines(1);
  for (const absl::string_view word : absl::StrSplit(text, ' ')) {
    const std::string longer =
        lines.back().empty() ? std::string(word) : absl::StrCat(lines.back(), " ", word);
    if (!lines.back().empty() && typeface.Width(longer, style) > max_width) {
      lines.emplace_back(word);
    } else {
      lines.back() = longer;
    }
  }
  return lines;
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
               const Comparison& light,
               const Row& row,
               MapSize map,
               const std::string& final_label) {
    const LightMatrix* matrices[] = {&*light.focused, &*light.final};
    RowHeader(light.light.name, Verdict(light), kGainColor);
    const SampleCounts& counts = matrices[1]->samples;
    Text(layout_.width - kMargin,
         y_ - kRowHeaderHeight + 30,
         absl::StrFormat("%d of %d shadow-edge pixels used", counts.used, counts.candidates),
         {.size_px = kPanelTitleSize, .color = kFaintTextColor, .anchor = Anchor::kRight});
    const std::string names[] = {"Before: focused map", absl::StrCat("After: ", final_label)};
    const LogScale scale = SharedScale(row);
    const int panels_y = y_ + kPanelHeaderHeight;
    for (int i = 0; i < 2; ++i) {
      const LightMatrix& matrix = *matrices[i];
      PanelHeader(layout_.HeatX(i),
                  names[i],
                  absl::StrFormat("energy %s, texel footprint: rms %s, worst %s px",
                                  FigureText(matrix.energy),
                                  FigureText(matrix.footprint.rms),
                                  FigureText(matrix.footprint.worst)));
      canvas_.DrawImage(
          layout_.HeatX(i),
          panels_y,
          DrawHeatPanel(readback, light.light, row.footprints[i], row.samples, scale));
      PanelHeader(layout_.MapX(i),
                  absl::StrCat("Map ", i == 0 ? "before" : "after"),
                  absl::StrFormat("receivers' hull fills %.0f %% of the map",
                                  100 * row.views[i].hull_share));
      canvas_.DrawImage(
          layout_.MapX(i), panels_y, DrawMapPanel(row.views[i], map, layout_.map_panel, typeface_));
    }
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
          std::pair{kUnratedColor, "not rated: turned away, edge-on or at a depth edge"},
          std::pair{kReceiverColor, "visible surface in the map"},
          std::pair{kSampleColor, "shadow edge in the map"},
          std::pair{kHullColor, "hull of the visible surface"}}) {
      canvas_.FillRectangle(x, y_ + 3, 14, 14, color);
      const TextStyle style = {.size_px = kCaptionSize, .color = kTextColor};
      Text(x + 21, y_ + 15, text, style);
      x += 21 + typeface_.Width(text, style) + 30;
    }
    Text(kMargin,
         y_ + 44,
         "Footprint: how many read-back pixels one shadow-map texel covers across, on the screen. "
         "Below 1 the map is finer than the read-back, above 1 coarser. Energy: footprints "
         "(l2: squared) summed along the shadow edges; lower is better. Each light has its own "
         "colour scale.",
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

absl::StatusOr<Canvas> DrawPicture(const Readback& readback,
                                   const std::vector<Comparison>& lights,
                                   MapSize map,
                                   const PictureOptions& options,
                                   const Typeface& typeface) {
  const absl::StatusOr<std::vector<Eigen::Vector3d>> receivers = ReceiverPositions(readback);
  if (!receivers.ok()) return receivers.status();
  const Layout layout = LayoutFor(readback);
  std::vector<Row> rows;
  std::vector<std::vector<std::string>> messages;
  int height = kTitleHeight + kLegendHeight;
  for (const Comparison& light : lights) {
    absl::StatusOr<Row> row = MakeRow(readback, *receivers, light, map, options.samples);
    if (!row.ok()) return row.status();
    rows.push_back(*std::move(row));
    const absl::Status& status = rows.back().status;
    messages.push_back(Wrapped(
        std::string(status.message()), layout.width - 2 * kMargin, {.size_px = 16}, typeface));
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
