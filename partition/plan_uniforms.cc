#include "partition/plan_uniforms.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"
#include "geometry/homography.h"

namespace lightfit {

namespace {

void SetRow(const Eigen::RowVector4d& row, float (&uniform)[4]) {
  for (int i = 0; i < 4; ++i) uniform[i] = static_cast<float>(row[i]);
}

bool IsFinite(const PlanMapUniforms& map) {
  const auto is_finite = [](const float(&row)[4]) {
    return std::all_of(row, row + 4, [](float value) { return std::isfinite(value); });
  };
  // A `c` of 0, or one that lost its digits, would not tell which map is denser.
  return is_finite(map.u_row) && is_finite(map.v_row) && is_finite(map.w_row) &&
         is_finite(map.z_row) && std::isnormal(map.c);
}

}  // namespace

size_t BytesOf(const PlanUniforms& uniforms) {
  return offsetof(PlanUniforms, maps) + uniforms.num_maps * sizeof(PlanMapUniforms);
}

absl::StatusOr<PlanUniforms> MakePlanUniforms(const Plan& plan,
                                              const Light& light,
                                              double guard_texels,
                                              absl::Span<const Eigen::Vector2i> atlas_offsets,
                                              const Eigen::Vector3d& origin) {
  const absl::StatusOr<PlanLookUp> look_up = PlanLookUp::Create(plan, light, guard_texels);
  if (!look_up.ok()) return look_up.status();
  const int num_maps = look_up->num_maps();
  if (!atlas_offsets.empty() && atlas_offsets.size() != plan.maps.size()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("light \"%s\": %d atlas_offsets for %d maps, want one for each, or none",
                        light.name,
                        atlas_offsets.size(),
                        num_maps));
  }
  PlanUniforms uniforms;
  uniforms.num_maps = num_maps;
  uniforms.guard_texels = static_cast<float>(guard_texels);
  uniforms.border_light = plan.border == Border::kLit ? 1.0f : 0.0f;
  for (int k = 0; k < num_maps; ++k) {
    const PlanMap& map = plan.maps[k];
    if (!map.half_spaces.empty()) {
      return absl::InvalidArgumentError(
          absl::StrFormat("light \"%s\": map %d has half_spaces, which the block has no room for; "
                          "test them in the shader and clear them here",
                          light.name,
                          k));
    }
    Eigen::Matrix4d map_from_world = map.map_from_world;
    map_from_world.col(3) = map.map_from_world * origin.homogeneous();
    const absl::StatusOr<Eigen::Matrix3d> map_from_ray = MapFromRay(map.map_from_world, light);
    if (!map_from_ray.ok()) return map_from_ray.status();
    PlanMapUniforms& to = uniforms.maps[k];
    SetRow(map_from_world.row(0), to.u_row);
    SetRow(map_from_world.row(1), to.v_row);
    SetRow(map_from_world.row(3), to.w_row);
    SetRow(map_from_world.row(2), to.z_row);
    to.size[0] = static_cast<float>(map.size.width);
    to.size[1] = static_cast<float>(map.size.height);
    if (!atlas_offsets.empty()) {
      to.atlas_offset[0] = static_cast<float>(atlas_offsets[k].x());
      to.atlas_offset[1] = static_cast<float>(atlas_offsets[k].y());
    }
    to.c = static_cast<float>(1.0 / std::cbrt(std::abs(map_from_ray->determinant())));
    if (!IsFinite(to)) {
      return absl::InvalidArgumentError(
          absl::StrFormat("light \"%s\": map_from_world of map %d, or the origin, is beyond single "
                          "precision; any multiple of the matrix will do",
                          light.name,
                          k));
    }
  }
  return uniforms;
}

}  // namespace lightfit
