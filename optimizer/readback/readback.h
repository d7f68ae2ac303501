// optimizer/readback/readback.h
//
// The read-back: a low-resolution image of what the camera sees, one shadow bit per light.
// In:   buffers that belong to the caller (no copy is made; they must outlive the calls).
// Out:  a checked view that the stations downstream read.
#pragma once

#include <cstddef>
#include <cstdint>

#include "absl/status/status.h"
#include "absl/types/span.h"
#include "geometry/camera.h"

namespace lightfit {

struct Readback {
  Camera camera;  // its width and height are the read-back's, pixels

  // Row-major, top row first, width * height values of the stated kind.
  absl::Span<const float> depth;
  DepthKind depth_kind = DepthKind::kCameraZ;

  // Row-major, width * height words; bit l is 1 where the light with shadow_bit l is blocked.
  absl::Span<const uint32_t> shadow_bits;

  int width() const { return camera.width; }
  int height() const { return camera.height; }

  // Where the pixel with column x and row y stands in `depth` and `shadow_bits`.
  size_t Index(int x, int y) const { return static_cast<size_t>(y) * camera.width + x; }
};

// Checks the camera and the buffer sizes; says which field is wrong, its value, and what is wanted.
// Pixels are looked at later: single bad depths are counted and ignored, see
// optimizer/readback/surfaces.h.
absl::Status ValidateReadback(const Readback& readback);

}  // namespace lightfit
