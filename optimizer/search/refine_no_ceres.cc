#include "optimizer/search/refine_ceres.h"

namespace lightfit {

bool HasCeres() { return false; }

std::string SolveWithCeres(const ReducedEnergyCost& /*cost*/,
                           const RefineLimits& /*limits*/,
                           Eigen::Vector2d* /*parameters*/) {
  return "";
}

}  // namespace lightfit
