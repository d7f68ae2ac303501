#include "render/judge.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_format.h"
#include "geometry/homography.h"
#include "render/shadow_map.h"
#include "render/texel_judge.h"

namespace lightfit {

namespace {

constexpr int32_t kOutside = -1;

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

bool IsJudged(Lighting truth) { return truth == Lighting::kLit || truth == Lighting::kShadowed; }

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

// n of n n phases.
int SideOf(int num_phases) { return static_cast<int>(std::lround(std::sqrt(num_phases))); }

absl::Status Validate(const SurfaceImage& image,
                      absl::Span<const Lighting> truth,
                      const Light& light,
                      MapSize size,
                      const JudgeOptions& options) {
  constexpr int64_t kMaxTexels = int64_t{1} << 30;
  if (truth.size() != image.pixels.size()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("light \"%s\": truth has %d pixels, the image %d: want those of the image",
                        light.name,
                        truth.size(),
                        image.pixels.size()));
  }
  if (size.width < 1 || size.height < 1 || int64_t{size.width} * size.height > kMaxTexels) {
    return absl::InvalidArgumentError(
        absl::StrFormat("light \"%s\": map size = %dx%d, want at least 1x1 and at most %d texels",
                        light.name,
                        size.width,
                        size.height,
                        kMaxTexels));
  }
  return ValidateJudgeOptions(options);
}

// Everything about a map that its phases have in common.
class MapJudge {
 public:
  static absl::StatusOr<MapJudge> Create(const RayCaster& caster,
                                         const SurfaceImage& image,
                                         absl::Span<const Lighting> truth,
                                         const Light& light,
                                         const JudgedMap& map,
                                         const JudgeOptions& options) {
    const absl::StatusOr<Eigen::Matrix3d> map_from_ray = MapFromRay(map.map_from_world, light);
    if (!map_from_ray.ok()) return map_from_ray.status();
    if (absl::Status status = Validate(image, truth, light, map.size, options); !status.ok()) {
      return status;
    }
    return MapJudge(caster, image, truth, light, map, *map_from_ray, options);
  }

  ShadowImage Judged(int phase) const {
    const Eigen::Vector2d move = MoveOf(phase);
    const std::vector<int32_t> texels = Texels(move);
    const MapSize size = map_.size;
    std::vector<uint8_t> wanted(static_cast<size_t>(size.width) * size.height, 0);
    for (const int32_t texel : texels) {
      if (texel != kOutside) wanted[texel] = 1;
    }
    Eigen::Matrix3d map_from_ray = map_from_ray_;
    map_from_ray.topRows<2>() += move * map_from_ray_.row(2);
    const ShadowMap shadow_map = RenderShadowMap(caster_, light_, map_from_ray, size, wanted);
    const MapRays rays(light_, map_from_ray, caster_.bounds());
    const TexelJudge judge(caster_, rays, shadow_map, constant_bias_);

    ShadowImage result;
    result.ideal.assign(truth_.begin(), truth_.end());
    result.practical = result.ideal;
    const bool is_dark_outside = map_.border == Border::kDark;
    ForPixels([&](int k) {
      std::pair<bool, bool> dark = {is_dark_outside, is_dark_outside};
      if (texels[k] != kOutside) dark = judge.IsDark(Receiver(k), texels[k]);
      result.ideal[pixels_[k]] = dark.first ? Lighting::kShadowed : Lighting::kLit;
      result.practical[pixels_[k]] = dark.second ? Lighting::kShadowed : Lighting::kLit;
    });
    result.wrong = Counted(result, texels);
    return result;
  }

 private:
  MapJudge(const RayCaster& caster,
           const SurfaceImage& image,
           absl::Span<const Lighting> truth,
           const Light& light,
           const JudgedMap& map,
           const Eigen::Matrix3d& map_from_ray,
           const JudgeOptions& options)
      : caster_(caster),
        image_(image),
        truth_(truth),
        light_(light),
        map_(map),
        map_from_ray_(map_from_ray),
        num_phases_(options.phases),
        constant_bias_(options.constant_share * DistanceRange(image, truth, light)) {
    for (size_t i = 0; i < truth.size(); ++i) {
      if (IsJudged(truth[i])) pixels_.push_back(static_cast<int32_t>(i));
    }
    look_ups_.resize(pixels_.size());
    ForPixels([&](int k) { look_ups_[k] = LookUp(map.map_from_world, Receiver(k).position); });
  }

