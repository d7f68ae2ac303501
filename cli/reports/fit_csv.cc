#include "cli/reports/fit_csv.h"

#include <cstdint>
#include <optional>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "base/csv.h"
#include "cli/reports/fit_report.h"
#include "optimizer/figures/foretell.h"

namespace lightfit::cli {
namespace {

// The same for all four maps of a light: the answer, and those that it is compared with.
constexpr const char* kFigureNames[] = {
    "wrong_share", "energy", "footprint_rms_px", "footprint_p99_px", "footprint_worst_px"};
constexpr const char* kMapNames[] = {"final", "one_map", "focused", "published"};

using Fields = std::vector<std::string>;

Fields Names() {
  Fields names = {"light", "kind", "x", "y", "z", "status", "border", "maps", "texels"};
  for (const char* map : kMapNames) {
    for (const char* figure : kFigureNames) names.push_back(absl::StrCat(map, "_", figure));
  }
  for (const char* name : {"measured_wrong_share",
                           "edge_pixels_found",
                           "edge_pixels_used",
                           "rejected_depth_edge",
                           "rejected_facing_away",
                           "rejected_edge_on",
                           "rejected_background",
                           "rejected_far_outside",
                           "surface_pixels",
                           "invalid_depth_pixels",
                           "note"}) {
    names.emplace_back(name);
  }
  return names;
}

void AppendFigures(const Figures* figures, Fields* fields) {
  if (figures == nullptr) {
    fields->insert(fields->end(), std::size(kFigureNames), "");
    return;
  }
  fields->push_back(CsvNumber(figures->wrong_share));
  fields->push_back(CsvNumber(figures->energy));
  fields->push_back(CsvNumber(figures->footprint.rms));
  fields->push_back(CsvNumber(figures->footprint.p99));
  fields->push_back(CsvNumber(figures->footprint.worst));
}

const Figures* FiguresOf(const absl::StatusOr<JudgedMatrix>& map) {
  return map.ok() ? &map->figures : nullptr;
}

// Why a light has its focused map instead of a searched one.
std::string NoteOf(const FitComparison& light, const FitOptions& options) {
  if (!light.plan.has_value()) return FocusedInsteadText(light.final->matrix, options);
  const LightPlan& plan = (*light.plan)->plan;
  return plan.maps.size() == 1 ? FocusedInsteadText(plan.maps[0], options) : "";
}

Fields LightFields(const Light& light) {
  const bool is_point = light.kind == Light::Kind::kPoint;
  const Eigen::Vector3d& where = is_point ? light.position : light.direction;
  return {CsvField(light.name),
          is_point ? "point" : "sun",
          CsvNumber(where.x()),
          CsvNumber(where.y()),
          CsvNumber(where.z())};
}

Fields FieldsOf(const Readback& readback,
                MapSize map,
                const FitOptions& options,
                const FitComparison& light) {
  Fields fields = LightFields(light.light);
  if (!light.ok()) {
    fields.emplace_back("failed");
    fields.resize(Names().size() - 1);
    fields.push_back(CsvField(std::string(light.status().message())));
    return fields;
  }
  const bool has_plan = light.plan.has_value();
  const size_t num_maps = has_plan ? (*light.plan)->plan.maps.size() : 1;
  const int64_t texels =
      has_plan ? NumTexels(PlanOf((*light.plan)->plan)) : int64_t{map.width} * map.height;
  fields.insert(fields.end(),
                {"ok", BorderName(light.border()), absl::StrCat(num_maps), absl::StrCat(texels)});
  AppendFigures(&light.figures(), &fields);
  AppendFigures(has_plan ? FiguresOf(light.final) : nullptr, &fields);
  AppendFigures(FiguresOf(light.focused), &fields);
  AppendFigures(FiguresOf(light.published), &fields);
  fields.push_back(CsvNumber(MeasuredWrongShare(readback, light.light)));
  const SampleCounts& samples = light.samples();
  for (const int64_t count : {samples.candidates,
                              samples.used,
                              samples.discontinuity,
                              samples.facing_away,
                              samples.edge_on,
                              samples.background,
                              samples.beyond_map,
                              samples.receivers,
                              samples.invalid_depth}) {
    fields.push_back(absl::StrCat(count));
  }
  fields.push_back(CsvField(NoteOf(light, options)));
  return fields;
}

}  // namespace

std::string FitCsv(const Readback& readback,
                   MapSize map,
                   const FitOptions& options,
                   const std::vector<FitComparison>& lights) {
  std::string csv = absl::StrCat(absl::StrJoin(Names(), ","), "\n");
  for (const FitComparison& light : lights) {
    absl::StrAppend(&csv, absl::StrJoin(FieldsOf(readback, map, options, light), ","), "\n");
  }
  return csv;
}

}  // namespace lightfit::cli
