#include "io/options_proto.h"

namespace lightfit {

namespace {

v1::Metric MetricToProto(Metric metric) {
  switch (metric) {
    case Metric::kL2:
      return v1::METRIC_L2;
    case Metric::kL2AcrossEdge:
      return v1::METRIC_L2_ACROSS_EDGE;
    case Metric::kL1:
      return v1::METRIC_L1;
    case Metric::kL1AcrossEdge:
      return v1::METRIC_L1_ACROSS_EDGE;
  }
  return v1::METRIC_UNSPECIFIED;
}

v1::Cover CoverToProto(Cover cover) {
  switch (cover) {
    case Cover::kReceivers:
      return v1::COVER_RECEIVERS;
    case Cover::kShadowed:
      return v1::COVER_SHADOWED;
  }
  return v1::COVER_UNSPECIFIED;
}

v1::Search SearchToProto(Search search) {
  switch (search) {
    case Search::kFocused:
      return v1::SEARCH_FOCUSED;
    case Search::kRotationLineSearch:
      return v1::SEARCH_ROTATION_LINE_SEARCH;
    case Search::kRotationLineSearchRefined:
      return v1::SEARCH_ROTATION_LINE_SEARCH_REFINED;
    case Search::kGlobal:
      return v1::SEARCH_GLOBAL;
  }
  return v1::SEARCH_UNSPECIFIED;
}

v1::Affine AffineToProto(Affine affine) {
  switch (affine) {
    case Affine::kMinAreaRectangle:
      return v1::AFFINE_MIN_AREA_RECTANGLE;
    case Affine::kMinAreaRectangleCgal:
      return v1::AFFINE_MIN_AREA_RECTANGLE_CGAL;
    case Affine::kSkewedRectangle:
      return v1::AFFINE_SKEWED_RECTANGLE;
    case Affine::kMinEnergyParallelogram:
      return v1::AFFINE_MIN_ENERGY_PARALLELOGRAM;
  }
  return v1::AFFINE_UNSPECIFIED;
}

v1::RaySpace RaySpaceToProto(RaySpace ray_space) {
  switch (ray_space) {
    case RaySpace::kLightSpace:
      return v1::RAY_SPACE_LIGHT_SPACE;
    case RaySpace::kNormalized:
      return v1::RAY_SPACE_NORMALIZED;
  }
  return v1::RAY_SPACE_UNSPECIFIED;
}

v1::Refiner RefinerToProto(Refiner refiner) {
  switch (refiner) {
    case Refiner::kTinySolver:
      return v1::REFINER_TINY_SOLVER;
    case Refiner::kCeres:
      return v1::REFINER_CERES;
  }
  return v1::REFINER_UNSPECIFIED;
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
  proto.set_metric(MetricToProto(options.metric));
  proto.set_cover(CoverToProto(options.cover));
  proto.set_search(SearchToProto(options.search));
  proto.set_affine(AffineToProto(options.affine));
  proto.set_ray_space(RaySpaceToProto(options.ray_space));
  proto.set_refiner(RefinerToProto(options.refiner));
  proto.set_margin_percent(options.margin_percent);
  proto.set_margin_texels(options.margin_texels);
  proto.set_min_w(options.min_w);
  proto.set_along_edge_share(options.along_edge_share);
  proto.set_reweighting_rounds(options.reweighting_rounds);
  proto.set_line_search_rounds(options.line_search_rounds);
  proto.set_grid_directions(options.grid_directions);
  proto.set_sample_by_sample(options.sample_by_sample);
  proto.set_compute_statistics(options.compute_statistics);
  return proto;
}

}  // namespace lightfit
