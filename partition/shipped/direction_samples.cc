#include "partition/shipped/direction_samples.h"

#include "optimizer/energy/footprint.h"

namespace lightfit {

std::vector<DirectionSample> DirectionSamples(const Light& light,
                                              const Samples& samples,
                                              const MetricWeights& weights) {
  const Eigen::Matrix3d world_from_ray = RayFromWorld(light).leftCols<3>().transpose();
  std::vector<DirectionSample> directions;
  directions.reserve(samples.size());
  for (size_t i = 0; i < samples.size(); ++i) {
    const Sample sample = samples.At(i);
    const double length = sample.X.norm();
    DirectionSample direction;
    direction.direction = world_from_ray * sample.X / length;
    direction.G = length * length * world_from_ray * MetricTensor(sample, weights) *
                  world_from_ray.transpose();
    direction.weight = sample.weight;
    if (!direction.direction.allFinite() || !direction.G.allFinite()) continue;
    directions.push_back(direction);
  }
  return directions;
}

}  // namespace lightfit
