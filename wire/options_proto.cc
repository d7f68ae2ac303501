#include "wire/options_proto.h"

#include <google/protobuf/descriptor.h>

#include <string>
#include <utility>

#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"

namespace lightfit {

namespace {

// The library's values beside the schema's.
constexpr std::pair<Metric, v1::Metric> kMetrics[] = {
    {Metric::kL2, v1::METRIC_L2},
    {Metric::kL2AcrossEdge, v1::METRIC_L2_ACROSS_EDGE},
    {Metric::kL1, v1::METRIC_L1},
    {Metric::kL1AcrossEdge, v1::METRIC_L1_ACROSS_EDGE}};

constexpr std::pair<Cover, v1::Cover> kCovers[] = {{Cover::kReceivers, v1::COVER_RECEIVERS},
                                                   {Cover::kShadowed, v1::COVER_SHADOWED}};

constexpr std::pair<BorderChoice, v1::BorderChoice> kBorders[] = {
    {BorderChoice::kLit, v1::BORDER_CHOICE_LIT},
    {BorderChoice::kDark, v1::BORDER_CHOICE_DARK},
    {BorderChoice::kAutomatic, v1::BORDER_CHOICE_AUTOMATIC}};

constexpr std::pair<Search, v1::Search> kSearches[] = {
    {Search::kFocused, v1::SEARCH_FOCUSED},
    {Search::kRotationLineSearch, v1::SEARCH_ROTATION_LINE_SEARCH},
    {Search::kRotationLineSearchRefined, v1::SEARCH_ROTATION_LINE_SEARCH_REFINED},
    {Search::kGlobal, v1::SEARCH_GLOBAL}};

constexpr std::pair<Affine, v1::Affine> kAffines[] = {
    {Affine::kMinAreaRectangle, v1::AFFINE_MIN_AREA_RECTANGLE},
    {Affine::kMinAreaRectangleCgal, v1::AFFINE_MIN_AREA_RECTANGLE_CGAL},
    {Affine::kSkewedRectangle, v1::AFFINE_SKEWED_RECTANGLE},
    {Affine::kMinEnergyParallelogram, v1::AFFINE_MIN_ENERGY_PARALLELOGRAM}};

constexpr std::pair<RaySpace, v1::RaySpace> kRaySpaces[] = {
    {RaySpace::kLightSpace, v1::RAY_SPACE_LIGHT_SPACE},
    {RaySpace::kNormalized, v1::RAY_SPACE_NORMALIZED}};

constexpr std::pair<Refiner, v1::Refiner> kRefiners[] = {
    {Refiner::kTinySolver, v1::REFINER_TINY_SOLVER}, {Refiner::kCeres, v1::REFINER_CERES}};

template <typename Value, typename Proto, size_t kCount>
Proto ToProto(const std::pair<Value, Proto> (&pairs)[kCount], Value wanted) {
  for (const auto& [value, proto] : pairs) {
    if (value == wanted) return proto;
  }
  return Proto{};  // unspecified
}

// Sets `value` unless the field is unspecified.
template <typename Value, typename Proto, size_t kCount>
absl::Status FromProto(const std::pair<Value, Proto> (&pairs)[kCount],
                       const char* field,
                       Proto wanted,
                       Value* value) {
  if (wanted == Proto{}) return absl::OkStatus();
  for (const auto& pair : pairs) {
    if (pair.second != wanted) continue;
    *value = pair.first;
    return absl::OkStatus();
  }
  const std::string words =
      absl::StrJoin(pairs, ", ", [](std::string* out, const std::pair<Value, Proto>& pair) {
        out->append(
            google::protobuf::GetEnumDescriptor<Proto>()->FindValueByNumber(pair.second)->name());
      });
  return absl::InvalidArgumentError(
      absl::StrFormat("options.%s = %d, want one of %s", field, static_cast<int>(wanted), words));
}

// What the message has, and else the default that is there.
SampleOptions SampleOptionsFromProto(const v1::SampleOptions& proto) {
  SampleOptions samples;
  if (proto.has_max_depth_bend()) samples.max_depth_bend = proto.max_depth_bend();
  if (proto.has_depth_noise()) samples.depth_noise = proto.depth_noise();
  if (proto.has_min_cos_light()) samples.min_cos_light = proto.min_cos_light();
  if (proto.has_min_cos_eye()) samples.min_cos_eye = proto.min_cos_eye();
  if (proto.has_min_samples()) samples.min_samples = proto.min_samples();
  if (proto.has_edge_window()) samples.edge_window = proto.edge_window();
  if (proto.has_use_outlines()) samples.use_outlines = proto.use_outlines();
  if (proto.has_use_terminators()) samples.use_terminators = proto.use_terminators();
  return samples;
}

}  // namespace

v1::FitOptions FitOptionsToProto(const FitOptions& options) {
  v1::FitOptions proto;
  v1::SampleOptions& samples = *proto.mutable_samples();
  samples.set_max_depth_bend(options.samples.max_depth_bend);
  samples.set_depth_noise(options.samples.depth_noise);
  samples.set_min_cos_light(options.samples.min_cos_light);
  samples.set_min_cos_eye(options.samples.min_cos_eye);
  samples.set_min_samples(options.samples.min_samples);
  samples.set_edge_window(options.samples.edge_window);
  samples.set_use_outlines(options.samples.use_outlines);
  samples.set_use_terminators(options.samples.use_terminators);
  proto.set_metric(ToProto(kMetrics, options.metric));
  proto.set_cover(ToProto(kCovers, options.cover));
  proto.set_border(ToProto(kBorders, options.border));
  proto.set_search(ToProto(kSearches, options.search));
  proto.set_affine(ToProto(kAffines, options.affine));
  proto.set_ray_space(ToProto(kRaySpaces, options.ray_space));
  proto.set_refiner(ToProto(kRefiners, options.refiner));
  proto.set_margin_percent(options.margin_percent);
  proto.set_margin_texels(options.margin_texels);
  proto.set_min_w(options.min_w);
  proto.set_along_edge_share(options.along_edge_share);
  proto.set_reweighting_rounds(options.reweighting_rounds);
  proto.set_line_search_rounds(options.line_search_rounds);
  proto.set_grid_directions(options.grid_directions);
  proto.set_sample_by_sample(options.sample_by_sample);
  proto.set_compute_statistics(options.compute_statistics);
  proto.set_use_fine_cover(options.use_fine_cover);
  return proto;
}

absl::StatusOr<FitOptions> FitOptionsFromProto(const v1::FitOptions& proto) {
  FitOptions options;
  options.samples = SampleOptionsFromProto(proto.samples());
  for (const absl::Status& status :
       {FromProto(kMetrics, "metric", proto.metric(), &options.metric),
        FromProto(kCovers, "cover", proto.cover(), &options.cover),
        FromProto(kBorders, "border", proto.border(), &options.border),
        FromProto(kSearches, "search", proto.search(), &options.search),
        FromProto(kAffines, "affine", proto.affine(), &options.affine),
        FromProto(kRaySpaces, "ray_space", proto.ray_space(), &options.ray_space),
        FromProto(kRefiners, "refiner", proto.refiner(), &options.refiner)}) {
    if (!status.ok()) return status;
  }
  if (proto.has_margin_percent()) options.margin_percent = proto.margin_percent();
  if (proto.has_margin_texels()) options.margin_texels = proto.margin_texels();
  if (proto.has_min_w()) options.min_w = proto.min_w();
  if (proto.has_along_edge_share()) options.along_edge_share = proto.along_edge_share();
  if (proto.has_reweighting_rounds()) options.reweighting_rounds = proto.reweighting_rounds();
  if (proto.has_line_search_rounds()) options.line_search_rounds = proto.line_search_rounds();
  if (proto.has_grid_directions()) options.grid_directions = proto.grid_directions();
  if (proto.has_sample_by_sample()) options.sample_by_sample = proto.sample_by_sample();
  if (proto.has_compute_statistics()) options.compute_statistics = proto.compute_statistics();
  if (proto.has_use_fine_cover()) options.use_fine_cover = proto.use_fine_cover();
  if (absl::Status status = ValidateFitOptions(options); !status.ok()) return status;
  return options;
}

}  // namespace lightfit
