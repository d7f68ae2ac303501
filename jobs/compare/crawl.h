// jobs/compare/crawl.h
//
// How much the shadows of a method crawl to the next frame: what `lightfit compare --crawl` adds.
// In:   the next frame as a CompareStage; the method's maps in either frame.
// Out:  MapCrawl of one method and light, and of many lights together.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "jobs/compare/stage.h"
#include "jobs/schemes/scheme.h"
#include "optimizer/figures/stability.h"
#include "render/flicker.h"

namespace lightfit {

// The frame after the one that is compared. The scene and its lights stand still.
struct NextFrame {
  CompareStage stage;

  // Pixels of the present screen whose surfaces the next camera sees too, see SeenFrom(); empty
  // without truth.
  std::vector<uint8_t> seen;
};

// InvalidArgument when `next` has a caster and `present` has not, or the reverse.
absl::StatusOr<NextFrame> MakeNextFrame(const CompareStage& present, CompareStage next);

// Whether any surface of the screen is seen in both frames; without truth always.
bool SeesAnythingTwice(const NextFrame& next);

struct MapCrawl {
  Crawl points;                    // of the read-backs
  std::optional<Flicker> flicker;  // of the screen; absent without truth
};

// Of the pixels seen in both frames; absent without truth or without such pixels.
std::optional<double> IdealFlipShare(const MapCrawl& crawl);

// A light in the present frame, and maps of it with their shadows there (empty without truth).
struct PresentMaps {
  const LitStage& frame;
  absl::Span<const Lighting> truth;
  const SchemeMaps& drawn;
  const ShadowImage& shadows;
};

// From those maps to the light's in the next frame, by the same scheme. There are no points of maps
// that are no matrices.
absl::StatusOr<MapCrawl> MeasureMapCrawl(const PresentMaps& present,
                                         const NextFrame& next,
                                         const LitStage& next_frame,
                                         const SchemeMaps& next_drawn,
                                         const JudgeOptions& judge);

// As if all points, and all pixels, were one light's. Nothing from nothing.
std::optional<MapCrawl> PooledCrawl(absl::Span<const MapCrawl> crawls);

}  // namespace lightfit
