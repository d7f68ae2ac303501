// partition/plan_uniforms.h
//
// A plan as a shader's block of uniforms.
// In:   a Plan and its light, the guard, where each map lies in an atlas.
// Out:  PlanUniforms, to be copied as it is into the block LightPlan of docs/plans.md.
//
// The layout is that of GLSL's std140, which is std430's and that of an HLSL cbuffer as well. A
// shader's array of maps may be shorter than kMaxPlanMaps: BytesOf() is what there is to upload.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/light.h"
#include "partition/plan.h"

namespace lightfit {

struct PlanMapUniforms {
  float u_row[4] = {};         // byte 0: rows 1, 2 and 4 of map_from_world, for column vectors
  float v_row[4] = {};         // 16
  float w_row[4] = {};         // 32
  float z_row[4] = {};         // 48: row 3
  float size[2] = {};          // 64: texels
  float atlas_offset[2] = {};  // 72: of the map's first texel, texels
  float c = 0.0f;              // 80: |det map_from_ray|^(-1/3), of texels: q = c w, math.md (18)
  float unused[3] = {};
};
static_assert(sizeof(PlanMapUniforms) == 96);

struct PlanUniforms {
  int32_t num_maps = 0;       // byte 0
  float guard_texels = 0.0f;  // 4
  float border_light = 1.0f;  // 8: what a receiver finds that no map holds; 1: light, 0: shadow
  float unused = 0.0f;
  PlanMapUniforms maps[kMaxPlanMaps];  // 16
};
static_assert(offsetof(PlanUniforms, maps) == 16);

// Head and maps, without what follows the last map.
size_t BytesOf(const PlanUniforms& uniforms);

// `atlas_offsets`: one for each map, or none, all 0. Receivers are given relative to `origin`:
// single precision wants it near them. InvalidArgument for what PlanLookUp refuses, for a plan with
// half spaces, of which the block knows nothing, and for values beyond single precision.
absl::StatusOr<PlanUniforms> MakePlanUniforms(
    const Plan& plan,
    const Light& light,
    double guard_texels = 0.0,
    absl::Span<const Eigen::Vector2i> atlas_offsets = {},
    const Eigen::Vector3d& origin = Eigen::Vector3d::Zero());

}  // namespace lightfit
