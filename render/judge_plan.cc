#include "render/judge_plan.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "geometry/homography.h"
#include "render/judge_texels.h"
#include "render/shadow_map.h"
#include "render/texel_maps.h"

namespace lightfit {

namespace {

// Where a receiver looks up, texels; NaN behind the light's projection.
Eigen::Vector2d LookUp(const Eigen::Matrix4d& map_from_world, const Eigen::Vector3d& position) {
  const Eigen::Vector4d map = map_from_world * position.homogeneous();
  if (!(map.w() > 0.0)) return Eigen::Vector2d::Constant(std::nan(""));
  return map.head<2>() / map.w();
}

// The texel there, row-major, or kNoTexel.
int32_t TexelAt(const Eigen::Vector2d& uv, MapSize size, double guard_texels) {
  const bool is_inside = uv.x() >= guard_texels && uv.x() < size.width - guard_texels &&
                         uv.y() >= guard_texels &&
                         uv.y() < size.height - guard_texels;  // false for NaN
  if (!is_inside) return kNoTexel;
  return static_cast<int32_t>(uv.y()) * size.width + static_cast<int32_t>(uv.x());
}

absl::Status ValidateSizes(const Plan& plan, const Light& light) {
  int64_t sum = 0;
  for (const PlanMap& map : plan.maps) {
    const MapSize size = map.size;
    if (size.width < 1 || size.height < 1 || int64_t{size.width} * size.height > kMaxJudgedTexels) {
      return absl::InvalidArgumentError(
          absl::StrFormat("light \"%s\": map size = %dx%d, want at least 1x1 and at most %d texels",
                          light.name,
                          size.width,
                          size.height,
                          kMaxJudgedTexels));
    }
    sum += int64_t{size.width} * size.height;
    if (sum > kMaxJudgedTexels) {
      return absl::InvalidArgumentError(
          absl::StrFormat("light \"%s\": the plan's %d maps have more than %d texels in all",
                          light.name,
                          plan.maps.size(),
                          kMaxJudgedTexels));
    }
  }
  return absl::OkStatus();
}

// The maps of a plan, one after the other, each row-major.
class PlanMaps : public TexelMaps {
 public:
  PlanMaps(const RayCaster& caster,
           const Light& light,
           const Plan& plan,
           const PlanLookUp& look_up,
           const std::vector<Eigen::Matrix3d>& map_from_ray,
           const Eigen::Vector2d& move,
           double guard_texels)
      : plan_(plan), look_up_(look_up), move_(move), guard_texels_(guard_texels) {
    for (int k = 0; k < look_up.num_maps(); ++k) {
      Eigen::Matrix3d moved_from_ray = map_from_ray[k];
      moved_from_ray.topRows<2>() += move * map_from_ray[k].row(2);
      rays_.emplace_back(light, moved_from_ray, caster.bounds());
      begin_.push_back(num_texels_);
      num_texels_ += plan.maps[k].size.width * plan.maps[k].size.height;
    }
  }

  int64_t num_texels() const override { return num_texels_; }

  // PlanLookUp::At() in the moved maps; (u, v) by each map's own matrix, as a renderer has them.
  int32_t TexelOf(const Eigen::Vector3d& world) const override {
    int32_t asked = kNoTexel;
    double least = 0.0;
    for (int k = 0; k < look_up_.num_maps(); ++k) {
      const PlanMap& map = plan_.maps[k];
      const int32_t texel =
          TexelAt(LookUp(map.map_from_world, world) + move_, map.size, guard_texels_);
      if (texel == kNoTexel || !look_up_.IsServed(k, world)) continue;
      const double coarseness = look_up_.CoarsenessOf(k, world);
      if (asked != kNoTexel && !(coarseness < least)) continue;
      least = coarseness;
      asked = begin_[k] + texel;
    }
    return asked;
  }

  std::optional<Ray> RayOf(int32_t texel) const override {
    const auto map = std::upper_bound(begin_.begin(), begin_.end(), texel) - begin_.begin() - 1;
    const int32_t in_map = texel - begin_[map], width = plan_.maps[map].size.width;
    const int32_t row = in_map / width;
    return rays_[map].At(in_map % width + 0.5, row + 0.5);
  }

 private:
  const Plan& plan_;
  const PlanLookUp& look_up_;
  Eigen::Vector2d move_;
  double guard_texels_;
  std::vector<MapRays> rays_;
  std::vector<int32_t> begin_;  // the number of each map's first texel
  int32_t num_texels_ = 0;
};

// `judge` is one of the two of judge_texels.
template <typename Judge>
absl::StatusOr<ShadowImage> JudgeBy(const Judge& judge,
                                    const RayCaster& caster,
                                    const SurfaceImage& image,
                                    absl::Span<const Lighting> truth,
                                    const Light& light,
                                    const Plan& plan,
                                    const JudgeOptions& options,
                                    double guard_texels) {
  if (absl::Status status = ValidateSizes(plan, light); !status.ok()) return status;
  const absl::StatusOr<PlanLookUp> look_up = PlanLookUp::Create(plan, light, guard_texels);
  if (!look_up.ok()) return look_up.status();
  std::vector<Eigen::Matrix3d> map_from_ray;
  for (const PlanMap& map : plan.maps) {
    map_from_ray.push_back(*MapFromRay(map.map_from_world, light));  // as PlanLookUp found it
  }
  const auto maps = [&](const Eigen::Vector2d& move) -> std::unique_ptr<TexelMaps> {
    return std::make_unique<PlanMaps>(
        caster, light, plan, *look_up, map_from_ray, move, guard_texels);
  };
  return judge(caster, image, truth, light, plan.border, maps, options);
}

}  // namespace

absl::StatusOr<ShadowImage> JudgePlan(const RayCaster& caster,
                                      const SurfaceImage& image,
                                      absl::Span<const Lighting> truth,
                                      const Light& light,
                                      const Plan& plan,
                                      const JudgeOptions& options,
                                      double guard_texels) {
  return JudgeBy(JudgeTexels, caster, image, truth, light, plan, options, guard_texels);
}

absl::StatusOr<ShadowImage> JudgePlanFirstPhase(const RayCaster& caster,
                                                const SurfaceImage& image,
                                                absl::Span<const Lighting> truth,
                                                const Light& light,
                                                const Plan& plan,
                                                const JudgeOptions& options,
                                                double guard_texels) {
  return JudgeBy(JudgeTexelsFirstPhase, caster, image, truth, light, plan, options, guard_texels);
}

}  // namespace lightfit
