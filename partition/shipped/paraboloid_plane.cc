#include "partition/shipped/paraboloid_plane.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lightfit {

namespace {

// Footprint of a texel that spans a radian both ways, times the sample's weight.
double FootprintOfRadian(const DirectionSample& sample) {
  return sample.weight * std::sqrt(0.5 * std::max(sample.G.trace(), 0.0));
}

}  // namespace

const std::vector<Eigen::Vector3d>& ParaboloidNormals() {
  static const std::vector<Eigen::Vector3d>* const normals = [] {
    constexpr int kNumNormals = 200;
    const double golden_angle = M_PI * (3.0 - std::sqrt(5.0));
    auto* const list = new std::vector<Eigen::Vector3d>;
    for (int i = 0; i < kNumNormals; ++i) {
      const double z = 1.0 - (i + 0.5) / kNumNormals;
      const double r = std::sqrt(1.0 - z * z);
      list->emplace_back(r * std::cos(golden_angle * i), r * std::sin(golden_angle * i), z);
    }
    return list;
  }();
  return *normals;
}

ParaboloidPlane PlaneWithCosts(const Eigen::Vector3d& normal,
                               absl::Span<const DirectionSample> samples,
                               absl::Span<const CasterTriangle> triangles) {
  ParaboloidPlane plane;
  plane.normal = normal;
  double sum = 0.0, all = 0.0;
  for (const DirectionSample& sample : samples) {
    const double footprint = FootprintOfRadian(sample);
    sum += footprint * (1.0 + std::abs(normal.dot(sample.direction)));
    all += footprint;
  }
  if (all > 0.0) plane.footprints = sum / all;
  int64_t num_cut = 0;
  for (const CasterTriangle& triangle : triangles) {
    bool is_above = false, is_below = false;
    for (const Eigen::Vector3d& corner : triangle) {
      const double height = normal.dot(corner);
      is_above |= height > 0.0;
      is_below |= height < 0.0;
    }
    num_cut += is_above && is_below ? 1 : 0;
  }
  if (!triangles.empty()) {
    plane.share_cut = static_cast<double>(num_cut) / static_cast<double>(triangles.size());
  }
  return plane;
}

ParaboloidPlane BestParaboloidPlane(absl::Span<const DirectionSample> samples,
                                    absl::Span<const CasterTriangle> triangles,
                                    double cut_penalty) {
  ParaboloidPlane best;
  double least = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& normal : ParaboloidNormals()) {
    const ParaboloidPlane plane = PlaneWithCosts(normal, samples, triangles);
    const double cost = plane.footprints + cut_penalty * plane.share_cut;
    if (cost < least) {
      least = cost;
      best = plane;
    }
  }
  return best;
}

double SumOfFootprints(const Eigen::Vector3d& normal,
                       int size,
                       absl::Span<const DirectionSample> samples) {
  double sum = 0.0;
  for (const DirectionSample& sample : samples) {
    sum += FootprintOfRadian(sample) * (1.0 + std::abs(normal.dot(sample.direction)));
  }
  return 2.0 / size * sum;
}

}  // namespace lightfit
