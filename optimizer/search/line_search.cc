#include "optimizer/search/line_search.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <optional>

namespace lightfit {

SearchResult RotationLineSearch(AxisEvaluator& evaluator, const AffineFit& start, int rounds) {
  SearchResult result;
  result.fit = start;
  result.report.energy_start = start.energy;
  result.report.trace.push_back({"start", evaluator.num_evaluations(), start.energy});
  result.report.stop_reason = StopReason::kRoundLimit;

  // Axes are covectors: p' = N^-T p, and so dE/dp = N^-1 dE/dp'.
  const Eigen::Matrix3d normalized_from_space =
      evaluator.problem().ray_space == RaySpace::kLightSpace
          ? evaluator.problem().normalized_from_ray
          : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  const Eigen::Matrix3d space_from_normalized = normalized_from_space.inverse();

  for (int round = 0; round < rounds; ++round) {
    const Eigen::Vector3d gradient = space_from_normalized * evaluator.Gradient(result.fit);
    const Eigen::Vector3d axis =
        (normalized_from_space.transpose() * result.fit.map_from_ray.row(2).transpose())
            .normalized();
    const Eigen::Vector3d rotation_axis = axis.cross(-gradient).normalized();
    if (!rotation_axis.allFinite() || rotation_axis.norm() < 0.5) {
      result.report.stop_reason = StopReason::kConverged;  // no slope left to turn along
      break;
    }
    bool improved = false;
    for (const double angle_deg : kLineSearchAnglesDeg) {
      const Eigen::AngleAxisd rotation(angle_deg * M_PI / 180.0, rotation_axis);
      const Eigen::Vector3d candidate = rotation * axis;
      const std::optional<AffineFit> fit =
          evaluator.Evaluate(space_from_normalized.transpose() * candidate);
      if (!fit.has_value() || !(fit->energy < result.fit.energy)) continue;
      result.fit = *fit;
      improved = true;
    }
    if (!improved) {
      result.report.stop_reason = StopReason::kConverged;
      break;
    }
    result.report.trace.push_back({"line_search", evaluator.num_evaluations(), result.fit.energy});
  }
  result.report.evaluations = evaluator.num_evaluations();
  return result;
}

}  // namespace lightfit
