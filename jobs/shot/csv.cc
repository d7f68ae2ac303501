#include "jobs/shot/csv.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "base/csv.h"
#include "jobs/shot/totals.h"

namespace lightfit {
namespace {

constexpr char kNames[] =
    "mode,frame,number,light,status,action,energy,energy_ratio,footprint_rms_px,"
    "footprint_median_px,footprint_p99_px,foretold_wrong_share,phase_drift_texels,edge_crawl_px,"
    "border,note,maps,maps_moved\n";

std::string Line(const ShotJob& job, const ShotRows& rows, const ShotRow& row) {
  const ShotFrame& frame = job.frames[row.frame];
  const bool ok = row.error.empty();
  std::optional<double> energy, rms, median, p99, wrong, drift, edge_crawl;
  if (ok) {
    energy = row.energy;
    rms = row.footprint.rms;
    median = row.footprint.median;
    p99 = row.footprint.p99;
    wrong = row.wrong_share;
  }
  if (row.crawl && row.crawl->num_points > 0) drift = row.crawl->phase_drift_texels;
  if (row.crawl && row.crawl->num_edge_points > 0) edge_crawl = row.crawl->edge_crawl_px;
  const std::string fields[] = {ShotModeName(row.mode),
                                CsvField(frame.name),
                                frame.number.Text(),
                                CsvField(job.lights[row.light].name),
                                ok ? "ok" : "failed",
                                row.action,
                                CsvNumber(energy),
                                CsvNumber(EnergyRatio(rows, row)),
                                CsvNumber(rms),
                                CsvNumber(median),
                                CsvNumber(p99),
                                CsvNumber(wrong),
                                CsvNumber(drift),
                                CsvNumber(edge_crawl),
                                ok ? BorderName(row.border) : "",
                                CsvField(row.error),
                                ok ? absl::StrCat(row.num_maps) : "",
                                ok ? absl::StrCat(row.num_moved) : ""};
  return absl::StrJoin(fields, ",") + "\n";
}

}  // namespace

std::string ShotCsv(const ShotJob& job, const ShotRows& rows) {
  std::string csv = kNames;
  for (const auto& mode : rows) {
    for (const std::vector<ShotRow>& frame : mode) {
      for (const ShotRow& row : frame) csv += Line(job, rows, row);
    }
  }
  return csv;
}

}  // namespace lightfit
