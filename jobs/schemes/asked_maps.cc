#include "jobs/schemes/asked_maps.h"

#include <functional>

namespace lightfit {

namespace {

using AskedAt = std::function<int(const Eigen::Vector3d& world)>;

AskedAt AskedOf(const ParaboloidPair& pair) {
  return [&pair](const Eigen::Vector3d& world) { return pair.At(world).half; };
}

AskedAt AskedOf(const PagedMap& map) {
  return [&map](const Eigen::Vector3d& world) {
    const int page = map.At(world).page;
    return page < 0 ? -1 : map.pages[page].level - map.pages.front().level;
  };
}

}  // namespace

std::vector<int> AskedMaps(const SchemeMaps& maps, const Light& light, const SurfaceImage& image) {
  AskedAt asked_at;
  if (const auto* pair = std::get_if<ParaboloidPair>(&maps.maps)) asked_at = AskedOf(*pair);
  if (const auto* rasterised = std::get_if<RasterisedPair>(&maps.maps)) {
    asked_at = AskedOf(rasterised->pair);
  }
  if (const auto* pages = std::get_if<PagedMap>(&maps.maps)) asked_at = AskedOf(*pages);
  if (const Plan* plan = PlanOf(maps)) {
    const absl::StatusOr<PlanLookUp> look_up = PlanLookUp::Create(*plan, light, maps.guard_texels);
    if (look_up.ok()) {
      asked_at = [look_up = *look_up](const Eigen::Vector3d& world) {
        return look_up.At(world).map;
      };
    }
  }
  std::vector<int> asked(image.pixels.size(), -1);
  if (!asked_at) return asked;
  for (size_t i = 0; i < asked.size(); ++i) {
    if (image.pixels[i].is_surface()) asked[i] = asked_at(image.pixels[i].position);
  }
  return asked;
}

}  // namespace lightfit
