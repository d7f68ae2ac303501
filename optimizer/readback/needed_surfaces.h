// optimizer/readback/needed_surfaces.h
//
// Which surfaces of a read-back need room in one light's map: those that its border would answer
// wrongly.
// In:   Surfaces, Light, Border.
// Out:  NeededSurfaces: a word per pixel to filter surfaces by (SurfaceFilter).
#pragma once

#include <cstdint>

#include "absl/types/span.h"
#include "base/scratch.h"
#include "geometry/border.h"
#include "geometry/light.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

// One word for each pixel, whose bit Light::shadow_bit is 1 where the surface is needed: in shadow
// with a lit border, lit with a dark one. Other bits mean nothing.
class NeededSurfaces {
 public:
  // Which surfaces face the light is taken from the third state (Readback::facing_bits) where it is
  // known of this light. Else what is not shadowed is lit unless the depth's normal is turned away,
  // which where no plane is known it is not. Of no use once a StopScope says so.
  NeededSurfaces(const Surfaces& surfaces, const Light& light, Border border);

  // Refers to this object, or to the read-back.
  absl::Span<const uint32_t> words() const { return words_; }

 private:
  ScratchVector<uint32_t> own_words_;
  absl::Span<const uint32_t> words_;
};

}  // namespace lightfit
