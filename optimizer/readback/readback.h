// optimizer/readback/readback.h
//
// The read-back: a low-resolution image of what the camera sees, one shadow bit per light.
// In:   buffers that belong to the caller (no copy is made; they must outlive the calls).
// Out:  a checked view that the stations downstream read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "absl/status/status.h"
#include "absl/types/span.h"
#include "geometry/affine_depth.h"
#include "geometry/border.h"
#include "geometry/camera.h"

namespace lightfit {

// How it is known which surfaces face a light.
enum class FacingSource {
  kGuessed,  // from the depth's normals
  kGiven     // by the renderer, Readback::facing_bits
};

// The same view in finer cells, for the cover alone: what is thinner than a pixel of the read-back
// lies outside a map that is fitted tightly. Each cell is one pixel of a larger image, or several
// reduced conservatively. Row-major, top row first, columns * rows values each.
struct FineCover {
  int columns = 0, rows = 0;  // over the whole of the read-back's image

  // Of the read-back's kind: the nearest and the furthest surface of each cell, background where it
  // has none. `furthest` may be empty: cells of one pixel.
  absl::Span<const float> nearest, furthest;

  // Bit l is 1 where the light with shadow_bit l is blocked at any pixel of the cell; where it
  // lights any. `lit_bits` may be empty: known of no light; else of those in `lit_lights`.
  absl::Span<const uint32_t> shadow_bits, lit_bits;
  uint32_t lit_lights = ~uint32_t{0};

  // Those of the surfaces that a border answers wrongly; empty where they are not known.
  absl::Span<const uint32_t> NeededBits(Border border, int shadow_bit) const {
    if (border == Border::kLit) return shadow_bits;
    return ((lit_lights >> shadow_bit) & 1u) != 0 ? lit_bits : absl::Span<const uint32_t>();
  }
};

struct Readback {
  Camera camera;  // its width and height are the read-back's, pixels

  // Row-major, top row first, width * height values of the stated kind.
  absl::Span<const float> depth;
  DepthKind depth_kind = DepthKind::kCameraZ;

  // Row-major, width * height words; bit l is 1 where the light with shadow_bit l is blocked.
  absl::Span<const uint32_t> shadow_bits;

  // The third state, optional: as shadow_bits, but bit l is 1 where the surface faces that light,
  // by the sign of the renderer's own cosine, so that facing without shadow is lit. Where it is
  // known is a shadow without facing no shadow. Empty: known of no light.
  absl::Span<const uint32_t> facing_bits = {};
  uint32_t facing_lights = ~uint32_t{0};  // the bits that mean something, where there are any

  // What the map that is drawn with says at the pixel, optional: bit l is 1 where its look-up finds
  // shadow. Compared with the truth it measures what is wrong, see optimizer/figures/foretell.h.
  absl::Span<const uint32_t> mapped_bits = {};
  uint32_t mapped_lights = ~uint32_t{0};

  int width() const { return camera.width; }
  int height() const { return camera.height; }

  // Optional; must outlive the calls, as the buffers.
  const FineCover* fine_cover = nullptr;

  // Depths at or beyond this one are background, where they are distances (kCameraZ, kDistance);
  // infinity: those of kBackgroundDepth and more. Not set: so they are, and FindSurfaces() looks
  // for a sky that is nearer (optimizer/readback/background.h). Shadow bits of the background mean
  // nothing.
  std::optional<float> background = std::nullopt;

  bool KnowsFacing(int shadow_bit) const {
    return !facing_bits.empty() && ((facing_lights >> shadow_bit) & 1u) != 0;
  }
  FacingSource FacingOf(int shadow_bit) const {
    return KnowsFacing(shadow_bit) ? FacingSource::kGiven : FacingSource::kGuessed;
  }
  bool KnowsMapped(int shadow_bit) const {
    return !mapped_bits.empty() && ((mapped_lights >> shadow_bit) & 1u) != 0;
  }

  // Where the pixel with column x and row y stands in `depth` and `shadow_bits`.
  size_t Index(int x, int y) const { return static_cast<size_t>(y) * camera.width + x; }
};

// What its depths mean.
inline AffineDepth AffineDepthOf(const Readback& readback) {
  return AffineDepth(
      readback.camera, readback.depth_kind, readback.background.value_or(kBackgroundDepth));
}

// Checks the camera and the buffer sizes; says which field is wrong, its value, and what is wanted.
// Pixels are looked at later: single bad depths are counted and ignored, see
// optimizer/readback/surfaces.h.
absl::Status ValidateReadback(const Readback& readback);

}  // namespace lightfit
