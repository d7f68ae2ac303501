#include "render/judge_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "geometry/homography.h"
#include "render/shadow_map.h"
#include "render/texel_judge.h"

namespace lightfit {

namespace {

constexpr int32_t kOutside = -1;

// What a receiver asks: a map, kOutside for none, and a texel of it.
struct Asked {
  int32_t map = kOutside;
  int32_t texel = 0;
};

// Where a receiver looks up, texels; NaN behind the light's projection.
Eigen::Vector2d LookUp(const Eigen::Matrix4d& map_from_world, const Eigen::Vector3d& position) {
  const Eigen::Vector4d map = map_from_world * position.homogeneous();
  if (!(map.w() > 0.0)) return Eigen::Vector2d::Constant(std::nan(""));
  return map.head<2>() / map.w();
}

// The texel there, or kOutside.
int32_t TexelAt(const Eigen::Vector2d& uv, MapSize size) {
  const bool is_inside = uv.x() >= 0.0 && uv.x() < size.width && uv.y() >= 0.0 &&
                         uv.y() < size.height;  // false for NaN
  if (!is_inside) return kOutside;
  return static_cast<int32_t>(uv.y()) * size.width + static_cast<int32_t>(uv.x());
}

// Distances of the receivers along the rays of the light.
double DistanceRange(const SurfaceImage& image,
                     absl::Span<const Lighting> truth,
                     const Light& light) {
  double near = std::numeric_limits<double>::infinity(), far = -near;
  const Eigen::Vector3d direction = light.direction.stableNormalized();
  for (size_t i = 0; i < truth.size(); ++i) {
    if (!IsJudged(truth[i])) continue;
    const Eigen::Vector3d& position = image.pixels[i].position;
    const double distance = light.kind == Light::Kind::kPoint ? (position - light.position).norm()
                                                              : direction.dot(position);
    near = std::min(near, distance);
    far = std::max(far, distance);
  }
  return std::max(far - near, 0.0);
}

absl::Status Validate(const SurfaceImage& image,
                      absl::Span<const Lighting> truth,
                      const Light& light,
                      const Plan& plan,
                      const JudgeOptions& options) {
  constexpr int64_t kMaxTexels = int64_t{1} << 30;
  if (absl::Status status = ValidateLighting(truth, image, light); !status.ok()) return status;
  int64_t sum = 0;
  for (const PlanMap& map : plan.maps) {
    const MapSize size = map.size;
    if (size.width < 1 || size.height < 1 || int64_t{size.width} * size.height > kMaxTexels) {
      return absl::InvalidArgumentError(
          absl::StrFormat("light \"%s\": map size = %dx%d, want at least 1x1 and at most %d texels",
                          light.name,
                          size.width,
                          size.height,
                          kMaxTexels));
    }
    sum += int64_t{size.width} * size.height;
    if (sum > kMaxTexels) {
      return absl::InvalidArgumentError(
          absl::StrFormat("light \"%s\": the plan's %d maps have more than %d texels in all",
                          light.name,
                          plan.maps.size(),
                          kMaxTexels));
    }
  }
  return ValidateJudgeOptions(options);
}

// Everything about a plan that its phases have in common.
class PlanJudge {
 public:
  static absl::StatusOr<PlanJudge> Create(const RayCaster& caster,
                                          const SurfaceImage& image,
                                          absl::Span<const Lighting> truth,
                                          const Light& light,
                                          const Plan& plan,
                                          const JudgeOptions& options) {
    if (absl::Status status = Validate(image, truth, light, plan, options); !status.ok()) {
      return status;
    }
    absl::StatusOr<PlanLookUp> look_up = PlanLookUp::Create(plan, light);
    if (!look_up.ok()) return look_up.status();
    std::vector<Eigen::Matrix3d> map_from_ray;
    for (const PlanMap& map : plan.maps) {
      map_from_ray.push_back(*MapFromRay(map.map_from_world, light));  // as PlanLookUp found it
    }
    return PlanJudge(
        caster, image, truth, light, plan, *std::move(look_up), std::move(map_from_ray), options);
  }

  ShadowImage Judged(int phase) const {
    const Eigen::Vector2d move = MoveOfPhase(options_, phase);
    std::vector<Asked> asked(pixels_.size());
    ForPixels([&](int i) { asked[i] = AskedBy(Receiver(i), move); });

    ShadowImage result;
    result.ideal.assign(truth_.begin(), truth_.end());
    result.practical = result.ideal;
    const bool is_dark_outside = plan_.border == Border::kDark;
    ForPixels([&](int i) {
      if (asked[i].map == kOutside) SetDark(i, {is_dark_outside, is_dark_outside}, &result);
    });
    for (int k = 0; k < look_up_.num_maps(); ++k) JudgeMap(k, move, asked, &result);
    result.wrong = Counted(result, asked);
    return result;
  }

 private:
  PlanJudge(const RayCaster& caster,
            const SurfaceImage& image,
            absl::Span<const Lighting> truth,
            const Light& light,
            const Plan& plan,
            PlanLookUp look_up,
            std::vector<Eigen::Matrix3d> map_from_ray,
            const JudgeOptions& options)
      : caster_(caster),
        image_(image),
        truth_(truth),
        light_(light),
        plan_(plan),
        look_up_(std::move(look_up)),
        map_from_ray_(std::move(map_from_ray)),
        options_(options),
        constant_bias_(options.constant_share * DistanceRange(image, truth, light)) {
    for (size_t i = 0; i < truth.size(); ++i) {
      if (IsJudged(truth[i])) pixels_.push_back(static_cast<int32_t>(i));
    }
  }

