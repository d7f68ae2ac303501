// picture/fit_rows.h
//
// The page of a fit while it is being filled: title, a row for each light, what the colours mean.
// In:   what MakeLightPanels() makes.
// Out:  a Canvas.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "jobs/fit_comparison.h"
#include "optimizer/readback/readback.h"
#include "picture/canvas.h"
#include "picture/color_map.h"
#include "picture/fit_panels.h"
#include "picture/heat_panel.h"
#include "picture/text.h"

namespace lightfit {

// Where things are, pixels.
struct FitLayout {
  PanelSize heat;
  int map_panel = 0;
  int panel_height = 0;
  int width = 0;

  // Rows with plans may be wider: they have a third panel of the screen.
  FitLayout(const Readback& readback, bool has_plans);

  int HeatX(int panel) const;
  int BarX() const;
  int MapX(int panel) const;
  int CellsX() const { return MapX(0); }
  int PlanMapsX() const;

  int TextWidth() const;  // of a message across the page
};

class FitRows {
 public:
  // Of a page that holds these rows; `messages` are lines of text instead of panels.
  static int Height(const FitLayout& layout, const std::vector<std::vector<std::string>>& messages);

  // `scale` is that of all footprints.
  FitRows(const FitLayout& layout, const LogScale& scale, int height, const Typeface& typeface);

  void DrawTitle(const std::string& title, const std::string& sizes);
  // `words` say what there is none of.
  void DrawFailedRow(const std::string& light_name,
                     const std::string& words,
                     const std::vector<std::string>& message);
  // `after` says what the final matrix is.
  void DrawMatrixRow(const Readback& readback,
                     const FitComparison& light,
                     const LightPanels& panels,
                     const std::string& after);
  void DrawPlanRow(const Readback& readback, const FitComparison& light, const LightPanels& panels);
  void DrawLegend();
  // Of a page with plans: of at most so many maps.
  void DrawPlanLegend(int max_maps);

  Canvas TakeCanvas() { return std::move(canvas_); }

 private:
  struct LegendEntry {
    Rgb color;
    std::string text;
    bool is_hatched = false;
  };

  void Text(int x, int baseline, absl::string_view text, const TextStyle& style);
  void HeaderLine(const std::string& name, const std::string& words, Rgb color);
  void RowHeader(const FitComparison& light, const std::string& verdict, bool is_behind);
  void PanelHeader(int x, const std::string& title, const std::string& caption);
  void HeatPanel(int column,
                 const Readback& readback,
                 const FitComparison& light,
                 const LightPanels& panels,
                 const std::vector<float>& footprints);
  void ScaleBar();
  void Legend(const std::vector<LegendEntry>& entries, const std::string& text);
  int panels_y() const;  // of the row in work
  void EndRow();

  const FitLayout& layout_;
  const LogScale scale_;
  const Typeface& typeface_;
  Canvas canvas_;
  int y_ = 0;
};

}  // namespace lightfit
