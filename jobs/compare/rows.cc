#include "jobs/compare/rows.h"

#include <Eigen/LU>
#include <cmath>
#include <utility>

#include "absl/strings/str_format.h"
#include "geometry/homography.h"
#include "jobs/fit_comparison.h"
#include "methods/method.h"
#include "optimizer/figures/foretell.h"
#include "optimizer/fit.h"

namespace lightfit {
namespace {

void AddNote(const std::string& note, ComparedMap* row) {
  row->note += (row->note.empty() ? "" : "; ") + note;
}

// Sets the figures, or the note that says why there are none.
void Measure(const LightView& view, const Eigen::Matrix3d& map_from_ray, ComparedMap* row) {
  if (view.samples.size() == 0) {
    return AddNote("no shadow edge in the read-back to measure by", row);
  }
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

struct RowMap {
  Eigen::Matrix4d map_from_world;
  Border border = Border::kLit;
  std::string note = "";  // as MethodMap::note
};

// How a method gets its map from what is known of one frame.
using SetUp = std::function<absl::StatusOr<RowMap>(const LitStage&)>;

SetUp SetUpOf(Method method, MapSize map) {
  return [method, map](const LitStage& frame) -> absl::StatusOr<RowMap> {
    MethodInput input = frame.stage->view;
    input.light = frame.light;
    input.map = map;
    const absl::StatusOr<MethodMap> set_up = SetUpMap(method, input);
    if (!set_up.ok()) return set_up.status();
    return RowMap{set_up->map_from_world, Border::kLit, set_up->note};
  };
}

SetUp SetUpOf(const FitOptions& options, MapSize map) {
  return [options, map](const LitStage& frame) -> absl::StatusOr<RowMap> {
    if (!frame.surfaces->ok()) return frame.surfaces->status();
    const absl::StatusOr<LightMatrix> fit = FitLight(**frame.surfaces, frame.light, map, options);
    if (!fit.ok()) return fit.status();
    return RowMap{fit->map_from_world, fit->border};
  };
}

// What has been set up for `present` already is not set up there again.
SetUp Known(const LitStage& present, const absl::StatusOr<RowMap>& there, const SetUp& elsewhere) {
  return [&present, &there, elsewhere](const LitStage& frame) {
    return &frame == &present ? there : elsewhere(frame);
  };
}

SetUp SetUpOf(const GivenMatrices& given) {
  return [&given](const LitStage& frame) -> absl::StatusOr<RowMap> {
    const absl::StatusOr<GivenMatrix> matrix = given.Of(frame.light.name);
    if (!matrix.ok()) return matrix.status();
    return RowMap{matrix->map_from_world, matrix->border};
  };
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

  void Add(const std::string& name, const SetUp& set_up) {
    if (options_.before_row) options_.before_row(name);
    comparison_->maps.emplace_back();
    ComparedMap& row = comparison_->maps.back();
    row.name = name;
    ShadowImage shadows;
    row.status = AddPresent(set_up, &row, &shadows);
    if (!row.status.ok()) return;
    if (options_.next != nullptr) AddCrawl(set_up, shadows, &row);
    if (options_.keep_images) row.image = std::move(shadows);
  }

 private:
  absl::Status AddPresent(const SetUp& set_up, ComparedMap* row, ShadowImage* shadows) {
    const absl::StatusOr<RowMap> map = set_up(frame_);
    if (!map.ok()) return map.status();
    row->note = map->note;
    const Light& light = frame_.light;
    const absl::StatusOr<Eigen::Matrix3d> map_from_ray = MapFromRay(map->map_from_world, light);
    if (!map_from_ray.ok()) return map_from_ray.status();
    row->map_from_world = map->map_from_world;
    row->border = map->border;
    if (view_.ok()) Measure(*view_, *map_from_ray, row);
    const absl::StatusOr<double> foretold = ForetellWrongShare(
        frame_.readback, light, row->map_from_world, options_.map, {}, row->border);
    if (foretold.ok()) row->foretold = *foretold;
    const CompareStage& stage = *frame_.stage;
    if (!stage.has_truth()) return absl::OkStatus();
    absl::StatusOr<ShadowImage> image =
        JudgeMatrix(*stage.caster,
                    stage.screen,
                    comparison_->truth,
                    light,
                    {map->map_from_world, options_.map, map->border},
                    options_.judge);
    if (!image.ok()) return image.status();
    row->wrong = image->wrong;
    *shadows = *std::move(image);
    return absl::OkStatus();
  }

  // Sets the crawl, or the note that says why there is none.
  void AddCrawl(const SetUp& set_up, const ShadowImage& shadows, ComparedMap* row) {
    if (options_.before_row) options_.before_row(row->name + ", next frame");
    const absl::StatusOr<RowMap> map = set_up(next_frame_);
    const absl::StatusOr<MapCrawl> crawl =
        map.ok() ? MeasureMapCrawl({frame_, comparison_->truth, row->map_from_world, shadows},
                                   *options_.next,
                                   next_frame_,
                                   {map->map_from_world, options_.map, map->border},
                                   options_.judge)
                 : map.status();
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

// Algorithm 1 with normalised rays instead of light space.
FitOptions LineOptions(const FitOptions& options) {
  FitOptions line = FitOptions::AsPublished(options);
  line.ray_space = RaySpace::kNormalized;
  line.sample_by_sample = false;
  return line;
}

}  // namespace

const ComparedMap* LightComparison::Find(absl::string_view name) const {
  for (const ComparedMap& map : maps) {
    if (map.name == name) return &map;
  }
  return nullptr;
}

std::vector<std::string> RowNames(const std::vector<GivenMatrices>& given) {
  std::vector<std::string> names;
  for (const Method method : AllMethods()) names.emplace_back(MethodName(method));
  names.emplace_back(kAsPublishedName);
  names.emplace_back(kLineName);
  for (const GivenMatrices& matrices : given) names.push_back(matrices.name);
  names.emplace_back(kLightfitName);
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
  const MapSize map = options.map;
  // First, as its border says which edges every row's figures are over.
  const SetUp fit = SetUpOf(options.fit, map);
  const absl::StatusOr<RowMap> fitted = fit(frame);
  const Border border = fitted.ok() ? fitted->border : Border::kLit;
  const absl::StatusOr<LightView> view =
      frame.surfaces->ok()
          ? ViewLight(**frame.surfaces, frame.light, border, FigureOptions(options.fit))
          : absl::StatusOr<LightView>(frame.surfaces->status());
  if (view.ok()) comparison.samples = view->samples.counts;

  RowMaker rows(frame, view, options, &comparison);
  for (const Method method : AllMethods()) rows.Add(MethodName(method), SetUpOf(method, map));
  rows.Add(kAsPublishedName, SetUpOf(FitOptions::AsPublished(options.fit), map));
  rows.Add(kLineName, SetUpOf(LineOptions(options.fit), map));
  for (const GivenMatrices& given : options.given) rows.Add(given.name, SetUpOf(given));
  rows.Add(kLightfitName, Known(frame, fitted, fit));
  if (!options.keep_images) comparison.truth.clear();
  return comparison;
}

LightComparison FailedRows(const Light& light,
                           const absl::Status& status,
                           const CompareOptions& options) {
  LightComparison comparison;
  comparison.light = light;
  for (const std::string& name : RowNames(options.given)) {
    comparison.maps.emplace_back();
    comparison.maps.back().name = name;
    comparison.maps.back().status = status;
  }
  return comparison;
}

}  // namespace lightfit
