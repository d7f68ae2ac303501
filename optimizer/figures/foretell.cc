#include "optimizer/figures/foretell.h"

#include <algorithm>

#include "geometry/affine_depth.h"
#include "optimizer/figures/foretell_by_bits.h"
#include "optimizer/figures/foretell_by_state.h"
#include "optimizer/figures/pixel_footprint.h"
#include "optimizer/readback/fine_cover.h"

namespace lightfit {

namespace {

// The share of the finer cells that the border answers wrongly and that lie outside all maps;
// nothing where none are known.
std::optional<double> OutsideShareOfFineCover(const Readback& readback,
                                              const Light& light,
                                              absl::Span<const SizedMatrix> maps,
                                              Border border) {
  if (readback.fine_cover == nullptr) return std::nullopt;
  const FineCover& fine = *readback.fine_cover;
  const absl::Span<const uint32_t> words = fine.NeededBits(border, light.shadow_bit);
  if (words.empty()) return std::nullopt;
  const uint32_t bit = uint32_t{1} << light.shadow_bit;
  const Readback layer = FineLayer(readback, 0, words);
  const AffineDepth affine_depth = AffineDepthOf(layer);
  const Eigen::Matrix4d world_from_screen = layer.camera.WorldFromScreen();
  int64_t num_outside = 0;
  for (int y = 0; y < fine.rows; ++y) {
    for (int x = 0; x < fine.columns; ++x) {
      const size_t cell = layer.Index(x, y);
      if ((words[cell] & bit) == 0 || !affine_depth.IsSurface(layer.depth[cell])) continue;
      const double d = affine_depth.At(x, y, layer.depth[cell]);
      const Eigen::Vector4d world = world_from_screen * Eigen::Vector4d(x + 0.5, y + 0.5, d, 1.0);
      const bool is_inside = std::any_of(maps.begin(), maps.end(), [&](const SizedMatrix& map) {
        const Eigen::Vector4d at = map.map_from_world * world;
        return at.w() > 0.0 && at.x() >= 0.0 && at.y() >= 0.0 &&
               at.x() <= map.size.width * at.w() && at.y() <= map.size.height * at.w();
      });
      num_outside += is_inside ? 0 : 1;
    }
  }
  return static_cast<double>(num_outside) / static_cast<double>(words.size());
}

}  // namespace

absl::StatusOr<double> ForetellWrongShare(const Readback& readback,
                                          const Light& light,
                                          const Eigen::Matrix4d& map_from_world,
                                          MapSize map,
                                          const SampleOptions& options,
                                          Border border) {
  const SizedMatrix sized = {map_from_world, map};
  return ForetellWrongShare(readback, light, absl::MakeConstSpan(&sized, 1), options, border);
}

absl::StatusOr<double> ForetellWrongShare(const Readback& readback,
                                          const Light& light,
                                          absl::Span<const SizedMatrix> maps,
                                          const SampleOptions& options,
                                          Border border) {
  const absl::StatusOr<PixelFootprints> footprints =
      PixelFootprints::Create(readback, light, maps, options);
  if (!footprints.ok()) return footprints.status();
  // What lies outside the finer image tells better.
  const std::optional<double> outside = OutsideShareOfFineCover(readback, light, maps, border);
  const std::optional<Border> counted = outside.has_value() ? std::nullopt : std::optional(border);
  const absl::StatusOr<double> share = readback.KnowsFacing(light.shadow_bit)
                                           ? ForetellByState(readback, light, *footprints, counted)
                                           : ForetellByBits(readback, light, *footprints, counted);
  if (!share.ok()) return share.status();
  return std::min(*share + outside.value_or(0.0), 1.0);
}

absl::StatusOr<std::vector<float>> ForetellWrongImage(const Readback& readback,
                                                      const Light& light,
                                                      absl::Span<const SizedMatrix> maps,
                                                      const SampleOptions& options,
                                                      Border border) {
  const absl::StatusOr<PixelFootprints> footprints =
      PixelFootprints::Create(readback, light, maps, options);
  if (!footprints.ok()) return footprints.status();
  std::vector<float> image(readback.depth.size(), 0.0F);
  const absl::Status status =
      readback.KnowsFacing(light.shadow_bit)
          ? ForetellImageByState(readback, light, *footprints, border, absl::MakeSpan(image))
          : ForetellImageByBits(readback, light, *footprints, border, absl::MakeSpan(image));
  if (!status.ok()) return status;
  return image;
}

double ForecastFactor(const Readback& readback, const Light& light) {
  // Measured at 180x180 over ten scenes: docs/defaults.md.
  return readback.KnowsFacing(light.shadow_bit) ? 1.8 : 2.3;
}

std::optional<double> MeasuredWrongShare(const Readback& readback, const Light& light) {
  if (!readback.KnowsMapped(light.shadow_bit)) return std::nullopt;
  const AffineDepth affine_depth = AffineDepthOf(readback);
  const uint32_t bit = uint32_t{1} << light.shadow_bit;
  const bool knows_facing = readback.KnowsFacing(light.shadow_bit);
  int64_t num_wrong = 0;
  for (size_t i = 0; i < readback.depth.size(); ++i) {
    if (!affine_depth.IsSurface(readback.depth[i])) continue;
    if (knows_facing && (readback.facing_bits[i] & bit) == 0) continue;
    num_wrong += ((readback.shadow_bits[i] ^ readback.mapped_bits[i]) & bit) != 0 ? 1 : 0;
  }
  return static_cast<double>(num_wrong) / static_cast<double>(readback.depth.size());
}

}  // namespace lightfit
