#include "optimizer/readback/edge_normals.h"

#include <algorithm>
#include <cmath>

#include "geometry/affine_depth.h"

namespace lightfit {

EdgeNormals::EdgeNormals(const Readback& readback,
                         const AffineDepth& affine_depth,
                         int bit,
                         int window)
    : readback_(readback), affine_depth_(affine_depth), bit_(bit), window_(window) {
  // Gaussian, with the window at two standard deviations.
  const double inverse_variance = 4.0 / (window * window);
  for (int dy = -window; dy <= window; ++dy) {
    for (int dx = -window; dx <= window; ++dx) {
      weights_.push_back(std::exp(-0.5 * inverse_variance * (dx * dx + dy * dy)));
    }
  }
}

Eigen::Vector2d EdgeNormals::At(int x, int y) const {
  double sum_weight = 0.0, sum_bit = 0.0;
  Eigen::Vector2d sum_offset = Eigen::Vector2d::Zero(), sum_bit_offset = Eigen::Vector2d::Zero();
  const int width = readback_.width();
  const int first_dy = std::max(-window_, -y);
  const int last_dy = std::min(window_, readback_.height() - 1 - y);
  const int first_dx = std::max(-window_, -x);
  const int last_dx = std::min(window_, width - 1 - x);
  for (int dy = first_dy; dy <= last_dy; ++dy) {
    const size_t row = static_cast<size_t>(y + dy) * width + x;
    const double* row_weights = &weights_[(dy + window_) * (2 * window_ + 1) + window_];
    for (int dx = first_dx; dx <= last_dx; ++dx) {
      if (!affine_depth_.IsSurface(readback_.depth[row + dx])) continue;
      const Eigen::Vector2d weighted_offset = row_weights[dx] * Eigen::Vector2d(dx, dy);
      sum_weight += row_weights[dx];
      sum_offset += weighted_offset;
      if (((readback_.shadow_bits[row + dx] >> bit_) & 1u) == 0) continue;
      sum_bit += row_weights[dx];
      sum_bit_offset += weighted_offset;
    }
  }
  // Covariance of bit and offset: the gradient up to a scale, indifferent to missing pixels.
  const Eigen::Vector2d gradient = sum_bit_offset - sum_bit / sum_weight * sum_offset;
  const double length = gradient.norm();
  return length > 1e-9 ? Eigen::Vector2d(gradient / length) : Eigen::Vector2d(0.0, 0.0);
}

}  // namespace lightfit
