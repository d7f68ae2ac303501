// jobs/compare/rows.h
//
// Every way to set up the shadow maps of a light, side by side: the rows of `lightfit compare`.
// In:   a CompareStage (a scene that a camera sees, or a read-back alone), a light, options.
// Out:  LightComparison: of each method its maps, their energy, footprints, wrong pixels and
//       crawl.
//
// Rows, in this order: the published set-ups of methods/ by their names; "as-published", Chong and
// Gortler's Algorithm 1 to the letter; "line", the same in normalised rays; matrices and plans
// given from outside; where several maps are asked for "one map", our own, then the published plans
// and those that engines ship (jobs/schemes), all of as many texels; "lightfit", the fit that the
// options ask for. A method that fails has a row that says why.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "geometry/border.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "io/given_maps.h"
#include "jobs/compare/crawl.h"
#include "jobs/compare/stage.h"
#include "jobs/schemes/scheme.h"
#include "optimizer/figures/figures.h"
#include "optimizer/fit_options.h"
#include "partition/plan_options.h"
#include "render/judge.h"
#include "render/true_lighting.h"

namespace lightfit {

inline constexpr char kLightfitName[] = "lightfit";
inline constexpr char kAsPublishedName[] = "as-published";
inline constexpr char kLineName[] = "line";
inline constexpr char kOneMapName[] = "one map";

struct CompareOptions {
  MapSize map = {400, 400};  // of single maps
  FitOptions fit;            // of "lightfit"; its margin and min_samples go for the other fits too

  // Where "lightfit" is a plan of several maps: PlanOptions::fit is `fit`, and `map` has the texels
  // of all maps, see SetPlan().
  std::optional<PlanOptions> plan;

  // Counts are means over phases, as those of a single one jump about by a tenth and more when the
  // map is moved by a part of a texel, which hides differences between methods.
  JudgeOptions judge = {.phases = 4};

  std::vector<GivenSetUp> given;  // plans among them may have more texels, or fewer
  bool keep_images = false;

  // Where crawl is measured to, by setting up every method there as well; null: nowhere. Must
  // outlive the comparison.
  const NextFrame* next = nullptr;

  // Called before each row with its name, and with "NAME, next frame" before its crawl; for a
  // progress bar.
  std::function<void(const std::string&)> before_row;
};

// For plans of several maps.
void SetPlan(const PlanOptions& plan, CompareOptions* options);

// Whether a row may have several maps, or other texels than `map`: ours, or one that was given.
bool HasPlans(const CompareOptions& options);

struct ComparedRow {
  std::string name;
  absl::Status status;  // why there are no maps, or why they cannot be used for this light

  // Empty, or how the method fell back, why `figures` are absent, that a given plan has other
  // texels than the methods beside it.
  std::string note;

  SchemeMaps drawn;

  // What look-ups outside the maps find. Of a fit LightMatrix::border, of a matrix that was given
  // what was said with it; the published set-ups know only a lit one.
  Border border() const { return BorderOf(drawn); }

  // Over the samples that every table is over (FigureOptions()), of the edges that a map with the
  // border of "lightfit" serves. The energy is Chong and Gortler's, math.md (3), squared
  // footprints, whatever was minimised; of several maps as EvaluatePlan() has it. Absent: no
  // samples, w <= 0 at some in a single map, or maps that are no matrices.
  std::optional<Figures> figures;
  std::optional<WrongPixels> wrong;  // absent without truth

  // Share of wrong pixels foretold from the read-back, without half spaces and guard of a plan.
  // Absent for maps that are no matrices.
  std::optional<double> foretold;
  std::optional<MapCrawl> crawl;  // to CompareOptions::next; absent: `note` says why
  ShadowImage image;              // CompareOptions::keep_images; of the first phase
};

struct LightComparison {
  Light light;
  LightingCounts lighting;  // of the screen; zeros without truth
  SampleCounts samples;     // of the read-back, that figures are over
  std::vector<ComparedRow> rows;
  std::vector<Lighting> truth;  // CompareOptions::keep_images

  // Null when there is no row of that name.
  const ComparedRow* Find(absl::string_view name) const;

  // The row that the others are compared with.
  const ComparedRow& lightfit() const { return rows.back(); }
};

// As many rows as CompareMaps() gives, and their names.
std::vector<std::string> RowNames(const CompareOptions& options);

// Never fails as a whole: a light that cannot be used has rows that say so.
LightComparison CompareMaps(const CompareStage& stage,
                            const Light& light,
                            const CompareOptions& options);

// The same for a light that could not even be read.
LightComparison FailedRows(const Light& light,
                           const absl::Status& status,
                           const CompareOptions& options);

}  // namespace lightfit
