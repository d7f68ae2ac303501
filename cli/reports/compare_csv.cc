#include "cli/reports/compare_csv.h"

#include <optional>

#include "absl/strings/str_cat.h"
#include "base/csv.h"
#include "jobs/compare/totals.h"

namespace lightfit::cli {
namespace {

void AppendCsvCrawl(const std::optional<MapCrawl>& crawl, std::string* csv) {
  if (crawl.has_value()) {
    absl::StrAppend(csv,
                    CsvNumber(crawl->points.phase_drift_texels),
                    ",",
                    CsvNumber(crawl->points.moved_share),
                    ",",
                    CsvNumber(crawl->points.edge_crawl_px),
                    ",");
  } else {
    absl::StrAppend(csv, ",,,");
  }
  if (crawl.has_value() && crawl->flicker.has_value()) {
    const Flicker& flicker = *crawl->flicker;
    absl::StrAppend(csv, flicker.judged, ",", flicker.flips_ideal, ",", flicker.flips_practical);
    absl::StrAppend(csv, ",");
  } else {
    absl::StrAppend(csv, ",,,");
  }
}

void AppendCsvRow(const LightComparison& light, const ComparedRow& row, std::string* csv) {
  const bool is_point = light.light.kind == Light::Kind::kPoint;
  const Eigen::Vector3d& where = is_point ? light.light.position : light.light.direction;
  absl::StrAppend(csv, CsvField(light.light.name), is_point ? ",point," : ",sun,");
  for (const double value : where) absl::StrAppend(csv, CsvNumber(value), ",");
  absl::StrAppend(csv, CsvField(row.name), row.status.ok() ? ",ok," : ",failed,");
  if (row.wrong.has_value()) {
    absl::StrAppend(csv,
                    row.wrong->ideal,
                    ",",
                    row.wrong->practical,
                    ",",
                    CsvNumber(row.wrong->practical_weighted),
                    ",",
                    row.wrong->outside,
                    ",");
  } else {
    absl::StrAppend(csv, ",,,,");
  }
  const ComparedRow& lightfit = light.lightfit();
  absl::StrAppend(csv, CsvNumber(WrongRatio(row, lightfit, &WrongPixels::ideal)), ",");
  absl::StrAppend(csv, CsvNumber(WrongRatio(row, lightfit, &WrongPixels::practical)), ",");
  if (row.figures.has_value()) {
    const FootprintStatistics& footprint = row.figures->footprint;
    absl::StrAppend(csv,
                    CsvNumber(row.figures->energy),
                    ",",
                    CsvNumber(EnergyRatio(row, lightfit)),
                    ",",
                    CsvNumber(footprint.rms),
                    ",",
                    CsvNumber(footprint.worst),
                    ",");
  } else {
    absl::StrAppend(csv, ",,,,");
  }
  absl::StrAppend(csv, CsvNumber(row.foretold), ",");
  AppendCsvCrawl(row.crawl, csv);
  absl::StrAppend(csv, light.samples.used, ",", light.lighting.lit, ",", light.lighting.shadowed);
  if (row.status.ok()) {
    absl::StrAppend(csv, ",", NumMaps(row.drawn), ",", NumTexels(row.drawn));
  } else {
    absl::StrAppend(csv, ",,");
  }
  absl::StrAppend(csv, ",", row.status.ok() ? BorderName(row.border()) : "");
  absl::StrAppend(
      csv, ",", CsvField(row.status.ok() ? row.note : std::string(row.status.message())), "\n");
}

}  // namespace

std::string CompareCsv(absl::Span<const LightComparison> lights) {
  std::string csv =
      "light,kind,x,y,z,method,status,wrong_ideal,wrong_practical,wrong_practical_weighted,"
      "wrong_outside,ratio_ideal,ratio_practical,energy,energy_ratio,footprint_rms,"
      "footprint_worst,foretold_share,crawl_texels,crawl_moved_share,crawl_edge_px,"
      "flips_judged,flips_ideal,flips_practical,samples,pixels_lit,pixels_shadowed,maps,texels,"
      "border,note\n";
  for (const LightComparison& light : lights) {
    for (const ComparedRow& row : light.rows) AppendCsvRow(light, row, &csv);
  }
  return csv;
}

}  // namespace lightfit::cli
