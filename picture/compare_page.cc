#include "picture/compare_page.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/number.h"
#include "base/table.h"
#include "jobs/compare/totals.h"
#include "jobs/schemes/asked_maps.h"
#include "picture/bar_chart.h"
#include "picture/compare_choice.h"
#include "picture/shadow_panel.h"
#include "picture/theme.h"

namespace lightfit {
namespace {

// Pixels.
constexpr int kMargin = 36;
constexpr int kGap = 18;
constexpr int kTitleHeight = 92;
constexpr int kHeaderHeight = 54;
constexpr int kCropGap = 6;
constexpr int kRowGap = 26;
constexpr int kLegendHeight = 64;
constexpr int kNoteHeight = 22;
constexpr int kMaxPanel = 400;  // along the longer side
constexpr int kFrameWidth = 2;

constexpr int kTitleSize = 26;
constexpr int kNameSize = 19;
constexpr int kCaptionSize = 15;

constexpr int kMostNameCharacters = 24;  // in the chart

constexpr int kMaxColumns = 4;
constexpr int kCropPixels = 62;  // about the crop's width in image pixels
constexpr double kCropAspect = 0.62;

struct Layout {
  int reduced = 1, magnified = 1;  // image pixels to panel pixels; one of the two is 1
  int panel_width = 0, panel_height = 0;
  int crop_factor = 1;
  CropBox crop;  // of the image
  int columns = 1, rows = 1;
  int notes_height = 0;  // of what is said of methods without maps

  int cell_height() const {
    return kHeaderHeight + panel_height + kCropGap + crop.height * crop_factor + kRowGap;
  }
  int width() const { return 2 * kMargin + columns * panel_width + (columns - 1) * kGap; }
  int height() const { return kTitleHeight + rows * cell_height() + notes_height + kLegendHeight; }
};

int ColumnsFor(int num_panels) {
  if (num_panels <= kMaxColumns) return num_panels;
  return num_panels <= 6 ? 3 : kMaxColumns;
}

Layout LayoutFor(int width, int height, int num_panels) {
  Layout layout;
  const int longer = std::max(width, height);
  layout.magnified = std::max(1, kMaxPanel / longer);
  while (longer > kMaxPanel * layout.reduced) ++layout.reduced;
  layout.panel_width = (width * layout.magnified + layout.reduced - 1) / layout.reduced;
  layout.panel_height = (height * layout.magnified + layout.reduced - 1) / layout.reduced;
  layout.crop_factor = std::max(layout.magnified + 1, layout.panel_width / kCropPixels);
  layout.crop.width = std::clamp(layout.panel_width / layout.crop_factor, 1, width);
  layout.crop.height =
      std::clamp(static_cast<int>(std::lround(kCropAspect * layout.crop.width)), 1, height);
  layout.columns = ColumnsFor(num_panels);
  layout.rows = (num_panels + layout.columns - 1) / layout.columns;
  return layout;
}

class Page {
 public:
  Page(const CompareStage& stage,
       const LightComparison& light,
       const ComparePictureOptions& options,
       const Layout& layout,
       const Typeface& typeface)
      : stage_(stage),
        light_(light),
        options_(options),
        layout_(layout),
        typeface_(typeface),
        exposure_(ExposureFor(stage.screen, light.light, light.truth)),
        canvas_(layout.width(), layout.height(), kPageColor) {}

  Canvas TakeCanvas() { return std::move(canvas_); }

  void DrawTitle() {
    const TextStyle title = {.size_px = kTitleSize, .color = kTextColor, .bold = true};
    Text(kMargin, kMargin + 18, TitleText(title), title);
    const Camera& camera = stage_.screen.camera;
    Text(
        kMargin,
        kMargin + 44,
        absl::StrFormat("screen %d x %d pixels, %s; %s%s",
                        camera.width,
                        camera.height,
                        options_.maps,
                        options_.bias == Bias::kIdeal ? "ideal bias: sampling error alone"
                                                      : "practical bias, as in a renderer",
                        options_.phases > 1
                            ? absl::StrFormat("; counts are means of %d phases, the first is drawn",
                                              options_.phases)
                            : ""),
        {.size_px = 16, .color = kFaintTextColor});
  }

  void DrawTruth() {
    const LightingCounts& counts = light_.lighting;
    const int64_t judged = counts.lit + counts.shadowed;
    Header(
        "truth",
        absl::StrCat(PercentText(judged > 0 ? static_cast<double>(counts.shadowed) / judged : 0.0),
                     " % of what faces the light in shadow"),
        kTextColor);
    DrawShadows(light_.truth, {});
    ++cell_;
  }

