#include "jobs/compare/json.h"

#include "base/text_file.h"
#include "jobs/compare/maps_proto.h"
#include "jobs/compare/totals.h"
#include "wire/camera_proto.h"
#include "wire/crawl_proto.h"
#include "wire/light_proto.h"
#include "wire/matrix_proto.h"
#include "wire/options_proto.h"
#include "wire/plan_proto.h"
#include "wire/proto_json.h"
#include "wire/result_json.h"

namespace lightfit {
namespace {

v1::WrongPixels WrongPixelsToProto(const WrongPixels& wrong) {
  v1::WrongPixels proto;
  proto.set_ideal(wrong.ideal);
  proto.set_practical(wrong.practical);
  proto.set_practical_weighted(wrong.practical_weighted);
  proto.set_outside(wrong.outside);
  return proto;
}

v1::Crawl MapCrawlToProto(const MapCrawl& crawl) {
  v1::Crawl proto = CrawlToProto(crawl.points);
  if (!crawl.flicker.has_value()) return proto;
  proto.mutable_flicker()->set_judged(crawl.flicker->judged);
  proto.mutable_flicker()->set_flips_ideal(crawl.flicker->flips_ideal);
  proto.mutable_flicker()->set_flips_practical(crawl.flicker->flips_practical);
  return proto;
}

void SetRatios(const ComparedRow& row, const ComparedRow& lightfit, v1::MethodComparison* proto) {
  const std::optional<double> energy = EnergyRatio(row, lightfit);
  if (energy.has_value()) proto->set_energy_ratio(*energy);
  const std::optional<double> ideal = WrongRatio(row, lightfit, &WrongPixels::ideal);
  if (ideal.has_value()) proto->set_ideal_ratio(*ideal);
  const std::optional<double> practical = WrongRatio(row, lightfit, &WrongPixels::practical);
  if (practical.has_value()) proto->set_practical_ratio(*practical);
}

v1::MethodComparison MethodToProto(const ComparedRow& row,
                                   const ComparedRow& lightfit,
                                   bool with_maps) {
  v1::MethodComparison proto;
  proto.set_method(row.name);
  proto.mutable_status()->set_code(static_cast<int>(row.status.code()));
  proto.mutable_status()->set_message(std::string(row.status.message()));
  proto.set_note(row.note);
  if (!row.status.ok()) return proto;
  if (const PlanMap* only = OnlyMap(row.drawn)) {
    *proto.mutable_map_from_world() = MatrixToProto(only->map_from_world);
  }
  if (with_maps) *proto.mutable_maps() = MapsToProto(row.drawn);
  proto.set_border(BorderToProto(row.border()));
  if (row.figures.has_value()) {
    proto.set_energy(row.figures->energy);
    *proto.mutable_footprint() = FootprintToProto(row.figures->footprint, true);
  }
  if (row.wrong.has_value()) *proto.mutable_wrong() = WrongPixelsToProto(*row.wrong);
  if (row.foretold.has_value()) proto.set_foretold_share(*row.foretold);
  SetRatios(row, lightfit, &proto);
  if (row.crawl.has_value()) *proto.mutable_crawl() = MapCrawlToProto(*row.crawl);
  return proto;
}

v1::LightComparison LightComparisonToProto(const LightComparison& light,
                                           bool has_truth,
                                           bool with_maps) {
  v1::LightComparison proto;
  proto.set_name(light.light.name);
  *proto.mutable_light() = LightToProto(light.light);
  if (has_truth) {
    proto.mutable_lighting()->set_background(light.lighting.background);
    proto.mutable_lighting()->set_facing_away(light.lighting.facing_away);
    proto.mutable_lighting()->set_lit(light.lighting.lit);
    proto.mutable_lighting()->set_shadowed(light.lighting.shadowed);
  }
  *proto.mutable_samples() = SampleCountsToProto(light.samples);
  for (const ComparedRow& row : light.rows) {
    *proto.add_methods() = MethodToProto(row, light.lightfit(), with_maps);
  }
  return proto;
}

v1::MethodTotals::Pixels PixelsToProto(const MethodTotals::Pixels& pixels) {
  v1::MethodTotals::Pixels proto;
  proto.set_total(pixels.total);
  proto.set_lightfit_total(pixels.lightfit_total);
  if (pixels.ratio.has_value()) proto.set_ratio(*pixels.ratio);
  proto.set_mean_ratio(pixels.mean_ratio);
  proto.set_num_better_lights(pixels.num_wins);
  return proto;
}

v1::MethodTotals TotalsToProto(const MethodTotals& totals) {
  v1::MethodTotals proto;
  proto.set_method(totals.name);
  proto.set_num_lights(totals.num_lights);
  proto.set_num_failed(totals.num_failed);
  if (totals.ideal.has_value()) *proto.mutable_ideal() = PixelsToProto(*totals.ideal);
  if (totals.practical.has_value()) *proto.mutable_practical() = PixelsToProto(*totals.practical);
  if (totals.mean_energy_ratio.has_value()) proto.set_mean_energy_ratio(*totals.mean_energy_ratio);
  proto.set_num_energy_lights(totals.num_energy_lights);
  if (totals.crawl.has_value()) *proto.mutable_crawl() = MapCrawlToProto(*totals.crawl);
  proto.set_num_crawl_lights(totals.num_crawl_lights);
  return proto;
}

// Of the image that is judged, or of the read-back.
v1::Camera CameraOf(const CompareStage& stage) {
  return stage.has_truth() ? CameraToProto(stage.screen.camera)
                           : CameraToProto(stage.readback.camera, stage.readback.depth_kind);
}

}  // namespace

v1::Comparison ComparisonToProto(const std::string& source,
                                 const CompareStage& stage,
                                 const CompareOptions& options,
                                 absl::Span<const LightComparison> lights) {
  v1::Comparison proto;
  proto.set_source(source);
  *proto.mutable_camera() = CameraOf(stage);
  if (options.next != nullptr) *proto.mutable_next_camera() = CameraOf(options.next->stage);
  if (stage.has_truth()) {
    proto.set_bias_constant_share(options.judge.constant_share);
    proto.set_phases(options.judge.phases);
  }
  proto.set_readback_width(stage.readback.width());
  proto.set_readback_height(stage.readback.height());
  proto.mutable_map()->set_width(options.map.width);
  proto.mutable_map()->set_height(options.map.height);
  *proto.mutable_options() = FitOptionsToProto(options.fit);
  if (options.plan.has_value()) {
    *proto.mutable_plan_options() = PlanOptionsToProto(*options.plan);
  }
  for (const LightComparison& light : lights) {
    *proto.add_lights() = LightComparisonToProto(light, stage.has_truth(), HasPlans(options));
  }
  for (const MethodTotals& totals : TotalsOf(lights)) *proto.add_totals() = TotalsToProto(totals);
  return proto;
}

absl::Status WriteComparisonJson(const std::string& path, const v1::Comparison& comparison) {
  if (absl::Status status = CheckFinite(comparison, "comparison"); !status.ok()) return status;
  const absl::StatusOr<std::string> json = ProtoToJson(comparison);
  if (!json.ok()) return InFile(path, json.status());
  return WriteTextFileAtomically(path, *json);
}

}  // namespace lightfit
