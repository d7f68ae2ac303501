// render/judge_texels.h
//
// The shadows that any maps of one light give, and where they are wrong.
// In:   a RayCaster, what the camera sees, the true lighting, a light and its TexelMaps.
// Out:  the shadow images under the two bias models of render/judge.h, and the wrong pixels.
//
// What judge_plan (matrices) and shipped/judge_rays (paraboloids, pages) share.   math.md 10
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>

#include "absl/functional/function_ref.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/border.h"
#include "geometry/light.h"
#include "render/judge.h"
#include "render/surface_image.h"
#include "render/texel_maps.h"
#include "render/true_lighting.h"

namespace lightfit {

// The most texels that are judged, of all maps together.
inline constexpr int64_t kMaxJudgedTexels = int64_t{1} << 30;

// The maps of a phase, every one of them moved by so many of its own texels: what would be at
// (u, v) is at (u, v) + move.
using MovedMaps = absl::FunctionRef<std::unique_ptr<TexelMaps>(const Eigen::Vector2d& move)>;

// Receivers that ask no texel find the border, and are those that are counted as `outside`.
// InvalidArgument for a truth of another image, options out of range, and too many texels.
absl::StatusOr<ShadowImage> JudgeTexels(const RayCaster& caster,
                                        const SurfaceImage& image,
                                        absl::Span<const Lighting> truth,
                                        const Light& light,
                                        Border border,
                                        MovedMaps maps,
                                        const JudgeOptions& options);

// The same of phase 0 alone, in its share of the time: the same images, and counts of that phase.
absl::StatusOr<ShadowImage> JudgeTexelsFirstPhase(const RayCaster& caster,
                                                  const SurfaceImage& image,
                                                  absl::Span<const Lighting> truth,
                                                  const Light& light,
                                                  Border border,
                                                  MovedMaps maps,
                                                  const JudgeOptions& options);

}  // namespace lightfit