  void DrawRow(const ComparedRow& row) {
    const bool is_ours = &row == &light_.lightfit();
    const int64_t count = CountOf(row, options_.bias);
    std::string caption = absl::StrCat(count, count == 1 ? " wrong pixel" : " wrong pixels");
    const int num_maps = NumMaps(row.drawn);
    if (num_maps > 1) absl::StrAppend(&caption, ", ", num_maps, " maps");
    if (row.border() == Border::kDark) caption += ", dark border";
    if (!is_ours && HasImage(light_.lightfit())) {
      const std::optional<double> ratio =
          RatioOf(static_cast<double>(count),
                  static_cast<double>(CountOf(light_.lightfit(), options_.bias)));
      if (ratio.has_value()) absl::StrAppend(&caption, ", ", FigureText(*ratio), " x lightfit");
    }
    const std::string texels =
        row.drawn.has_other_texels ? absl::StrCat(" (", NumTexels(row.drawn), " texels)") : "";
    Header(row.name, caption, is_ours ? kGainColor : kTextColor, texels);
    DrawShadows(
        ShadowsOf(row, options_.bias),
        num_maps > 1 ? AskedMaps(row.drawn, light_.light, stage_.screen) : std::vector<int>());
    ++cell_;
  }

  // In a cell that no method needs: how many wrong pixels each has.
  void DrawBars(const std::vector<const ComparedRow*>& maps) {
    if (cell_ >= layout_.columns * layout_.rows) return;
    std::vector<Bar> bars;
    for (const ComparedRow* map : maps) {
      if (!HasImage(*map)) continue;
      const Rgb color = map == &light_.lightfit() ? kGainColor : kReceiverColor;
      bars.push_back(
          {Shortened(map->name, kMostNameCharacters), CountOf(*map, options_.bias), color});
    }
    if (bars.empty()) return;
    Header("all methods", "wrong pixels; fewer is better", kTextColor);
    DrawBarChart(
        X(), PanelY(), layout_.panel_width, layout_.panel_height, bars, typeface_, &canvas_);
  }

  // Below the panels: why methods have none.
  void DrawNotes(const std::vector<std::string>& lines) {
    int y = layout_.height() - kLegendHeight - layout_.notes_height + 6;
    for (const std::string& line : lines) {
      Text(kMargin, y, line, {.size_px = kCaptionSize, .color = kWarningColor});
      y += kNoteHeight;
    }
  }

  void DrawLegend() {
    int x = kMargin;
    const int y = layout_.height() - kLegendHeight + 12;
    canvas_.FillRectangle(kMargin, y - 14, layout_.width() - 2 * kMargin, 1, kRuleColor);
    const ComparedRow* rival = Rival(light_, options_.bias);
    const std::string crop =
        absl::StrFormat("crop, %d times enlarged: where %s and lightfit differ most",
                        layout_.crop_factor,
                        rival == nullptr ? "a map" : rival->name);
    for (const auto& [color, text] :
         {std::pair{kFalseShadowColor, std::string("dark, should be lit")},
          std::pair{kLightLeakColor, std::string("lit, should be dark")},
          std::pair{kCropColor, crop}}) {
      canvas_.FillRectangle(x, y + 3, 14, 14, color);
      const TextStyle style = {.size_px = kCaptionSize, .color = kTextColor};
      Text(x + 21, y + 15, text, style);
      x += 21 + typeface_.Width(text, style) + 30;
    }
    if (!options_.has_plans) return;
    Text(kMargin,
         y + 37,
         "tint: which of its maps a pixel asks; of pages, which level",
         {.size_px = kCaptionSize, .color = kFaintTextColor});
  }

 private:
  int X() const { return kMargin + (cell_ % layout_.columns) * (layout_.panel_width + kGap); }
  int PanelY() const {
    return kTitleHeight + (cell_ / layout_.columns) * layout_.cell_height() + kHeaderHeight;
  }

  void Text(int x, int baseline, absl::string_view text, const TextStyle& style) {
    typeface_.Draw(x, baseline, text, style, &canvas_);
  }

  // The scene and the light, each shortened where there is no room for both.
  std::string TitleText(const TextStyle& style) const {
    constexpr char kComma[] = ", ";
    const int room = layout_.width() - 2 * kMargin - typeface_.Width(kComma, style);
    const int others = room - typeface_.Width(options_.title, style);
    const std::string light =
        typeface_.Fitted(light_.light.name, std::max(others, room / 2), style);
    return absl::StrCat(
        typeface_.Fitted(options_.title, room - typeface_.Width(light, style), style),
        kComma,
        light);
  }

