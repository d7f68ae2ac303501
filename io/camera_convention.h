// io/camera_convention.h
//
// What a renderer means by the matrices that it writes into an EXR header.
// In:   words, "column-vectors,y-up", or the name of a preset.
// Out:  CameraConvention.
//
// The OpenEXR standard is the default. Renderers differ from it in the ways listed here, and
// nothing in the file says so: CameraFromExrMatrices() refuses what does not hold together and
// names the words under which it would.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace lightfit {

struct CameraConvention {
  // p' = p M, translation in elements 12 ... 14; or p' = M p, translation in 3, 7, 11.
  enum class Layout { kRowVectors, kColumnVectors };
  // Where worldToNDC puts the frame: 0 ... 1 or -1 ... 1 from edge to edge.
  enum class NdcRange { kZeroToOne, kMinusOneToOne };
  // Which way NDC y grows in the image.
  enum class NdcY { kDown, kUp };
  // Which way the camera looks in its own space; +x is right and +y is up in either case.
  enum class ViewAxis { kPlusZ, kMinusZ };
  // The sign of worldToNDC's w in front of the camera. kNegative: a sign to be dropped, so that
  // NDC = (x, y) / |w|.
  enum class NdcW { kPositive, kNegative };
  // Which extent of the frame the NDC range spans; the other extent goes beyond in proportion.
  enum class NdcSpan { kWholeFrame, kShorterSide };
  // Where the camera's axis meets the frame. kNearMiddle is no limit, but doubt: further away the
  // convention that puts it nearer the middle is the likelier one. kAnywhere: the lens is shifted,
  // or the frame is a tile of a larger one.
  enum class FrameCentre { kNearMiddle, kAnywhere };

  Layout layout = Layout::kRowVectors;                  // "row-vectors", "column-vectors"
  NdcRange ndc_range = NdcRange::kZeroToOne;            // "ndc-0-1", "ndc-minus-1-1"
  NdcY ndc_y = NdcY::kDown;                             // "y-down", "y-up"
  ViewAxis view_axis = ViewAxis::kPlusZ;                // "looks-plus-z", "looks-minus-z"
  NdcW ndc_w = NdcW::kPositive;                         // "w-positive", "w-negative"
  NdcSpan ndc_span = NdcSpan::kWholeFrame;              // "whole-frame", "shorter-side"
  FrameCentre frame_centre = FrameCentre::kNearMiddle;  // "centred", "shifted"

  static CameraConvention OpenExr() { return {}; }  // "openexr": also RenderMan
  static CameraConvention Mantra();                 // "mantra"
  static CameraConvention Pbrt();                   // "pbrt"

  bool operator==(const CameraConvention& other) const = default;
};

// Comma-separated words in any order, later ones win: "mantra", "column-vectors,y-up", "".
absl::StatusOr<CameraConvention> ParseCameraConvention(absl::string_view words);

// The words in which `convention` differs from `base`; "" when it does not.
std::string CameraConventionWords(const CameraConvention& convention,
                                  const CameraConvention& base = {});

}  // namespace lightfit
