// render/shipped/judge_rays.h
//
// The shadows that maps give which are no 4x4 matrix, and where they are wrong: a pair of
// paraboloids, and the pages of a virtual shadow map.
// In:   a RayCaster, what the camera sees, the true lighting, a light and its maps.
// Out:  the shadow images under the two bias models of render/judge.h, and the wrong pixels.
//
// A receiver is projected by itself and asks the nearest texel of its half or page; what the texel
// holds is found on the ray through its centre. In each phase the place is moved before it is
// rounded, and the ray's place moved back.   math.md 10
//
// JudgeParaboloids() casts that ray, so that shadows have the map's texels and none of its bends.
// A rasteriser draws a caster straight between its projected corners: JudgeDrawnParaboloids(). A
// texel's hits are then the triangles whose bent images hold its centre, at the distances that they
// have there (paraboloid_raster).
#pragma once

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/light.h"
#include "partition/shipped/clipmap_pages.h"
#include "partition/shipped/paraboloid.h"
#include "render/judge.h"
#include "render/shipped/paraboloid_raster.h"
#include "render/surface_image.h"
#include "render/true_lighting.h"

namespace lightfit {

// InvalidArgument for a truth of another image or options out of range, and for maps that are not
// the light's: another kind of light, another place or direction, no texels or too many. Nobody is
// outside of a pair.
absl::StatusOr<ShadowImage> JudgeParaboloids(const RayCaster& caster,
                                             const SurfaceImage& image,
                                             absl::Span<const Lighting> truth,
                                             const Light& light,
                                             const ParaboloidPair& pair,
                                             const JudgeOptions& options = {});

absl::StatusOr<ShadowImage> JudgeDrawnParaboloids(const RayCaster& caster,
                                                  const SurfaceImage& image,
                                                  absl::Span<const Lighting> truth,
                                                  const Light& light,
                                                  const ParaboloidPair& pair,
                                                  const JudgeOptions& options = {},
                                                  const ParaboloidRasterOptions& raster = {});

// A receiver that no page holds is lit, and counted as `outside` where it should not be.
absl::StatusOr<ShadowImage> JudgePages(const RayCaster& caster,
                                       const SurfaceImage& image,
                                       absl::Span<const Lighting> truth,
                                       const Light& light,
                                       const PagedMap& pages,
                                       const JudgeOptions& options = {});

}  // namespace lightfit
