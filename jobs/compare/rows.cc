#include "jobs/compare/rows.h"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "absl/functional/function_ref.h"
#include "absl/strings/str_format.h"
#include "geometry/homography.h"
#include "jobs/fit_comparison.h"
#include "jobs/schemes/fitted.h"
#include "jobs/schemes/judge_maps.h"
#include "jobs/schemes/published.h"
#include "jobs/schemes/shipped.h"
#include "methods/method.h"
#include "optimizer/figures/foretell.h"
#include "optimizer/sizing/map_sizes.h"
#include "partition/evaluate_plan.h"

namespace lightfit {
namespace {

void AddNote(const std::string& note, ComparedRow* row) {
  row->note += (row->note.empty() ? "" : "; ") + note;
}

// Sets the figures of a single map, or the note that says why there are none.
void MeasureOne(const LightView& view, const Eigen::Matrix3d& map_from_ray, ComparedRow* row) {
  const Eigen::Matrix3d map_from_normalized = map_from_ray * view.normalized_from_ray().inverse();
  Figures figures =
      MeasureFigures(view.samples, map_from_normalized, Metric::kL2, /*along_edge_share=*/1.0);
  if (figures.footprint.num_behind > 0) {
    return AddNote(
        absl::StrFormat("no energy: w <= 0 at %d of %d samples, which the map cannot show",
                        figures.footprint.num_behind,
                        view.samples.size()),
        row);
  }
  if (!std::isfinite(figures.energy) || !std::isfinite(figures.footprint.worst)) {
    return AddNote("no energy: the matrix is singular at the samples", row);
  }
  row->figures = figures;
}

// The same of several maps.
void MeasureSeveral(const LightView& view,
                    const Plan& plan,
                    const FitOptions& fit,
                    ComparedRow* row) {
  FitOptions options = FigureOptions(fit);
  options.metric = Metric::kL2;
  options.along_edge_share = 1.0;
  const absl::StatusOr<Figures> figures = MeasurePlan(view, plan, options, row->drawn.guard_texels);
  if (!figures.ok()) {
    return AddNote("no energy: " + std::string(figures.status().message()), row);
  }
  row->figures = *figures;
}

std::optional<double> Foretell(const LitStage& frame, const Plan& plan) {
  const absl::StatusOr<double> share = ForetellPlan(frame.readback, frame.light, plan, {});
  return share.ok() ? std::optional<double>(*share) : std::nullopt;
}

absl::StatusOr<SchemeMaps> SetUpIn(const LitStage& frame, const Scheme& scheme) {
  return scheme.set_up({frame.stage->view, *frame.surfaces, frame.light});
}

// Of a plan that keeps its own sizes: empty where they come to what methods may have.
std::string SizeNote(const Plan& plan, MapSize map) {
  const int64_t texels = NumTexels(plan), budget = TexelsOf(map);
  if (texels == budget) return "";
  return absl::StrFormat(
      "the file's own sizes: %d map%s of %d texels in all, and not the %d of one "
      "map here",
      plan.maps.size(),
      plan.maps.size() == 1 ? "" : "s",
      texels,
      budget);
}

Scheme GivenScheme(const GivenSetUp& given, MapSize map) {
  return {given.name, [&given, map](const SchemeInput& input) -> absl::StatusOr<SchemeMaps> {
            absl::StatusOr<GivenMaps> maps = given.Of(input.light);
            if (!maps.ok()) return maps.status();
            SchemeMaps drawn = {std::move(maps->plan), maps->guard_texels};
            drawn.note = SizeNote(*PlanOf(drawn), map);
            drawn.has_other_texels = !drawn.note.empty();
            return drawn;
          }};
}

// All rows. Refers to the options.
std::vector<Scheme> SchemesOf(const CompareOptions& options) {
  const double guard_texels = options.plan.has_value() ? options.plan->guard_texels : 0.0;
  SchemeBudget budget = {options.map, 1, guard_texels};
  const auto one_map = [&](const char* name, const FitOptions& fit) {
    return FittedScheme(name, OneMapOf(fit, options.map, guard_texels));
  };
  std::vector<Scheme> schemes;
  for (const Method method : AllMethods()) schemes.push_back(MethodScheme(method, budget));
  schemes.push_back(one_map(kAsPublishedName, FitOptions::AsPublished(options.fit)));
  schemes.push_back(one_map(kLineName, LineOptions(options.fit)));
  for (const GivenSetUp& given : options.given) {
    schemes.push_back(GivenScheme(given, options.map));
  }
  if (!options.plan.has_value()) {
    schemes.push_back(one_map(kLightfitName, options.fit));
    return schemes;
  }
  schemes.push_back(one_map(kOneMapName, options.fit));
  budget.num_maps = options.plan->max_maps;
  for (std::vector<Scheme>& more :
       std::array{SlicesSchemes(budget), PublishedSchemes(budget), ShippedSchemes(budget)}) {
    for (Scheme& scheme : more) schemes.push_back(std::move(scheme));
  }
  schemes.push_back(FittedScheme(kLightfitName, *options.plan));
  return schemes;
}

// Fills in the rows of one light.
class RowMaker {
 public:
  RowMaker(const LitStage& frame,
           const absl::StatusOr<LightView>& view,
           const CompareOptions& options,
           LightComparison* comparison)
      : frame_(frame), view_(view), options_(options), comparison_(comparison) {
    if (options.next != nullptr) next_frame_ = Lit(options.next->stage, comparison->light);
  }

