#include "cli/reports/compare_report.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/number.h"
#include "base/table.h"
#include "cli/reports/legend.h"

namespace lightfit::cli {
namespace {

constexpr char kPixelLegend[] =
    "Wrong pixels: where the shadow map says other than the truth. Ideal bias: sampling error "
    "alone;\n"
    "practical: with the bias of a renderer. x lightfit: how many times as many as lightfit.\n"
    "Outside: wrong pixels that lie outside the map.\n";
constexpr char kPhaseLegend[] =
    "Means of phases: of the map moved by parts of a texel, as one of them depends on where "
    "single\n"
    "texels fall.\n";
constexpr char kBorderNote[] =
    "Border: what look-ups outside the map must find; the matrix is of no use with the other.\n";
constexpr char kBorderLegend[] =
    "Where lightfit's border is dark, energy and footprints are over the edges that such a map "
    "serves,\n"
    "of every method.\n";
constexpr char kDarkLegend[] = "Dark: lights counted whose maps have a dark border.\n";
constexpr char kFigureLegend[] =
    "Foretold: wrong pixels that the read-back alone lets expect, of all pixels of the image.\n"
    "Energy: Chong and Gortler's, squared footprints summed; lower is better. As-published and "
    "line\n"
    "minimise it, over fewer pixels. Footprint: how far one texel reaches on the screen, in "
    "read-back\n"
    "pixels; below 1 is finer. Both are over the shadow-edge pixels that a fit takes by default,\n"
    "whatever the method took.\n";
constexpr char kCrawlLegend[] =
    "Crawl, to the next frame: how far points of the scene move within their texels, root mean "
    "square,\n"
    "0 (they stay) to 0.41 (drawn anew); and what that is across shadow edges, read-back pixels.\n";
constexpr char kFlipLegend[] =
    "Flips: pixels seen in both frames whose shadow changes though nothing moved, ideal bias, % of "
    "the\n"
    "judged.\n";
constexpr char kTotalLegend[] =
    "Totals count the lights for which both the method and lightfit have a map. Ratio: of total "
    "to\n"
    "lightfit's. Mean: geometric mean over the lights of (wrong + 1) / (wrong of lightfit + 1), "
    "and of\n"
    "energy / energy of lightfit. Better: lights with fewer wrong pixels than lightfit. Failed: "
    "lights\n"
    "without a map of the method.\n";
constexpr char kPlanLegend[] =
    "Maps, texels: what the method draws for the light, at most the texels of one map in all;\n"
    "plans from files (--matrix) keep their own. A pixel asks the finest map that holds it, or\n"
    "the one of the method's own rule, and finds the border where there is none. Energy and\n"
    "footprints are those of the map asked; edge pixels that ask none of several are in neither.\n"
    "Foretold: as if all methods asked the finest.\n";

std::string RatioText(const std::optional<double>& ratio) {
  return ratio.has_value() ? absl::StrCat(FigureText(*ratio), "x") : "-";
}

// What rows have to say, the same words once for all of them.
class Notes {
 public:
  void Add(const std::string& name, const std::string& words) {
    for (auto& [names, known_words] : notes_) {
      if (known_words != words) continue;
      absl::StrAppend(&names, ", ", name);
      return;
    }
    notes_.emplace_back(name, words);
  }

  std::string Text() const {
    std::string text = notes_.empty() ? "" : "\n";
    for (const auto& [names, words] : notes_) absl::StrAppend(&text, names, ": ", words, "\n");
    return text;
  }

