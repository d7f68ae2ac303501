#include "render/judge_texels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "render/texel_judge.h"

namespace lightfit {

namespace {

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

// Everything about the pixels that the phases have in common.
class Judge {
 public:
  Judge(const RayCaster& caster,
        const SurfaceImage& image,
        absl::Span<const Lighting> truth,
        const Light& light,
        Border border,
        const JudgeOptions& options)
      : caster_(caster),
        image_(image),
        truth_(truth),
        light_(light),
        border_(border),
        constant_bias_(options.constant_share * DistanceRange(image, truth, light)) {
    for (size_t i = 0; i < truth.size(); ++i) {
      if (IsJudged(truth[i])) pixels_.push_back(static_cast<int32_t>(i));
    }
  }

  // By the maps of a phase.
  absl::StatusOr<ShadowImage> Judged(const TexelMaps& maps) const {
    if (maps.num_texels() > kMaxJudgedTexels) {
      return absl::InvalidArgumentError(
          absl::StrFormat("light \"%s\": maps of %d texels in all, want at most %d",
                          light_.name,
                          maps.num_texels(),
                          kMaxJudgedTexels));
    }
    std::vector<int32_t> asked(pixels_.size());
    ForPixels([&](int i) { asked[i] = maps.TexelOf(Receiver(i).position); });
    std::vector<uint8_t> wanted(static_cast<size_t>(maps.num_texels()), 0);
    for (const int32_t texel : asked) {
      if (texel != kNoTexel) wanted[texel] = 1;
    }
    const std::unique_ptr<TexelHits> hits = maps.Draw(caster_, wanted);
    const TexelJudge judge(caster_, maps, *hits, constant_bias_);

    ShadowImage result;
    result.ideal.assign(truth_.begin(), truth_.end());
    result.practical = result.ideal;
    const bool is_dark_outside = border_ == Border::kDark;
    ForPixels([&](int i) {
      SetDark(i,
              asked[i] == kNoTexel ? std::pair(is_dark_outside, is_dark_outside)
                                   : judge.IsDark(Receiver(i), asked[i]),
              &result);
    });
    result.wrong = Counted(result, asked);
    return result;
  }

 private:
  // {ideal, practical} of the i-th judged pixel.
  void SetDark(int i, std::pair<bool, bool> dark, ShadowImage* result) const {
    result->ideal[pixels_[i]] = dark.first ? Lighting::kShadowed : Lighting::kLit;
    result->practical[pixels_[i]] = dark.second ? Lighting::kShadowed : Lighting::kLit;
  }

  WrongPixels Counted(const ShadowImage& shadows, const std::vector<int32_t>& asked) const {
    WrongPixels wrong;
    for (size_t i = 0; i < pixels_.size(); ++i) {
      const int32_t pixel = pixels_[i];
      if (shadows.ideal[pixel] != truth_[pixel]) {
        ++wrong.ideal;
        if (asked[i] == kNoTexel) ++wrong.outside;
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
  Border border_;
  double constant_bias_;
  std::vector<int32_t> pixels_;  // that are judged: indices in the image
};

// The mean of a count over phases, rounded.
int64_t WholeMean(int64_t sum, int num_phases) {
  return std::llround(static_cast<double>(sum) / num_phases);
}

// The image of phase 0, and the counts of the first `num_phases`, which is all or 1.
absl::StatusOr<ShadowImage> JudgePhases(const RayCaster& caster,
                                        const SurfaceImage& image,
                                        absl::Span<const Lighting> truth,
                                        const Light& light,
                                        Border border,
                                        MovedMaps maps,
                                        const JudgeOptions& options,
                                        int num_phases) {
  const Judge judge(caster, image, truth, light, border, options);
  absl::StatusOr<ShadowImage> first = judge.Judged(*maps(MoveOfPhase(options, 0)));
  if (!first.ok()) return first.status();
  WrongPixels sum = first->wrong;
  for (int phase = 1; phase < num_phases; ++phase) {
    const absl::StatusOr<ShadowImage> judged = judge.Judged(*maps(MoveOfPhase(options, phase)));
    if (!judged.ok()) return judged.status();
    sum.ideal += judged->wrong.ideal;
    sum.practical += judged->wrong.practical;
    sum.practical_weighted += judged->wrong.practical_weighted;
    sum.outside += judged->wrong.outside;
  }
  first->wrong.ideal = WholeMean(sum.ideal, num_phases);
  first->wrong.practical = WholeMean(sum.practical, num_phases);
  first->wrong.practical_weighted = sum.practical_weighted / num_phases;
  first->wrong.outside = WholeMean(sum.outside, num_phases);
  return first;
}

absl::Status Validate(absl::Span<const Lighting> truth,
                      const SurfaceImage& image,
                      const Light& light,
                      const JudgeOptions& options) {
  if (absl::Status status = ValidateLighting(truth, image, light); !status.ok()) return status;
  return ValidateJudgeOptions(options);
}

}  // namespace

absl::StatusOr<ShadowImage> JudgeTexels(const RayCaster& caster,
                                        const SurfaceImage& image,
                                        absl::Span<const Lighting> truth,
                                        const Light& light,
                                        Border border,
                                        MovedMaps maps,
                                        const JudgeOptions& options) {
  if (absl::Status status = Validate(truth, image, light, options); !status.ok()) return status;
  return JudgePhases(caster, image, truth, light, border, maps, options, options.phases);
}

absl::StatusOr<ShadowImage> JudgeTexelsFirstPhase(const RayCaster& caster,
                                                  const SurfaceImage& image,
                                                  absl::Span<const Lighting> truth,
                                                  const Light& light,
                                                  Border border,
                                                  MovedMaps maps,
                                                  const JudgeOptions& options) {
  if (absl::Status status = Validate(truth, image, light, options); !status.ok()) return status;
  return JudgePhases(caster, image, truth, light, border, maps, options, 1);
}

}  // namespace lightfit