  void Add(const Scheme& scheme) {
    Add(scheme, [this, &scheme] { return SetUpIn(frame_, scheme); });
  }

  // Of what has been set up in the present frame already.
  void Add(const Scheme& scheme, const absl::StatusOr<SchemeMaps>& drawn) {
    Add(scheme, [&drawn] { return drawn; });
  }

 private:
  using Drawn = absl::FunctionRef<absl::StatusOr<SchemeMaps>()>;

  void Add(const Scheme& scheme, Drawn drawn) {
    if (options_.before_row) options_.before_row(scheme.name);
    ComparedRow& row = comparison_->rows.emplace_back();
    row.name = scheme.name;
    ShadowImage shadows;
    row.status = AddPresent(drawn(), &row, &shadows);
    if (!row.status.ok()) return;
    if (options_.next != nullptr) AddCrawl(scheme, shadows, &row);
    if (options_.keep_images) row.image = std::move(shadows);
  }

  absl::Status AddPresent(absl::StatusOr<SchemeMaps> drawn,
                          ComparedRow* row,
                          ShadowImage* shadows) {
    if (!drawn.ok()) return drawn.status();
    const Light& light = frame_.light;
    if (absl::Status status = ValidateMaps(*drawn, light); !status.ok()) return status;
    row->note = drawn->note;
    row->drawn = *std::move(drawn);
    AddFigures(row);
    const CompareStage& stage = *frame_.stage;
    if (!stage.has_truth()) return absl::OkStatus();
    absl::StatusOr<ShadowImage> image = JudgeMaps(
        *stage.caster, stage.screen, comparison_->truth, light, row->drawn, options_.judge);
    if (!image.ok()) return image.status();
    row->wrong = image->wrong;
    *shadows = *std::move(image);
    return absl::OkStatus();
  }

  void AddFigures(ComparedRow* row) {
    const Plan* plan = PlanOf(row->drawn);
    if (plan == nullptr) {
      return AddNote("no energy and no forecast, which are of matrices", row);
    }
    row->foretold = Foretell(frame_, *plan);
    if (!view_.ok()) return;
    if (view_->samples.size() == 0) {
      return AddNote("no shadow edge in the read-back to measure by", row);
    }
    const PlanMap* only = OnlyMap(row->drawn);
    if (only == nullptr) return MeasureSeveral(*view_, *plan, options_.fit, row);
    MeasureOne(*view_, *MapFromRay(only->map_from_world, frame_.light), row);
  }

