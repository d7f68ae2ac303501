// render/judge.h
//
// The shadows that a matrix gives, and where they are wrong.
// In:   a RayCaster, what the camera sees, the true lighting, a light's matrix and map size.
// Out:  the shadow images under two bias models, nearest texel, and the wrong pixels.
//
// A pixel is judged when its surface faces the light; it is wrong when the map says other than the
// truth. Both models know the receiver's plane: its depth on the ray of the texel's centre is what
// the texel's depth is compared with.   math.md 10
//  - ideal bias: sampling error alone. Of all hits on the texel's ray the one nearest in depth to
//    the receiver's plane counts, and it is dark unless it is the first.
//  - practical bias: the first hit counts, as in a renderer, and is dark in front of the receiver's
//    plane by more than a constant. Adds false shadow in valleys, where the surface beyond the
//    edge rises over the receiver's plane.
// Receivers outside the map are lit.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "render/surface_image.h"
#include "render/true_lighting.h"

namespace lightfit {

struct BiasOptions {
  // Constant part of the practical bias, as a share of the receivers' range of distances from the
  // light: a few units of a 16-bit depth buffer. >= 0.
  double constant_share = 2e-4;
};

struct WrongPixels {
  int64_t ideal = 0;
  int64_t practical = 0;
  double practical_weighted = 0.0;  // each by the cosine between normal and light
  int64_t outside = 0;              // of `ideal`: dark receivers outside the map
};

struct ShadowImage {
  std::vector<Lighting> ideal, practical;  // row-major, as TrueLighting() of the same pixels
  WrongPixels wrong;
};

// `map_from_world` in texels of a map of `size`, row 3 does not matter. InvalidArgument when it is
// not a matrix of this light, see MapFromRay().
absl::StatusOr<ShadowImage> JudgeMatrix(const RayCaster& caster,
                                        const SurfaceImage& image,
                                        absl::Span<const Lighting> truth,
                                        const Light& light,
                                        const Eigen::Matrix4d& map_from_world,
                                        MapSize size,
                                        const BiasOptions& bias = {});

}  // namespace lightfit
