// render/random_suns.h
//
// Suns that nobody chose: for judging methods over many lights.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/light.h"

namespace lightfit {

// `count` suns "sun001" ..., uniform on the hemisphere around `up`. The first ones are the same
// whatever the count, on every machine.
std::vector<Light> RandomSuns(int count, uint64_t seed, const Eigen::Vector3d& up);

}  // namespace lightfit