 private:
  std::vector<std::pair<std::string, std::string>> notes_;
};

void AddCrawlColumns(bool has_truth, Table* table) {
  table->AddColumn("crawl", "texels");
  table->AddColumn("crawl", "pixels");
  if (has_truth) table->AddColumn("crawl", "% flips");
}

void AppendCrawlCells(const std::optional<MapCrawl>& crawl,
                      bool has_truth,
                      std::vector<std::string>* cells) {
  const bool is_known = crawl.has_value();
  cells->push_back(is_known && crawl->points.num_points > 0
                       ? FigureText(crawl->points.phase_drift_texels)
                       : "-");
  cells->push_back(is_known && crawl->points.num_edge_points > 0
                       ? FigureText(crawl->points.edge_crawl_px)
                       : "-");
  if (!has_truth) return;
  const std::optional<double> flips = is_known ? IdealFlipShare(*crawl) : std::nullopt;
  cells->push_back(flips.has_value() ? PercentText(*flips) : "-");
}

bool HasDarkBorder(const LightComparison& light) {
  return std::any_of(light.rows.begin(), light.rows.end(), [](const ComparedRow& row) {
    return row.status.ok() && row.border() == Border::kDark;
  });
}

bool HasTruth(const CompareHeading& heading) { return heading.screen_width > 0; }
bool HasCrawl(const CompareHeading& heading) { return !heading.next.empty(); }

// "sun: 262266 pixels lit ...", the table, the notes.
std::string LightText(const CompareHeading& heading, const LightComparison& light) {
  const bool has_truth = HasTruth(heading), has_crawl = HasCrawl(heading);
  Table table;
  table.AddColumn("", "method");
  const bool has_border = HasDarkBorder(light);
  if (has_border) table.AddColumn("", "border");
  if (heading.has_plans) {
    table.AddColumn("", "maps");
    table.AddColumn("", "texels");
  }
  if (has_truth) {
    table.AddColumn("wrong pixels", "ideal");
    table.AddColumn("wrong pixels", "practical");
    table.AddColumn("x lightfit", "ideal");
    table.AddColumn("x lightfit", "practical");
    table.AddColumn("pixels", "outside");
  }
  table.AddColumn("foretold", "% wrong");
  table.AddColumn("energy", "sum");
  table.AddColumn("energy", "x lightfit");
  table.AddColumn("footprint, px", "rms");
  table.AddColumn("footprint, px", "worst");
  if (has_crawl) AddCrawlColumns(has_truth, &table);
  Notes notes;
  for (const ComparedRow& row : light.rows) {
    if (!row.status.ok()) {
      table.AddRow({row.name, heading.has_plans ? "no maps, see below" : "no matrix, see below"});
      notes.Add(row.name, std::string(row.status.message()));
      continue;
    }
    if (!row.note.empty()) notes.Add(row.name, row.note);
    std::vector<std::string> cells = {row.name};
    if (has_border) cells.emplace_back(BorderName(row.border()));
    if (heading.has_plans) {
      cells.push_back(absl::StrCat(NumMaps(row.drawn)));
      cells.push_back(absl::StrCat(NumTexels(row.drawn)));
    }
    if (has_truth) {
      cells.push_back(absl::StrCat(row.wrong->ideal));
      cells.push_back(absl::StrCat(row.wrong->practical));
      cells.push_back(RatioText(WrongRatio(row, light.lightfit(), &WrongPixels::ideal)));
      cells.push_back(RatioText(WrongRatio(row, light.lightfit(), &WrongPixels::practical)));
      cells.push_back(absl::StrCat(row.wrong->outside));
    }
    cells.push_back(row.foretold.has_value() ? PercentText(*row.foretold) : "-");
    const bool measured = row.figures.has_value();
    cells.push_back(measured ? FigureText(row.figures->energy) : "-");
    cells.push_back(RatioText(EnergyRatio(row, light.lightfit())));
    cells.push_back(measured ? FigureText(row.figures->footprint.rms) : "-");
    cells.push_back(measured ? FigureText(row.figures->footprint.worst) : "-");
    if (has_crawl) AppendCrawlCells(row.crawl, has_truth, &cells);
    table.AddRow(std::move(cells));
  }
  std::string title = absl::StrCat(light.light.name, ": ");
  if (has_truth) {
    absl::StrAppendFormat(&title,
                          "%d pixels lit, %d in shadow, %d turned away; ",
                          light.lighting.lit,
                          light.lighting.shadowed,
                          light.lighting.facing_away);
  }
  absl::StrAppendFormat(&title, "%d shadow-edge pixels used\n\n", light.samples.used);
  return absl::StrCat(title, table.Text(), notes.Text());
}

void AppendPixelCells(const std::optional<MethodTotals::Pixels>& pixels,
                      std::vector<std::string>* cells) {
  if (!pixels.has_value()) return cells->insert(cells->end(), 4, "-"), void();
  cells->push_back(absl::StrCat(pixels->total));
  cells->push_back(RatioText(pixels->ratio));
  cells->push_back(RatioText(pixels->mean_ratio));
  cells->push_back(absl::StrCat(pixels->num_wins));
}

std::string TotalsText(const CompareHeading& heading, absl::Span<const LightComparison> lights) {
  const bool has_truth = HasTruth(heading), has_crawl = HasCrawl(heading);
  Table table;
  table.AddColumn("", "method");
  if (heading.has_plans) {
    table.AddColumn("maps", "mean");
    table.AddColumn("texels", "mean");
  }
  if (has_truth) {
    for (const char* bias : {"wrong pixels, ideal bias", "wrong pixels, practical bias"}) {
      for (const char* name : {"total", "ratio", "mean", "better"}) {
        table.AddColumn(bias, name);
      }
    }
  }
  table.AddColumn("energy", "mean");
  if (has_crawl) AddCrawlColumns(has_truth, &table);
  table.AddColumn("lights", "counted");
  table.AddColumn("lights", "failed");
  const bool has_border = std::any_of(lights.begin(), lights.end(), HasDarkBorder);
  if (has_border) table.AddColumn("lights", "dark");
  for (const MethodTotals& totals : TotalsOf(lights)) {
    std::vector<std::string> cells = {totals.name};
    if (heading.has_plans) {
      const bool has_maps = totals.num_lights > 0;
      cells.push_back(has_maps ? FigureText(totals.mean_maps) : "-");
      cells.push_back(has_maps ? absl::StrFormat("%.0f", totals.mean_texels) : "-");
    }
    if (has_truth) {
      AppendPixelCells(totals.ideal, &cells);
      AppendPixelCells(totals.practical, &cells);
    }
    cells.push_back(RatioText(totals.mean_energy_ratio));
    if (has_crawl) AppendCrawlCells(totals.crawl, has_truth, &cells);
    cells.push_back(absl::StrCat(totals.num_lights));
    cells.push_back(absl::StrCat(totals.num_failed));
    if (has_border) cells.push_back(absl::StrCat(totals.num_dark));
    table.AddRow(std::move(cells));
  }
  return absl::StrCat(lights.size(), " lights\n\n", table.Text());
}

}  // namespace

std::string MapText(MapSize map) {
  return absl::StrFormat("map %d x %d texels", map.width, map.height);
}

std::string CompareLegend() {
  return absl::StrCat(kPixelLegend,
                      kPhaseLegend,
                      kBorderLegend,
                      kFigureLegend,
                      kPlanLegend,
                      kCrawlLegend,
                      kFlipLegend,
                      kTotalLegend,
                      kDarkLegend);
}

std::string CompareReportText(const CompareHeading& heading,
                              absl::Span<const LightComparison> lights,
                              bool per_light,
                              bool has_legend) {
  const bool has_truth = HasTruth(heading);
  const bool is_mean = has_truth && heading.phases > 1;
  std::string text = absl::StrCat(heading.source, ": ");
  if (has_truth) {
    absl::StrAppendFormat(
        &text, "screen %d x %d pixels, ", heading.screen_width, heading.screen_height);
  }
  absl::StrAppendFormat(&text,
                        "read-back %d x %d pixels; %s%s\nlightfit: %s\n",
                        heading.readback_width,
                        heading.readback_height,
                        heading.maps,
                        is_mean ? absl::StrCat(", mean of ", heading.phases, " phases") : "",
                        heading.fit);
  const bool has_crawl = HasCrawl(heading);
  if (has_crawl) absl::StrAppend(&text, "crawl: to the next frame, ", heading.next, "\n");
  const bool totals = lights.size() != 1;
  const bool has_border = std::any_of(lights.begin(), lights.end(), HasDarkBorder);
  if (!totals || per_light) {
    for (const LightComparison& light : lights) {
      absl::StrAppend(&text, "\n", LightText(heading, light));
    }
  }
  if (totals) absl::StrAppend(&text, "\n", TotalsText(heading, lights));
  absl::StrAppend(&text,
                  LegendOrHint("compare",
                               has_legend,
                               absl::StrCat(has_truth ? kPixelLegend : "",
                                            is_mean ? kPhaseLegend : "",
                                            has_border ? kBorderLegend : "",
                                            kFigureLegend,
                                            heading.has_plans ? kPlanLegend : "",
                                            has_crawl ? kCrawlLegend : "",
                                            has_crawl && has_truth ? kFlipLegend : "",
                                            totals ? kTotalLegend : "",
                                            totals && has_border ? kDarkLegend : "")));
  if (!has_truth)
    absl::StrAppend(&text, "A read-back alone has no truth to count wrong pixels by.\n");
  if (has_border) absl::StrAppend(&text, kBorderNote);
  return text;
}

}  // namespace lightfit::cli
