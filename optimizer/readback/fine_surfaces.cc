#include "optimizer/readback/fine_surfaces.h"

#include <cstdint>
#include <utility>

#include "absl/types/span.h"
#include "optimizer/readback/fine_cover.h"

namespace lightfit {

ScratchVector<FineSurfaces> FindFineSurfaces(const Surfaces& surfaces,
                                             const Light& light,
                                             Border border) {
  const Readback& readback = surfaces.readback;
  ScratchVector<FineSurfaces> found;
  if (readback.fine_cover == nullptr) return found;
  const FineCover& fine = *readback.fine_cover;
  const absl::Span<const uint32_t> words = fine.NeededBits(border, light.shadow_bit);
  if (words.empty()) return found;
  for (int i = 0; i < NumFineLayers(fine); ++i) {
    FineSurfaces layer = {Surfaces(FineLayer(readback, i, words), surfaces.options), {}, {}};
    layer.tiles = BuildDepthTiles(layer.surfaces.readback,
                                  layer.surfaces.affine_depth,
                                  {words, uint32_t{1} << light.shadow_bit});
    layer.ray_from_screen = RayFromWorld(light) * layer.surfaces.world_from_screen;
    if (layer.tiles.num_surfaces > 0) found.push_back(std::move(layer));
  }
  return found;
}

}  // namespace lightfit
