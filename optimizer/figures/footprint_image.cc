#include "optimizer/figures/footprint_image.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <optional>

#include "geometry/affine_depth.h"
#include "optimizer/readback/samples.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

namespace {

absl::StatusOr<std::vector<float>> ImageOf(const Readback& readback,
                                           const absl::StatusOr<PixelFootprints>& pixels) {
  if (!pixels.ok()) return pixels.status();
  std::vector<float> footprints(readback.depth.size(), 0.0f);
  for (int y = 0; y < readback.height(); ++y) {
    for (int x = 0; x < readback.width(); ++x) {
      const std::optional<PixelFootprint> pixel = pixels->At(x, y);
      if (!pixel.has_value()) continue;
      const double footprint = std::sqrt(0.5) * pixel->J_screen_map.norm();
      if (!std::isfinite(footprint)) continue;
      footprints[readback.Index(x, y)] = static_cast<float>(footprint);
    }
  }
  return footprints;
}

}  // namespace

absl::StatusOr<std::vector<float>> FootprintImage(const Readback& readback,
                                                  const Light& light,
                                                  const Eigen::Matrix4d& map_from_world,
                                                  const SampleOptions& options) {
  return ImageOf(readback, PixelFootprints::Create(readback, light, map_from_world, options));
}

absl::StatusOr<std::vector<float>> FootprintImage(const Readback& readback,
                                                  const Light& light,
                                                  absl::Span<const SizedMatrix> maps,
                                                  const SampleOptions& options) {
  return ImageOf(readback, PixelFootprints::Create(readback, light, maps, options));
}

absl::StatusOr<std::vector<uint8_t>> SampleImage(const Surfaces& surfaces,
                                                 const Light& light,
                                                 const SampleOptions& options) {
  if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  const Readback& readback = surfaces.readback;
  const Samples samples = SelectSamples(
      surfaces, light, options, Eigen::Matrix3d::Identity(), /*with_edge_normals=*/false);
  std::vector<uint8_t> used(readback.depth.size(), 0);
  for (size_t i = 0; i < samples.size(); ++i) {
    used[readback.Index(static_cast<int>(samples.x[i]), static_cast<int>(samples.y[i]))] = 1;
  }
  return used;
}

absl::StatusOr<std::vector<Eigen::Vector3d>> ReceiverPositions(const Readback& readback) {
  if (absl::Status status = ValidateReadback(readback); !status.ok()) return status;
  const AffineDepth affine_depth = AffineDepthOf(readback);
  const Eigen::Matrix4d world_from_screen = readback.camera.WorldFromScreen();
  std::vector<Eigen::Vector3d> positions;
  for (int y = 0; y < readback.height(); ++y) {
    for (int x = 0; x < readback.width(); ++x) {
      const double depth = readback.depth[readback.Index(x, y)];
      if (!affine_depth.IsSurface(depth)) continue;
      const Eigen::Vector4d screen(x + 0.5, y + 0.5, affine_depth.At(x, y, depth), 1.0);
      positions.push_back((world_from_screen * screen).hnormalized());
    }
  }
  return positions;
}

}  // namespace lightfit
