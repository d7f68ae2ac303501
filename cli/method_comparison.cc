#include "cli/method_comparison.h"

#include <Eigen/LU>
#include <cmath>
#include <utility>

#include "absl/strings/str_format.h"
#include "cli/comparison.h"
#include "geometry/homography.h"
#include "methods/method.h"
#include "optimizer/cover.h"
#include "optimizer/fit.h"
#include "optimizer/footprint.h"
#include "optimizer/foretell.h"
#include "optimizer/receivers.h"
#include "optimizer/samples.h"

namespace lightfit {
namespace {

// One light's samples, in coordinates that keep precision however far the light is.
struct Yardstick {
  Eigen::Matrix3d normalized_from_ray = Eigen::Matrix3d::Identity();
  Samples samples;
};

absl::StatusOr<Yardstick> MakeYardstick(const Readback& readback,
                                        const Light& light,
                                        const SampleOptions& options) {
  const absl::StatusOr<Receivers> receivers =
      FindReceivers(readback, uint32_t{1} << light.shadow_bit, options);
  if (!receivers.ok()) return receivers.status();
  Yardstick yardstick;
  // No cover, as when receivers surround the light: light space will do.
  const absl::StatusOr<RayCover> cover = CoverReceivers(*receivers, light);
  if (cover.ok()) yardstick.normalized_from_ray = cover->normalized_from_ray;
  yardstick.samples =
      SelectSamples(*receivers, light, yardstick.normalized_from_ray, /*with_edge_normals=*/false);
  return yardstick;
}

// Sets the figures, or the note that says why there are none.
void Measure(const Yardstick& yardstick, const Eigen::Matrix3d& map_from_ray, ComparedMap* row) {
  const auto add_note = [row](const std::string& note) {
    row->note += (row->note.empty() ? "" : "; ") + note;
  };
  const Samples& samples = yardstick.samples;
  if (samples.size() == 0) return add_note("no shadow edge in the read-back to measure by");
  const Eigen::Matrix3d map_from_normalized =
      map_from_ray * yardstick.normalized_from_ray.inverse();
  const Eigen::Vector3d axis = map_from_normalized.row(2);
  int64_t num_behind = 0;
  double total_weight = 0.0;
  for (size_t i = 0; i < samples.size(); ++i) {
    if (!(axis.dot(samples.At(i).X) > 0.0)) ++num_behind;
    total_weight += samples.weight[i];
  }
  if (num_behind > 0) {
    return add_note(
        absl::StrFormat("no energy: w <= 0 at %d of %d samples, which the map cannot "
                        "show",
                        num_behind,
                        samples.size()));
  }
  MapFigures figures;
  figures.footprint = ComputeFootprintStatistics(map_from_normalized, samples);
  figures.energy = 2.0 * total_weight * figures.footprint.rms * figures.footprint.rms;
  if (!std::isfinite(figures.energy) || !std::isfinite(figures.footprint.worst)) {
    return add_note("no energy: the matrix is singular at the samples");
  }
  row->figures = figures;
}

// Fills in the rows of one light.
class RowMaker {
 public:
  RowMaker(const CompareStage& stage,
           const Readback& readback,
           const Light& light,
           const absl::StatusOr<Yardstick>& yardstick,
           const CompareOptions& options,
           LightComparison* comparison)
      : stage_(stage),
        readback_(readback),
        light_(light),
        yardstick_(yardstick),
        options_(options),
        comparison_(comparison) {}

  void AddMethod(Method method) {
    Begin(MethodName(method));
    MethodInput input = stage_.view;
    input.light = light_;
    input.map = options_.map;
    absl::StatusOr<MethodMap> map = SetUpMap(method, input);
    if (!map.ok()) return Add(map.status(), "");
    Add(map->map_from_world, map->note);
  }

  void AddFit(const char* name, const FitOptions& fit_options) {
    Begin(name);
    const absl::StatusOr<LightMatrix> fit = FitLight(readback_, light_, options_.map, fit_options);
    if (!fit.ok()) return Add(fit.status(), "");
    Add(fit->map_from_world, "");
  }

  void AddGiven(const GivenMatrices& given) {
    Begin(given.name);
    Add(given.Of(light_.name), "");
  }

 private:
  void Begin(const std::string& name) {
    if (options_.before_row) options_.before_row(name);
    comparison_->maps.emplace_back();
    comparison_->maps.back().name = name;
  }

  void Add(const absl::StatusOr<Eigen::Matrix4d>& map_from_world, const std::string& note) {
    ComparedMap& row = comparison_->maps.back();
    row.note = note;
    row.status = map_from_world.status();
    if (!row.status.ok()) return;
    const absl::StatusOr<Eigen::Matrix3d> map_from_ray = MapFromRay(*map_from_world, light_);
    row.status = map_from_ray.status();
    if (!row.status.ok()) return;
    row.map_from_world = *map_from_world;
    if (yardstick_.ok()) Measure(*yardstick_, *map_from_ray, &row);
    const absl::StatusOr<double> foretold =
        ForetellWrongShare(readback_, light_, *map_from_world, options_.map);
    if (foretold.ok()) row.foretold = *foretold;
    if (!stage_.has_truth()) return;
    absl::StatusOr<ShadowImage> image = JudgeMatrix(*stage_.caster,
                                                    stage_.screen,
                                                    comparison_->truth,
                                                    light_,
                                                    *map_from_world,
                                                    options_.map,
                                                    options_.bias);
    row.status = image.status();
    if (!row.status.ok()) return;
    row.wrong = image->wrong;
    if (options_.keep_images) row.image = *std::move(image);
  }

  const CompareStage& stage_;
  const Readback& readback_;
  const Light& light_;
  const absl::StatusOr<Yardstick>& yardstick_;
  const CompareOptions& options_;
  LightComparison* comparison_;
};

// Algorithm 1 with normalised rays instead of light space.
FitOptions LineOptions(const FitOptions& options) {
  FitOptions line = PublishedOptions(options);
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
                            const Light& original_light,
                            const CompareOptions& options) {
  if (absl::Status status = ValidateLight(original_light); !status.ok()) {
    return FailedRows(original_light, status, options);
  }
  LightComparison comparison;
  comparison.light = original_light;
  Light light = original_light;
  Readback readback = stage.readback;
  std::vector<uint32_t> shadow_bits;
  if (stage.has_truth()) {
    comparison.truth = TrueLighting(*stage.caster, stage.screen, light);
    comparison.lighting = CountLighting(comparison.truth);
    light.shadow_bit = 0;
    for (const Lighting lighting : TrueLighting(*stage.caster, stage.readback_surfaces, light)) {
      shadow_bits.push_back(lighting == Lighting::kShadowed ? 1 : 0);
    }
    readback.depth = stage.readback_depth;
    readback.shadow_bits = shadow_bits;
  }
  const absl::StatusOr<Yardstick> yardstick =
      MakeYardstick(readback, light, FitOptions::AsPublished().samples);
  if (yardstick.ok()) comparison.samples = yardstick->samples.counts;

  RowMaker rows(stage, readback, light, yardstick, options, &comparison);
  for (const Method method : AllMethods()) rows.AddMethod(method);
  rows.AddFit(kAsPublishedName, PublishedOptions(options.fit));
  rows.AddFit(kLineName, LineOptions(options.fit));
  for (const GivenMatrices& given : options.given) rows.AddGiven(given);
  rows.AddFit(kLightfitName, options.fit);
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
