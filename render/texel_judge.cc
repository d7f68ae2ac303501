#include "render/texel_judge.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace lightfit {
namespace {

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

}  // namespace

TexelJudge::TexelJudge(const RayCaster& caster,
                       const TexelMaps& maps,
                       const TexelHits& hits,
                       double constant_bias)
    : caster_(caster), maps_(maps), hits_(hits), constant_bias_(constant_bias) {}

std::pair<bool, bool> TexelJudge::IsDark(const SurfacePoint& receiver, int32_t texel) const {
  const double first = hits_.First(texel);
  if (std::isinf(first)) return {false, false};
  const std::optional<Ray> ray = maps_.RayOf(texel);
  const double wanted = ReceiverDistance(*ray, receiver);
  const double gap = wanted - first;
  const double resolution = caster_.Resolution(receiver.position);
  if (gap <= resolution) return {false, false};
  // A hit nearer to the receiver's plane than the first one lies behind that, and no further behind
  // the plane than the first is in front of it.
  return {hits_.HasBehind(texel, std::min(resolution, 0.5 * gap), wanted + gap),
          gap > resolution + constant_bias_};
}

}  // namespace lightfit
