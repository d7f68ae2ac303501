#include "render/judge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "absl/strings/str_format.h"
#include "geometry/homography.h"
#include "render/shadow_map.h"

namespace lightfit {

namespace {

constexpr int32_t kOutside = -1;

// The texel that a receiver looks up, or kOutside.
int32_t TexelOf(const Eigen::Matrix4d& map_from_world,
                MapSize size,
                const Eigen::Vector3d& position) {
  const Eigen::Vector4d map = map_from_world * position.homogeneous();
  if (!(map.w() > 0.0)) return kOutside;
  const double u = map.x() / map.w(), v = map.y() / map.w();
  if (!(u >= 0.0 && u < size.width && v >= 0.0 && v < size.height)) return kOutside;
  return static_cast<int32_t>(v) * size.width + static_cast<int32_t>(u);
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

// Where the receiver's plane meets the ray of the texel's centre, maybe in front of its start (a
// sun's rays start at the geometry, planes go on beyond it); the receiver itself where the plane
// runs along the ray.
double ReceiverDistance(const Ray& ray, const SurfacePoint& receiver) {
  constexpr double kLeastSlope = 1e-4;
  const Eigen::Vector3d to_receiver = receiver.position - ray.origin;
  const double slope = receiver.normal.dot(ray.direction);
  if (slope < -kLeastSlope) return receiver.normal.dot(to_receiver) / slope;
  return ray.direction.dot(to_receiver);
}

class Judge {
 public:
  Judge(const RayCaster& caster, const MapRays& rays, const ShadowMap& map, double constant_bias)
      : caster_(caster), rays_(rays), map_(map), constant_bias_(constant_bias) {}

  // {ideal, practical}: whether the texel says that the receiver is dark.
  std::pair<bool, bool> IsDark(const SurfacePoint& receiver, int32_t texel) const {
    const double first = map_.distance[texel];
    if (std::isinf(first)) return {false, false};
    const int32_t column = texel % map_.size.width, row = texel / map_.size.width;
    const std::optional<Ray> ray = rays_.At(column + 0.5, row + 0.5);
    const double wanted = ReceiverDistance(*ray, receiver);
    const double gap = wanted - first;
    const double resolution = caster_.Resolution(receiver.position);
    if (gap <= resolution) return {false, false};
    return {HasHitBehind(*ray, first, std::min(resolution, 0.5 * gap), wanted + gap),
            gap > resolution + constant_bias_};
  }

  // Whether another hit is nearer to the receiver's plane than the first one: it then lies behind
  // the first, and no further behind the plane than the first is in front of it.
  bool HasHitBehind(const Ray& ray, double first, double resolution, double far) const {
    // Along a surface single precision may find the first hit again a little further on; the exact
    // distance tells.
    constexpr int kMaxRepeats = 8;
    double near = first + resolution;
    for (int i = 0; i < kMaxRepeats; ++i) {
      const Hit hit = caster_.FirstHit(ray, near, far);
      if (!hit.is_surface()) return false;
      if (hit.distance > first + resolution) return hit.distance < far;
      near += std::max(resolution, near - first);
    }
    return false;
  }

 private:
  const RayCaster& caster_;
  const MapRays& rays_;
  const ShadowMap& map_;
  double constant_bias_;
};

absl::Status Validate(const SurfaceImage& image,
                      absl::Span<const Lighting> truth,
                      const Light& light,
                      MapSize size,
                      const BiasOptions& bias) {
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
  if (!(bias.constant_share >= 0.0) || !std::isfinite(bias.constant_share)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "bias.constant_share = %g, want 0 or more: a share of the range of distances",
        bias.constant_share));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<ShadowImage> JudgeMatrix(const RayCaster& caster,
                                        const SurfaceImage& image,
                                        absl::Span<const Lighting> truth,
                                        const Light& light,
                                        const Eigen::Matrix4d& map_from_world,
                                        MapSize size,
                                        const BiasOptions& bias) {
  const absl::StatusOr<Eigen::Matrix3d> map_from_ray = MapFromRay(map_from_world, light);
  if (!map_from_ray.ok()) return map_from_ray.status();
  if (absl::Status status = Validate(image, truth, light, size, bias); !status.ok()) return status;
  const auto num_pixels = static_cast<int>(truth.size());
  std::vector<int32_t> texels(num_pixels, kOutside);
  std::vector<uint8_t> wanted(static_cast<size_t>(size.width) * size.height, 0);
  for (int i = 0; i < num_pixels; ++i) {
    if (!IsJudged(truth[i])) continue;
    texels[i] = TexelOf(map_from_world, size, image.pixels[i].position);
    if (texels[i] != kOutside) wanted[texels[i]] = 1;
  }
  const ShadowMap map = RenderShadowMap(caster, light, *map_from_ray, size, wanted);
  const MapRays rays(light, *map_from_ray, caster.bounds());
  const Judge judge(caster, rays, map, bias.constant_share * DistanceRange(image, truth, light));

  ShadowImage result;
  result.ideal.assign(truth.begin(), truth.end());
  result.practical = result.ideal;
  ParallelFor(num_pixels, 4096, caster.num_threads(), [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      if (!IsJudged(truth[i])) continue;
      std::pair<bool, bool> dark = {false, false};
      if (texels[i] != kOutside) dark = judge.IsDark(image.pixels[i], texels[i]);
      result.ideal[i] = dark.first ? Lighting::kShadowed : Lighting::kLit;
      result.practical[i] = dark.second ? Lighting::kShadowed : Lighting::kLit;
    }
  });
  for (int i = 0; i < num_pixels; ++i) {
    if (!IsJudged(truth[i])) continue;
    if (result.ideal[i] != truth[i]) {
      ++result.wrong.ideal;
      if (texels[i] == kOutside) ++result.wrong.outside;
    }
    if (result.practical[i] != truth[i]) {
      ++result.wrong.practical;
      const SurfacePoint& pixel = image.pixels[i];
      const Eigen::Vector3d to_light = light.kind == Light::Kind::kPoint
                                           ? Eigen::Vector3d(light.position - pixel.position)
                                           : Eigen::Vector3d(-light.direction);
      result.wrong.practical_weighted += pixel.normal.dot(to_light.stableNormalized());
    }
  }
  return result;
}

}  // namespace lightfit