  // `more` follows the name, which is shortened where the panel is too narrow for both.
  void Header(const std::string& name,
              const std::string& caption,
              Rgb color,
              const std::string& more = "") {
    const TextStyle style = {.size_px = kNameSize, .color = color, .bold = true};
    const int room = layout_.panel_width - typeface_.Width(more, style);
    Text(X(), PanelY() - 32, absl::StrCat(typeface_.Fitted(name, room, style), more), style);
    Text(X(), PanelY() - 11, caption, {.size_px = kCaptionSize, .color = kFaintTextColor});
  }

  // Tinted by `asked`, where there are several maps.
  void DrawShadows(const std::vector<Lighting>& shadows, const std::vector<int>& asked) {
    const Image full =
        ShadeShadows(stage_.screen, light_.light, light_.truth, shadows, asked, exposure_);
    const Image panel = layout_.magnified > 1
                            ? Magnified(full, layout_.magnified)
                            : ReducedPanel(full, WrongMask(light_.truth, shadows), layout_.reduced);
    canvas_.DrawImage(X(), PanelY(), panel);
    const auto scaled = [this](int pixels) { return pixels * layout_.magnified / layout_.reduced; };
    Frame(X() + scaled(layout_.crop.x) - kFrameWidth,
          PanelY() + scaled(layout_.crop.y) - kFrameWidth,
          scaled(layout_.crop.width) + 2 * kFrameWidth,
          scaled(layout_.crop.height) + 2 * kFrameWidth);
    const Image crop = EnlargedCrop(full, layout_.crop, layout_.crop_factor);
    const int crop_y = PanelY() + layout_.panel_height + kCropGap;
    canvas_.DrawImage(X(), crop_y, crop);
    Frame(X(), crop_y, crop.width(), crop.height());
  }

  // A frame whose outer edge is this rectangle.
  void Frame(int x, int y, int width, int height) {
    canvas_.FillRectangle(x, y, width, kFrameWidth, kCropColor);
    canvas_.FillRectangle(x, y + height - kFrameWidth, width, kFrameWidth, kCropColor);
    canvas_.FillRectangle(x, y, kFrameWidth, height, kCropColor);
    canvas_.FillRectangle(x + width - kFrameWidth, y, kFrameWidth, height, kCropColor);
  }

  const CompareStage& stage_;
  const LightComparison& light_;
  const ComparePictureOptions& options_;
  const Layout& layout_;
  const Typeface& typeface_;
  const Exposure exposure_;  // one for all panels
  Canvas canvas_;
  int cell_ = 0;
};

// "tsm, psm: no way": why methods without maps have none, the same words once for all of them.
std::vector<std::string> NotesOf(const std::vector<const ComparedRow*>& maps,
                                 int width,
                                 const Typeface& typeface) {
  std::vector<std::pair<std::string, std::string>> notes;  // names, words
  for (const ComparedRow* map : maps) {
    if (HasImage(*map)) continue;
    const std::string words(map->status.message());
    const auto known = std::find_if(
        notes.begin(), notes.end(), [&words](const auto& note) { return note.second == words; });
    if (known == notes.end()) {
      notes.emplace_back(map->name, words);
    } else {
      absl::StrAppend(&known->first, "; ", map->name);  // some names have commas
    }
  }
  std::vector<std::string> lines;
  for (const auto& [names, words] : notes) {
    for (std::string& line : typeface.Wrapped(absl::StrCat("No picture of ", names, ": ", words),
                                              width,
                                              {.size_px = kCaptionSize})) {
      lines.push_back(std::move(line));
    }
  }
  return lines;
}

}  // namespace

Canvas DrawComparePicture(const CompareStage& stage,
                          const LightComparison& light,
                          const ComparePictureOptions& options,
                          const Typeface& typeface) {
  const Camera& camera = stage.screen.camera;
  const std::vector<const ComparedRow*> maps = InOrder(light, options.bias);
  const auto num_drawn = std::count_if(
      maps.begin(), maps.end(), [](const ComparedRow* map) { return HasImage(*map); });
  Layout layout = LayoutFor(camera.width, camera.height, static_cast<int>(num_drawn) + 1);
  const std::vector<std::string> notes = NotesOf(maps, layout.width() - 2 * kMargin, typeface);
  if (!notes.empty()) layout.notes_height = kNoteHeight * (static_cast<int>(notes.size()) + 1);
  layout.crop = ChooseCrop(light, options.bias, camera.width, camera.height, layout.crop);
  Page page(stage, light, options, layout, typeface);
  page.DrawTitle();
  page.DrawTruth();
  for (const ComparedRow* map : maps) {
    if (HasImage(*map)) page.DrawRow(*map);
  }
  page.DrawBars(maps);
  page.DrawNotes(notes);
  page.DrawLegend();
  return page.TakeCanvas();
}

}  // namespace lightfit
