// optimizer/readback/background.h
//
// The sky as a finite depth: "nothing hit" as 65504 (the largest half float), a far plane, 1e6.
// In:   a read-back whose depth is a distance.
// Out:  the one greatest depth that many pixels share, far beyond all others; whether it is the
//       background.
//
// What tells it from a wall: all of these pixels have the very same value; nothing lies just before
// it, as a floor or a side of the room would; and it is a number that programs write, or a distance
// along the ray, which no surface keeps over many pixels, or far beyond anything else, without a
// shadow's edge on it. A plane that is parallel to the screen has one depth, too, so what is
// doubtful stays a surface, and is told.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "absl/strings/string_view.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

struct FarDepth {
  float depth = 0;   // that all of these pixels have
  double share = 0;  // of all pixels
  float next = 0;    // the greatest depth of the others; meaningless without any
  bool has_others = false;
  bool is_background = false;  // else it may be a surface

  // For a warning, without the read-back's name; `option` is what states the background: with
  // "--background ", "--background 65504".
  std::string Text(absl::string_view option, absl::string_view infinity) const;
};

// Shadow bits count for the lights in `light_mask`. Of valid read-backs. Nothing where nothing is
// remarkable, as for all depths between clip planes.
std::optional<FarDepth> FindFarDepth(const Readback& readback, uint32_t light_mask);

// Sets Readback::background where the caller has not: to what was found, else to infinity. Returns
// what is worth a warning.
std::optional<FarDepth> SettleBackground(uint32_t light_mask, Readback* readback);

}  // namespace lightfit