  // How far the map is moved in this phase, texels. Exactly nothing in the only one of 1.
  Eigen::Vector2d MoveOf(int phase) const {
    const int n = SideOf(num_phases_);
    return Eigen::Vector2d((phase % n + 0.5) / n - 0.5, (phase / n + 0.5) / n - 0.5);
  }

  // Of every judged pixel.
  std::vector<int32_t> Texels(const Eigen::Vector2d& move) const {
    std::vector<int32_t> texels(pixels_.size());
    for (size_t k = 0; k < texels.size(); ++k) {
      texels[k] = TexelAt(look_ups_[k] + move, map_.size);
    }
    return texels;
  }

  WrongPixels Counted(const ShadowImage& shadows, const std::vector<int32_t>& texels) const {
    WrongPixels wrong;
    for (size_t k = 0; k < pixels_.size(); ++k) {
      const int32_t pixel = pixels_[k];
      if (shadows.ideal[pixel] != truth_[pixel]) {
        ++wrong.ideal;
        if (texels[k] == kOutside) ++wrong.outside;
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

  const SurfacePoint& Receiver(int k) const { return image_.pixels[pixels_[k]]; }

  // run(k) for every judged pixel, from all threads.
  template <typename Run>
  void ForPixels(const Run& run) const {
    ParallelFor(
        static_cast<int>(pixels_.size()), 4096, caster_.num_threads(), [&](int begin, int end) {
          for (int k = begin; k < end; ++k) run(k);
        });
  }

  const RayCaster& caster_;
  const SurfaceImage& image_;
  absl::Span<const Lighting> truth_;
  const Light& light_;
  const JudgedMap& map_;
  Eigen::Matrix3d map_from_ray_;
  int num_phases_;
  double constant_bias_;
  std::vector<int32_t> pixels_;            // that are judged: indices in the image
  std::vector<Eigen::Vector2d> look_ups_;  // of these, where they look up: texels, not moved
};

// The mean of a count over phases, rounded.
int64_t WholeMean(int64_t sum, int num_phases) {
  return std::llround(static_cast<double>(sum) / num_phases);
}

}  // namespace

absl::Status ValidateJudgeOptions(const JudgeOptions& options) {
  constexpr int kMaxPhases = 64;
  if (!(options.constant_share >= 0.0) || !std::isfinite(options.constant_share)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "judge.constant_share = %g, want 0 or more: a share of the range of distances",
        options.constant_share));
  }
  const bool is_in_range = options.phases >= 1 && options.phases <= kMaxPhases;
  if (is_in_range && SideOf(options.phases) * SideOf(options.phases) == options.phases) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(
      absl::StrFormat("judge.phases = %d, want a square number such as 1, 4 or 9, at most %d",
                      options.phases,
                      kMaxPhases));
}

absl::StatusOr<ShadowImage> JudgeMatrix(const RayCaster& caster,
                                        const SurfaceImage& image,
                                        absl::Span<const Lighting> truth,
                                        const Light& light,
                                        const JudgedMap& map,
                                        const JudgeOptions& options) {
  const absl::StatusOr<MapJudge> judge =
      MapJudge::Create(caster, image, truth, light, map, options);
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

absl::StatusOr<ShadowImage> JudgeFirstPhase(const RayCaster& caster,
                                            const SurfaceImage& image,
                                            absl::Span<const Lighting> truth,
                                            const Light& light,
                                            const JudgedMap& map,
                                            const JudgeOptions& options) {
  const absl::StatusOr<MapJudge> judge =
      MapJudge::Create(caster, image, truth, light, map, options);
  if (!judge.ok()) return judge.status();
  return judge->Judged(0);
}

}  // namespace lightfit
