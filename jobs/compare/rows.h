// jobs/compare/rows.h
//
// Every way to set up a shadow map, side by side on one light: the rows of `lightfit compare`.
// In:   a CompareStage (a scene that a camera sees, or a read-back alone), a light, options.
// Out:  LightComparison: of each method the matrix, its energy, footprints, wrong pixels
//       and crawl.
//
// Rows, in this order: the published set-ups of methods/ by their names; "as-published", Chong and
// Gortler's Algorithm 1 to the letter; "line", the same in normalised rays; matrices given from
// outside; "lightfit", the fit that the options ask for. A method that fails has a row that says
// why.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "geometry/border.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "io/given_matrices.h"
#include "jobs/compare/crawl.h"
#include "jobs/compare/stage.h"
#include "optimizer/figures/figures.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_matrix.h"
#include "render/judge.h"
#include "render/true_lighting.h"

namespace lightfit {

inline constexpr char kLightfitName[] = "lightfit";
inline constexpr char kAsPublishedName[] = "as-published";
inline constexpr char kLineName[] = "line";

struct CompareOptions {
  MapSize map = {400, 400};
  FitOptions fit;  // of "lightfit"; its margin and min_samples go for the other fits too

  // Counts are means over phases, as those of a single one jump about by a tenth and more when the
  // map is moved by a part of a texel, which hides differences between methods.
  JudgeOptions judge = {.phases = 4};

  std::vector<GivenMatrices> given;
  bool keep_images = false;

  // Where crawl is measured to, by setting up every method there as well; null: nowhere. Must
  // outlive the comparison.
  const NextFrame* next = nullptr;

  // Called before each row with its name, and with "NAME, next frame" before its crawl; for a
  // progress bar.
  std::function<void(const std::string&)> before_row;
};

struct ComparedMap {
  std::string name;
  absl::Status status;  // why there is no matrix, or why it cannot be used for this light
  std::string note;     // empty, or how the method fell back, or why `figures` are absent
  Eigen::Matrix4d map_from_world = Eigen::Matrix4d::Identity();  // texels of CompareOptions::map

  // What look-ups outside the map find. Of a fit LightMatrix::border, of a matrix that was given
  // what was said with it; the published set-ups know only a lit one.
  Border border = Border::kLit;

  // Over the samples that every table is over (FigureOptions()), of the edges that a map with the
  // border of "lightfit" serves. The energy is Chong and Gortler's, math.md (3), squared
  // footprints, whatever was minimised. Absent: no samples, or w <= 0 at some.
  std::optional<Figures> figures;
  std::optional<WrongPixels> wrong;  // absent without truth
  std::optional<double> foretold;    // share of wrong pixels foretold from the read-back
  std::optional<MapCrawl> crawl;     // to CompareOptions::next; absent: `note` says why
  ShadowImage image;                 // CompareOptions::keep_images; of the first phase
};

struct LightComparison {
  Light light;
  LightingCounts lighting;  // of the screen; zeros without truth
  SampleCounts samples;     // of the read-back, that figures are over
  std::vector<ComparedMap> maps;
  std::vector<Lighting> truth;  // CompareOptions::keep_images

  // Null when there is no row of that name.
  const ComparedMap* Find(absl::string_view name) const;

  // The row that the others are compared with.
  const ComparedMap& lightfit() const { return maps.back(); }
};

// As many rows as CompareMaps() gives, and their names.
std::vector<std::string> RowNames(const std::vector<GivenMatrices>& given);

// Never fails as a whole: a light that cannot be used has rows that say so.
LightComparison CompareMaps(const CompareStage& stage,
                            const Light& light,
                            const CompareOptions& options);

// The same for a light that could not even be read.
LightComparison FailedRows(const Light& light,
                           const absl::Status& status,
                           const CompareOptions& options);

}  // namespace lightfit
