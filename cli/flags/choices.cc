#include "cli/flags/choices.h"

#include "absl/strings/ascii.h"
#include "absl/strings/str_replace.h"

namespace lightfit::cli {
namespace {

// What others, and the library in its messages, call these things.
struct Alias {
  const char* name;
  const char* word;
};
constexpr Alias kAliases[] = {
    // Clip spaces, by the interfaces that have them.
    {"vk", "vulkan"},
    {"d3d", "direct3d"},
    {"dx", "direct3d"},
    {"directx", "direct3d"},
    {"d3d11", "direct3d"},
    {"d3d12", "direct3d"},
    {"dx11", "direct3d"},
    {"dx12", "direct3d"},
    {"metal", "direct3d"},
    {"webgpu", "direct3d"},
    {"gl", "opengl"},
    {"webgl", "opengl"},
    {"gles", "opengl"},
    {"opengl-es", "opengl"},
    {"reversed", "reversed-z"},
    {"reverse-z", "reversed-z"},
    {"vulkan-reversed", "reversed-z"},
    {"vulkan-reversed-z", "reversed-z"},
    {"vk-reversed", "reversed-z"},
    {"d3d-reversed", "direct3d-reversed"},
    {"dx12-reversed", "direct3d-reversed"},
    {"metal-reversed", "direct3d-reversed"},
    {"webgpu-reversed", "direct3d-reversed"},
    {"direct3d-reversed-z", "direct3d-reversed"},
    {"d3d-reversed-z", "direct3d-reversed"},
    {"metal-reversed-z", "direct3d-reversed"},
    {"webgpu-reversed-z", "direct3d-reversed"},
    // Depth.
    {"z", "camera-z"},
    {"linear", "camera-z"},
    {"linear-z", "camera-z"},
    {"eye-z", "camera-z"},
    {"view-z", "camera-z"},
    {"radial", "distance"},
    {"ray", "distance"},
    {"ray-distance", "distance"},
    {"ndc", "ndc-0-1"},
    {"ndc-01", "ndc-0-1"},
    {"ndc-zero-to-one", "ndc-0-1"},
    {"vulkan", "ndc-0-1"},
    {"direct3d", "ndc-0-1"},
    {"vk", "ndc-0-1"},
    {"d3d", "ndc-0-1"},
    {"metal", "ndc-0-1"},
    {"webgpu", "ndc-0-1"},
    {"ndc-11", "ndc-minus-1-1"},
    {"ndc--1-1", "ndc-minus-1-1"},
    {"ndc-minus-one-to-one", "ndc-minus-1-1"},
    {"opengl", "ndc-minus-1-1"},
    {"gl", "ndc-minus-1-1"},
    {"reversed-z", "ndc-reversed"},
    {"reversed", "ndc-reversed"},
    {"ndc-1-0", "ndc-reversed"},
    {"ndc-reversed-z", "ndc-reversed"},
    {"ndc-reversed-zero-to-one", "ndc-reversed"},
    // Methods.
    {"none", "focused"},
    {"all", "receivers"},
    {"visible", "receivers"},
    {"shadow", "shadowed"},
    {"shadows", "shadowed"},
    {"light", "lit"},
    {"white", "lit"},
    {"shadow", "dark"},
    {"shadowed", "dark"},
    {"black", "dark"},
    {"automatic", "auto"},
    {"l1-across-edge", "l1-edge"},
    {"l2-across-edge", "l2-edge"},
    // Levels of a log.
    {"warn", "warning"},
    {"err", "error"},
};

}  // namespace

std::string PlainWord(std::string text) {
  absl::AsciiStrToLower(&text);
  absl::StrReplaceAll({{"_", "-"}, {" ", "-"}}, &text);
  return text;
}

std::vector<std::string> MeantBy(const std::string& text) {
  const std::string plain = PlainWord(text);
  std::vector<std::string> meant = {plain};
  for (const Alias& alias : kAliases) {
    if (plain == alias.name) meant.emplace_back(alias.word);
  }
  return meant;
}

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

const Words<Bias>& BiasWords() {
  static const auto& words =
      *new Words<Bias>{{"ideal", Bias::kIdeal}, {"practical", Bias::kPractical}};
  return words;
}

const Words<std::string>& LogLevelWords() {
  static const auto& words = *new Words<std::string>{
      {"debug", "debug"}, {"info", "info"}, {"warning", "warning"}, {"error", "error"}};
  return words;
}

}  // namespace lightfit::cli
