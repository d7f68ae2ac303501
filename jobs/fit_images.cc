#include "jobs/fit_images.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "jobs/matrix_judge.h"
#include "optimizer/figures/footprint_image.h"
#include "optimizer/figures/foretell.h"
#include "optimizer/figures/pixel_footprint.h"

namespace lightfit {
namespace {

std::vector<SizedMatrix> MapsOf(const FitComparison& light) {
  if (!light.plan.has_value()) {
    return {{light.final->matrix.map_from_world, light.final->matrix.map}};
  }
  std::vector<SizedMatrix> maps;
  for (const LightMatrix& map : (*light.plan)->plan.maps) {
    maps.push_back({map.map_from_world, map.map});
  }
  return maps;
}

}  // namespace

absl::StatusOr<std::vector<ExrImage>> FitImages(const Readback& readback,
                                                absl::Span<const FitComparison> lights,
                                                const FitOptions& options) {
  const SampleOptions samples = FigureOptions(options).samples;
  std::vector<ExrImage> images;
  for (const FitComparison& light : lights) {
    if (!light.ok()) continue;
    const std::vector<SizedMatrix> maps = MapsOf(light);
    absl::StatusOr<std::vector<float>> footprints =
        FootprintImage(readback, light.light, maps, samples);
    if (!footprints.ok()) return footprints.status();
    absl::StatusOr<std::vector<float>> wrong =
        ForetellWrongImage(readback, light.light, maps, samples, light.border());
    if (!wrong.ok()) return wrong.status();
    images.push_back({absl::StrCat("footprint.", light.light.name), *std::move(footprints)});
    images.push_back({absl::StrCat("wrong.", light.light.name), *std::move(wrong)});
  }
  return images;
}

}  // namespace lightfit
