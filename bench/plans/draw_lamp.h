// bench/plans/draw_lamp.h
//
// Lamps with receivers all around them.
// In:   a CompareStage, a seed.
// Out:  a lamp in the middle of what the camera sees, with its read-back; the same for equal seeds.
//
// A lamp stands on the sight line of a pixel in the middle half of the picture, 30 to 90 % of the
// way to what is seen there, or to where half of all pixels are nearer if that is less; and as far
// from surfaces as DrawLights() has them. No single map holds what the camera sees. Of a hundred
// lines that the seed draws the first such place is taken.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "jobs/compare/stage.h"
#include "optimizer/readback/cover.h"

namespace lightfit {

// Whether a single map holds all that must be covered. The stage must have its surfaces.
bool HasSingleMap(const LitStage& lit, Cover cover);

// Nothing where no such place is found.
std::optional<LitStage> DrawLamp(const CompareStage& stage, const std::string& name, uint64_t seed);

}  // namespace lightfit
