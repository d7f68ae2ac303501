#include "render/random_suns.h"

#include <cmath>
#include <random>

#include "absl/strings/str_format.h"

namespace lightfit {

std::vector<Light> RandomSuns(int count, uint64_t seed, const Eigen::Vector3d& up) {
  std::mt19937_64 random(seed);
  const auto uniform = [&random] {  // -1 ... 1; the distributions of <random> differ by library
    return 2.0 * (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53 - 1.0;
  };
  const Eigen::Matrix3d frame = FrameAlong(up.stableNormalized());
  std::vector<Light> suns;
  while (static_cast<int>(suns.size()) < count) {
    // Equal areas of the disc become equal areas of the hemisphere.
    const double x = uniform(), y = uniform();
    const double s = x * x + y * y;
    if (s >= 1.0) continue;
    const double stretch = std::sqrt(2.0 - s);
    const Eigen::Vector3d to_sun =
        frame.transpose() * Eigen::Vector3d(stretch * x, stretch * y, 1.0 - s);
    suns.push_back(Light::Directional(absl::StrFormat("sun%03d", suns.size() + 1), -to_sun));
  }
  return suns;
}

}  // namespace lightfit