  // PlanLookUp::At() in the moved maps; (u, v) by each map's own matrix, as a renderer has them.
  Asked AskedBy(const SurfacePoint& receiver, const Eigen::Vector2d& move) const {
    Asked asked;
    double least = 0.0;
    for (int k = 0; k < look_up_.num_maps(); ++k) {
      const PlanMap& map = plan_.maps[k];
      const int32_t texel = TexelAt(LookUp(map.map_from_world, receiver.position) + move, map.size);
      if (texel == kOutside || !look_up_.IsServed(k, receiver.position)) continue;
      const double coarseness = look_up_.CoarsenessOf(k, receiver.position);
      if (asked.map != kOutside && !(coarseness < least)) continue;
      least = coarseness;
      asked = {k, texel};
    }
    return asked;
  }

  // What the k-th map says to all who ask it.
  void JudgeMap(int k,
                const Eigen::Vector2d& move,
                const std::vector<Asked>& asked,
                ShadowImage* result) const {
    const MapSize size = plan_.maps[k].size;
    std::vector<uint8_t> wanted(static_cast<size_t>(size.width) * size.height, 0);
    for (const Asked& one : asked) {
      if (one.map == k) wanted[one.texel] = 1;
    }
    Eigen::Matrix3d map_from_ray = map_from_ray_[k];
    map_from_ray.topRows<2>() += move * map_from_ray_[k].row(2);
    const ShadowMap shadow_map = RenderShadowMap(caster_, light_, map_from_ray, size, wanted);
    const MapRays rays(light_, map_from_ray, caster_.bounds());
    const TexelJudge judge(caster_, rays, shadow_map, constant_bias_);
    ForPixels([&](int i) {
      if (asked[i].map == k) SetDark(i, judge.IsDark(Receiver(i), asked[i].texel), result);
    });
  }

  // {ideal, practical} of the i-th judged pixel.
  void SetDark(int i, std::pair<bool, bool> dark, ShadowImage* result) const {
    result->ideal[pixels_[i]] = dark.first ? Lighting::kShadowed : Lighting::kLit;
    result->practical[pixels_[i]] = dark.second ? Lighting::kShadowed : Lighting::kLit;
  }

  WrongPixels Counted(const ShadowImage& shadows, const std::vector<Asked>& asked) const {
    WrongPixels wrong;
    for (size_t i = 0; i < pixels_.size(); ++i) {
      const int32_t pixel = pixels_[i];
      if (shadows.ideal[pixel] != truth_[pixel]) {
        ++wrong.ideal;
        if (asked[i].map == kOutside) ++wrong.outside;
      }
      if (shadows.practical[pixel] != truth_[pixel]) {
        ++wrong.practical;
        wrong.practical_weighted += CosineOf(image_.pixels[pixel]);
      }
    }
    return wrong;
  }

  // Between the receiver's normal and the way to the light.
  double CosineOf(const SurfacePoint& receiver) const {
    const Eigen::Vector3d to_light = light_.kind == Light::Kind::kPoint
                                         ? Eigen::Vector3d(light_.position - receiver.position)
                                         : Eigen::Vector3d(-light_.direction);
    return receiver.normal.dot(to_light.stableNormalized());
  }

  const SurfacePoint& Receiver(int i) const { return image_.pixels[pixels_[i]]; }

  // run(i) for every judged pixel, from all threads.
  template <typename Run>
  void ForPixels(const Run& run) const {
    ParallelFor(
        static_cast<int>(pixels_.size()), 4096, caster_.num_threads(), [&](int begin, int end) {
          for (int i = begin; i < end; ++i) run(i);
        });
  }

  const RayCaster& caster_;
  const SurfaceImage& image_;
  absl::Span<const Lighting> truth_;
  const Light& light_;
  const Plan& plan_;
  PlanLookUp look_up_;                         // refers to the plan
  std::vector<Eigen::Matrix3d> map_from_ray_;  // of each map, not moved
  JudgeOptions options_;
  double constant_bias_;
  std::vector<int32_t> pixels_;  // that are judged: indices in the image
};

// The mean of a count over phases, rounded.
int64_t WholeMean(int64_t sum, int num_phases) {
  return std::llround(static_cast<double>(sum) / num_phases);
}

}  // namespace

absl::StatusOr<ShadowImage> JudgePlan(const RayCaster& caster,
                                      const SurfaceImage& image,
                                      absl::Span<const Lighting> truth,
                                      const Light& light,
                                      const Plan& plan,
                                      const JudgeOptions& options) {
  const absl::StatusOr<PlanJudge> judge =
      PlanJudge::Create(caster, image, truth, light, plan, options);
  if (!judge.ok()) return judge.status();
  ShadowImage first = judge->Judged(0);
  WrongPixels sum = first.wrong;
  for (int phase = 1; phase < options.phases; ++phase) {
    const WrongPixels wrong = judge->Judged(phase).wrong;
    sum.ideal += wrong.ideal;
    sum.practical += wrong.practical;
    sum.practical_weighted += wrong.practical_weighted;
    sum.outside += wrong.outside;
  }
  first.wrong.ideal = WholeMean(sum.ideal, options.phases);
  first.wrong.practical = WholeMean(sum.practical, options.phases);
  first.wrong.practical_weighted = sum.practical_weighted / options.phases;
  first.wrong.outside = WholeMean(sum.outside, options.phases);
  return first;
}

absl::StatusOr<ShadowImage> JudgePlanFirstPhase(const RayCaster& caster,
                                                const SurfaceImage& image,
                                                absl::Span<const Lighting> truth,
                                                const Light& light,
                                                const Plan& plan,
                                                const JudgeOptions& options) {
  const absl::StatusOr<PlanJudge> judge =
      PlanJudge::Create(caster, image, truth, light, plan, options);
  if (!judge.ok()) return judge.status();
  return judge->Judged(0);
}

}  // namespace lightfit
