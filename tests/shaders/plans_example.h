// tests/shaders/plans_example.h
//
// The example in C++ of docs/plans.md, letter by letter, and a test scene for it.
// In:   a read-back, a light, an engine's atlas: Place(), Draw(), Upload().
// Out:  the plan's maps drawn into the atlas, and its uniforms uploaded.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "geometry/clip.h"
#include "optimizer/fit.h"
#include "optimizer/readback/surfaces.h"
#include "partition/fit_plan.h"
#include "partition/plan_uniforms.h"

namespace lightfit::testing {

template <typename Atlas>
absl::Status DrawPlan(const Readback& readback, const Light& light, Atlas& atlas) {
  // docs/plans.md (
  lightfit::PlanOptions options;
  options.max_maps = 4;
  options.texels = 1024 * 1024;  // of all maps together
  options.guard_texels = 1.5;    // 3x3 taps that blend 2x2 texels each: see below
  options.fit.border = lightfit::BorderChoice::kAutomatic;

  const auto surfaces =
      lightfit::FindSurfaces(readback, lightfit::LightMask({light}), options.fit.samples);
  if (!surfaces.ok()) return surfaces.status();
  const auto fitted = lightfit::FitPlan(*surfaces, light, options);
  if (!fitted.ok()) return fitted.status();

  const lightfit::Plan plan = lightfit::PlanOf(*fitted);
  const std::vector<Eigen::Vector2i> offsets = atlas.Place(plan);
  for (size_t k = 0; k < plan.maps.size(); ++k) {
    const lightfit::MapSize size = plan.maps[k].size;
    const Eigen::Matrix4d clip_from_map =
        lightfit::ClipFromMap(size, lightfit::ClipConvention::OpenGl());
    atlas.Draw(offsets[k], size, clip_from_map * plan.maps[k].map_from_world);
  }
  const auto uniforms = lightfit::MakePlanUniforms(plan, light, options.guard_texels, offsets);
  if (!uniforms.ok()) return uniforms.status();
  atlas.Upload(&*uniforms, lightfit::BytesOf(*uniforms));
  // )
  return absl::OkStatus();
}

// What the example sets.
inline constexpr double kExampleGuardTexels = 1.5;

}  // namespace lightfit::testing