  // Sets the crawl, or the note that says why there is none.
  void AddCrawl(const Scheme& scheme, const ShadowImage& shadows, ComparedRow* row) {
    if (options_.before_row) options_.before_row(row->name + ", next frame");
    const absl::StatusOr<SchemeMaps> next = SetUpIn(next_frame_, scheme);
    const absl::StatusOr<MapCrawl> crawl =
        next.ok() ? MeasureMapCrawl({frame_, comparison_->truth, row->drawn, shadows},
                                    *options_.next,
                                    next_frame_,
                                    *next,
                                    options_.judge)
                  : next.status();
    if (!crawl.ok()) {
      return AddNote("no crawl, in the next frame: " + std::string(crawl.status().message()), row);
    }
    row->crawl = *crawl;
  }

  const LitStage& frame_;
  LitStage next_frame_;
  const absl::StatusOr<LightView>& view_;
  const CompareOptions& options_;
  LightComparison* comparison_;
};

}  // namespace

void SetPlan(const PlanOptions& plan, CompareOptions* options) {
  options->plan = plan;
  options->fit = plan.fit;
  options->map = OneMapSize(plan);
}

bool HasPlans(const CompareOptions& options) {
  if (options.plan.has_value()) return true;
  for (const GivenSetUp& given : options.given) {
    for (const auto& [light, maps] : given.by_light) {
      const Plan& plan = maps.plan;
      if (plan.maps.size() > 1 || NumTexels(plan) != TexelsOf(options.map)) return true;
    }
  }
  return false;
}

const ComparedRow* LightComparison::Find(absl::string_view name) const {
  for (const ComparedRow& row : rows) {
    if (row.name == name) return &row;
  }
  return nullptr;
}

std::vector<std::string> RowNames(const CompareOptions& options) {
  std::vector<std::string> names;
  for (const Scheme& scheme : SchemesOf(options)) names.push_back(scheme.name);
  return names;
}

LightComparison CompareMaps(const CompareStage& stage,
                            const Light& light,
                            const CompareOptions& options) {
  if (absl::Status status = ValidateLight(light); !status.ok()) {
    return FailedRows(light, status, options);
  }
  LightComparison comparison;
  comparison.light = light;
  if (stage.has_truth()) {
    comparison.truth = TrueLighting(*stage.caster, stage.screen, light);
    comparison.lighting = CountLighting(comparison.truth);
  }
  const LitStage frame = Lit(stage, light);
  const std::vector<Scheme> schemes = SchemesOf(options);
  // First, as its border says which edges every row's figures are over.
  const absl::StatusOr<SchemeMaps> fitted = SetUpIn(frame, schemes.back());
  const Border border = fitted.ok() ? BorderOf(*fitted) : Border::kLit;
  const absl::StatusOr<LightView> view =
      frame.surfaces->ok()
          ? ViewLight(**frame.surfaces, frame.light, border, FigureOptions(options.fit))
          : absl::StatusOr<LightView>(frame.surfaces->status());
  if (view.ok()) comparison.samples = view->samples.counts;

  RowMaker rows(frame, view, options, &comparison);
  for (size_t i = 0; i + 1 < schemes.size(); ++i) rows.Add(schemes[i]);
  rows.Add(schemes.back(), fitted);
  if (!options.keep_images) comparison.truth.clear();
  return comparison;
}

LightComparison FailedRows(const Light& light,
                           const absl::Status& status,
                           const CompareOptions& options) {
  LightComparison comparison;
  comparison.light = light;
  for (const std::string& name : RowNames(options)) {
    comparison.rows.emplace_back();
    comparison.rows.back().name = name;
    comparison.rows.back().status = status;
  }
  return comparison;
}

}  // namespace lightfit
