// render/flicker.h
//
// Shadow pixels that flip from one frame to the next while nothing in the scene does.
// In:   the surfaces of one frame, those of them that the other frame sees too, the true lighting,
//       and a light's map in each frame.
// Out:  Flicker: at how many of those pixels the two maps say different things.
//
// Both maps are asked at the same surfaces, those of one frame, whose true state is one and the
// same: what differs is the maps' doing alone. Of the phases that wrong pixels are counted over
// (JudgeOptions::phases) flips are those between the first of either map.   math.md 7
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "render/judge.h"
#include "render/surface_image.h"
#include "render/true_lighting.h"

namespace lightfit {

struct Flicker {
  int64_t judged = 0;           // pixels that face the light and are seen in both frames
  int64_t flips_ideal = 0;      // of them: under the ideal bias
  int64_t flips_practical = 0;  // of them: under the practical bias
};

// Per pixel of `image` 1 where its surface is seen by the other camera as well, else 0.
// InvalidArgument for a camera that cannot be used.
absl::StatusOr<std::vector<uint8_t>> SeenFrom(const Camera& other,
                                              const RayCaster& caster,
                                              const SurfaceImage& image);

// The maps of both frames judged on the image of one of them, see JudgeFirstPhase(). All three
// arguments are of that image's size; what is 0 in `seen_in_both` does not count.
Flicker CountFlips(const ShadowImage& a,
                   const ShadowImage& b,
                   absl::Span<const uint8_t> seen_in_both);

// The same from the maps, each with its own border. Errors are those of JudgeMatrix(), and
// InvalidArgument for a mask of another size.
absl::StatusOr<Flicker> MeasureFlicker(const RayCaster& caster,
                                       const SurfaceImage& image,
                                       absl::Span<const uint8_t> seen_in_both,
                                       absl::Span<const Lighting> truth,
                                       const Light& light,
                                       const JudgedMap& a,
                                       const JudgedMap& b,
                                       const JudgeOptions& options = {});

}  // namespace lightfit
