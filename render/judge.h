// render/judge.h
//
// The shadows that a matrix gives, and where they are wrong.
// In:   a RayCaster, what the camera sees, the true lighting, a light's matrix, its map and border.
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
// What a receiver outside the map finds is the map's border, lit or dark.
// render/judge_plan.h judges several maps of one light; one map is the plan of one.
//
// Counts depend on where single texels fall: the same map a quarter of a texel further on has
// others. So they may be averaged over phases, maps moved by parts of a texel.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/border.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "render/surface_image.h"
#include "render/true_lighting.h"

namespace lightfit {

// A light's matrix and what it draws.
struct JudgedMap {
  Eigen::Matrix4d map_from_world;  // texels of a map of `size`; row 3 does not matter
  MapSize size;
  Border border = Border::kLit;
};

struct JudgeOptions {
  // Constant part of the practical bias, as a share of the receivers' range of distances from the
  // light: a few units of a 16-bit depth buffer. >= 0.
  double constant_share = 2e-4;

  // How many phases counts are averaged over: a square number n n, at most 64. In phase n j + i the
  // map is moved by ((i + 1/2) / n - 1/2, (j + 1/2) / n - 1/2) texels. 1 is the map as it is; 4 are
  // all of (+-1/4, +-1/4).
  int phases = 1;
};

absl::Status ValidateJudgeOptions(const JudgeOptions& options);

// How far maps are moved in a phase, texels; exactly nothing in the only one of 1. For valid
// options.
Eigen::Vector2d MoveOfPhase(const JudgeOptions& options, int phase);

// Means over the phases; counts of pixels are rounded to whole ones.
struct WrongPixels {
  int64_t ideal = 0;
  int64_t practical = 0;
  double practical_weighted = 0.0;  // each by the cosine between normal and light; not rounded
  int64_t outside = 0;  // of `ideal`: outside the map, dark ones at a lit border and the reverse
};

// The two models by name.
enum class Bias { kIdeal, kPractical };
inline int64_t CountOf(const WrongPixels& wrong, Bias bias) {
  return bias == Bias::kIdeal ? wrong.ideal : wrong.practical;
}

struct ShadowImage {
  std::vector<Lighting> ideal,
      practical;      // row-major, as TrueLighting() of the same pixels; phase 0
  WrongPixels wrong;  // of all phases
};

// InvalidArgument for options out of range, and when the matrix is not one of this light, see
// MapFromRay().
absl::StatusOr<ShadowImage> JudgeMatrix(const RayCaster& caster,
                                        const SurfaceImage& image,
                                        absl::Span<const Lighting> truth,
                                        const Light& light,
                                        const JudgedMap& map,
                                        const JudgeOptions& options = {});

// The same of phase 0 alone, in its share of the time: the same images, and counts of that phase.
absl::StatusOr<ShadowImage> JudgeFirstPhase(const RayCaster& caster,
                                            const SurfaceImage& image,
                                            absl::Span<const Lighting> truth,
                                            const Light& light,
                                            const JudgedMap& map,
                                            const JudgeOptions& options = {});

}  // namespace lightfit
