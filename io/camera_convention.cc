#include "io/camera_convention.h"

#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"

namespace lightfit {

namespace {

using Convention = CameraConvention;

// One row per field: its two words, in the order of its enum.
template <typename Field>
struct Words {
  Field Convention::*field;
  const char* words[2];
};

// Calls visit(words) for every field of a convention until it returns true.
template <typename Visitor>
bool AnyField(Visitor visit) {
  return visit(Words<Convention::Layout>{&Convention::layout, {"row-vectors", "column-vectors"}}) ||
         visit(Words<Convention::NdcRange>{&Convention::ndc_range, {"ndc-0-1", "ndc-minus-1-1"}}) ||
         visit(Words<Convention::NdcY>{&Convention::ndc_y, {"y-down", "y-up"}}) ||
         visit(Words<Convention::ViewAxis>{&Convention::view_axis,
                                           {"looks-plus-z", "looks-minus-z"}}) ||
         visit(Words<Convention::NdcW>{&Convention::ndc_w, {"w-positive", "w-negative"}}) ||
         visit(
             Words<Convention::NdcSpan>{&Convention::ndc_span, {"whole-frame", "shorter-side"}}) ||
         visit(Words<Convention::FrameCentre>{&Convention::frame_centre, {"centred", "shifted"}});
}

bool SetWord(absl::string_view word, CameraConvention& convention) {
  return AnyField([&](const auto& field) {
    for (int value = 0; value < 2; ++value) {
      if (word != field.words[value]) continue;
      auto& target = convention.*field.field;
      target = static_cast<std::remove_reference_t<decltype(target)>>(value);
      return true;
    }
    return false;
  });
}

}  // namespace

CameraConvention CameraConvention::Mantra() {
  CameraConvention convention;
  convention.ndc_range = NdcRange::kMinusOneToOne;
  convention.ndc_y = NdcY::kUp;
  convention.ndc_w = NdcW::kNegative;
  return convention;
}

CameraConvention CameraConvention::Pbrt() {
  CameraConvention convention;
  convention.layout = Layout::kColumnVectors;
  convention.ndc_y = NdcY::kUp;
  convention.ndc_span = NdcSpan::kShorterSide;
  return convention;
}

absl::StatusOr<CameraConvention> ParseCameraConvention(absl::string_view words) {
  CameraConvention convention;
  for (absl::string_view word : absl::StrSplit(words, ',')) {
    word = absl::StripAsciiWhitespace(word);
    if (word.empty()) continue;
    if (word == "openexr") {
      convention = CameraConvention::OpenExr();
    } else if (word == "mantra") {
      convention = CameraConvention::Mantra();
    } else if (word == "pbrt") {
      convention = CameraConvention::Pbrt();
    } else if (!SetWord(word, convention)) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "camera convention: \"%s\" is not known, want openexr, mantra, pbrt, or of row-vectors, "
          "column-vectors, ndc-0-1, ndc-minus-1-1, y-down, y-up, looks-plus-z, looks-minus-z, "
          "w-positive, w-negative, whole-frame, shorter-side, centred, shifted",
          word));
    }
  }
  return convention;
}

std::string CameraConventionWords(const CameraConvention& convention,
                                  const CameraConvention& base) {
  std::vector<const char*> words;
  AnyField([&](const auto& field) {
    if (convention.*field.field != base.*field.field) {
      words.push_back(field.words[static_cast<int>(convention.*field.field)]);
    }
    return false;
  });
  return absl::StrJoin(words, ",");
}

}  // namespace lightfit
