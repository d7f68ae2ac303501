// optimizer/figures/footprint_image.h
//
// What a matrix does to every pixel, and which pixels the fit looked at: for pictures.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/light.h"
#include "optimizer/figures/pixel_footprint.h"
#include "optimizer/readback/readback.h"
#include "optimizer/readback/sample_options.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

// Footprint of a texel at every pixel (FootprintStatistics has the definition), row-major,
// read-back pixels per texel; 0 where there is no surface, at discontinuities, and where the
// surface is edge-on or turned away from the light. `map_from_world` in texels, as
// LightMatrix::map_from_world.
absl::StatusOr<std::vector<float>> FootprintImage(const Readback& readback,
                                                  const Light& light,
                                                  const Eigen::Matrix4d& map_from_world,
                                                  const SampleOptions& options = {});

// The same of several maps of the light, at each pixel of the one that it asks; 0 where none holds
// it.
absl::StatusOr<std::vector<float>> FootprintImage(const Readback& readback,
                                                  const Light& light,
                                                  absl::Span<const SizedMatrix> maps,
                                                  const SampleOptions& options = {});

// 1 at the pixels whose samples are used for this light, else 0. Row-major.
absl::StatusOr<std::vector<uint8_t>> SampleImage(const Surfaces& surfaces,
                                                 const Light& light,
                                                 const SampleOptions& options);

// World positions of all receivers (pixels with a surface), in pixel order, world units.
absl::StatusOr<std::vector<Eigen::Vector3d>> ReceiverPositions(const Readback& readback);

}  // namespace lightfit
