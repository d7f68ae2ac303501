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
                       const MapRays& rays,
                       const ShadowMap& map,
                       double constant_bias)
    : caster_(caster), rays_(rays), map_(map), constant_bias_(constant_bias) {}

std::pair<bool, bool> TexelJudge::IsDark(const SurfacePoint& receiver, int32_t texel) const {
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
bool TexelJudge::HasHitBehind(const Ray& ray, double first, double resolution, double far) const {
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

}  // namespace lightfit
