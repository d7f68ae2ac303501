#include "optimizer/samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace lightfit {

Sample Samples::At(size_t i) const {
  const Eigen::Vector3d X = ray_from_screen * Eigen::Vector4d(x[i], y[i], d[i], 1.0);
  // math.md (11): the ray's screen derivatives on the visible surface.
  const Eigen::Vector3d T1 = ray_from_screen.col(0) + d_x[i] * ray_from_screen.col(2);
  const Eigen::Vector3d T2 = ray_from_screen.col(1) + d_y[i] * ray_from_screen.col(2);
  const double V = X.dot(T1.cross(T2));
  Sample sample;
  sample.X = X;
  // math.md (1)
  sample.D.row(0) = T2.cross(X) / V;
  sample.D.row(1) = X.cross(T1) / V;
  sample.weight = weight[i];
  sample.edge_normal = has_edge_normals() ? Eigen::Vector2d(edge_normal_x[i], edge_normal_y[i])
                                          : Eigen::Vector2d::Zero();
  return sample;
}

Eigen::Vector2d ShadowEdgeNormal(
    const Readback& readback, const AffineDepth& affine_depth, int bit, int window, int x, int y) {
  // Gaussian weights with the window at two standard deviations.
  const double inverse_variance = 4.0 / (window * window);
  double sum_weight = 0.0, sum_bit = 0.0;
  Eigen::Vector2d sum_offset = Eigen::Vector2d::Zero(), sum_bit_offset = Eigen::Vector2d::Zero();
  for (int dy = -window; dy <= window; ++dy) {
    for (int dx = -window; dx <= window; ++dx) {
      const int px = x + dx, py = y + dy;
      if (px < 0 || py < 0 || px >= readback.width() || py >= readback.height()) continue;
      const size_t index = static_cast<size_t>(py) * readback.width() + px;
      if (!affine_depth.IsSurface(readback.depth[index])) continue;
      const double weight = std::exp(-0.5 * inverse_variance * (dx * dx + dy * dy));
      const double shadow = (readback.shadow_bits[index] >> bit) & 1u;
      sum_weight += weight;
      sum_bit += weight * shadow;
      sum_offset += weight * Eigen::Vector2d(dx, dy);
      sum_bit_offset += weight * shadow * Eigen::Vector2d(dx, dy);
    }
  }
  // Covariance of bit and offset: the gradient up to a scale, indifferent to missing pixels.
  const Eigen::Vector2d gradient = sum_bit_offset - sum_bit / sum_weight * sum_offset;
  const double length = gradient.norm();
  return length > 1e-9 ? Eigen::Vector2d(gradient / length) : Eigen::Vector2d(0.0, 0.0);
}

Samples SelectSamples(const Receivers& receivers,
                      const Light& light,
                      const Eigen::Matrix3d& normalized_from_ray,
                      bool with_edge_normals) {
  const uint32_t bit = uint32_t{1} << light.shadow_bit;
  const Eigen::Vector3d towards_sun = -light.direction.stableNormalized();

  Samples samples;
  samples.ray_from_screen = normalized_from_ray * RayFromWorld(light) * receivers.world_from_screen;
  samples.counts = receivers.counts[light.shadow_bit];
  for (auto* array : {&samples.x, &samples.y, &samples.d, &samples.d_x, &samples.d_y}) {
    array->reserve(samples.counts.candidates);
  }
  for (const BoundaryPixel& pixel : receivers.boundary) {
    if ((pixel.lights & bit) == 0) continue;
    const Eigen::Vector3d to_light = light.kind == Light::Kind::kPoint
                                         ? Eigen::Vector3d(light.position - pixel.position)
                                         : towards_sun;
    const double facing = pixel.normal.dot(to_light);
    if (facing <= 0.0) {
      ++samples.counts.facing_away;
      continue;
    }
    // Also false for a light at the receiver, and for normals that are not finite.
    if (pixel.edge_on_to_eye || !(facing > receivers.options.min_cos_light * to_light.norm())) {
      ++samples.counts.edge_on;
      continue;
    }
    samples.x.push_back(pixel.x + 0.5);
    samples.y.push_back(pixel.y + 0.5);
    samples.d.push_back(pixel.d);
    samples.d_x.push_back(pixel.d_x);
    samples.d_y.push_back(pixel.d_y);
    if (with_edge_normals) {
      const Eigen::Vector2d normal = ShadowEdgeNormal(receivers.readback,
                                                      receivers.affine_depth,
                                                      light.shadow_bit,
                                                      receivers.options.edge_window,
                                                      pixel.x,
                                                      pixel.y);
      samples.edge_normal_x.push_back(normal.x());
      samples.edge_normal_y.push_back(normal.y());
    }
  }
  samples.weight.assign(samples.size(), 1.0);
  samples.counts.used = static_cast<int64_t>(samples.size());
  return samples;
}

}  // namespace lightfit
