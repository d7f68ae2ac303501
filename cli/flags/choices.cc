#include "cli/flags/choices.h"

namespace lightfit::cli {

const Words<Search>& SearchWords() {
  static const auto& words = *new Words<Search>{{"focused", Search::kFocused},
                                                {"line", Search::kRotationLineSearch},
                                                {"refine", Search::kRotationLineSearchRefined},
                                                {"global", Search::kGlobal}};
  return words;
}

const Words<Affine>& AffineWords() {
  static const auto& words = *new Words<Affine>{{"rectangle", Affine::kMinAreaRectangle},
                                                {"cgal-rectangle", Affine::kMinAreaRectangleCgal},
                                                {"skewed", Affine::kSkewedRectangle},
                                                {"parallelogram", Affine::kMinEnergyParallelogram}};
  return words;
}

const Words<Metric>& MetricWords() {
  static const auto& words = *new Words<Metric>{{"l2", Metric::kL2},
                                                {"l2-edge", Metric::kL2AcrossEdge},
                                                {"l1", Metric::kL1},
                                                {"l1-edge", Metric::kL1AcrossEdge}};
  return words;
}

const Words<Cover>& CoverWords() {
  static const auto& words =
      *new Words<Cover>{{"shadowed", Cover::kShadowed}, {"receivers", Cover::kReceivers}};
  return words;
}

const Words<BorderChoice>& BorderWords() {
  static const auto& words = *new Words<BorderChoice>{{"lit", BorderChoice::kLit},
                                                      {"dark", BorderChoice::kDark},
                                                      {"auto", BorderChoice::kAutomatic}};
  return words;
}

const Words<DepthKind>& DepthKindWords() {
  static const auto& words =
      *new Words<DepthKind>{{"camera-z", DepthKind::kCameraZ},
                            {"distance", DepthKind::kDistance},
                            {"ndc-0-1", DepthKind::kNdcZeroToOne},
                            {"ndc-minus-1-1", DepthKind::kNdcMinusOneToOne},
                            {"ndc-reversed", DepthKind::kNdcReversedZeroToOne}};
  return words;
}

const Words<ClipConvention>& ClipWords() {
  static const auto& words =
      *new Words<ClipConvention>{{"vulkan", ClipConvention::Vulkan()},
                                 {"direct3d", ClipConvention::Direct3D()},
                                 {"opengl", ClipConvention::OpenGl()},
                                 {"reversed-z", ClipConvention::ReversedZ()},
                                 {"direct3d-reversed", ClipConvention::Direct3DReversed()}};
  return words;
}

}  // namespace lightfit::cli
