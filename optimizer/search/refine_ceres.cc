#include "optimizer/search/refine_ceres.h"

#include <ceres/ceres.h>

#include "base/stop.h"

namespace lightfit {

namespace {

class CeresCost final : public ceres::SizedCostFunction<18, 2> {
 public:
  explicit CeresCost(const ReducedEnergyCost& cost) : cost_(cost) {}

  bool Evaluate(double const* const* parameters,
                double* residuals,
                double** jacobians) const override {
    Eigen::Matrix<double, 18, 2> jacobian;
    const bool wanted = jacobians != nullptr && jacobians[0] != nullptr;
    if (!cost_(parameters[0], residuals, wanted ? jacobian.data() : nullptr)) return false;
    if (wanted) {  // Ceres wants it row-major
      Eigen::Map<Eigen::Matrix<double, 18, 2, Eigen::RowMajor>> row_major(jacobians[0]);
      row_major = jacobian;
    }
    return true;
  }

 private:
  const ReducedEnergyCost& cost_;
};

// Ceres would log a cost that fails at a point it has accepted, so that it is stopped from here.
class StopCallback final : public ceres::IterationCallback {
 public:
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& /*summary*/) override {
    return StopRequested() ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }
};

}  // namespace

bool HasCeres() { return true; }

std::string SolveWithCeres(const ReducedEnergyCost& cost,
                           const RefineLimits& limits,
                           Eigen::Vector2d* parameters) {
  CeresCost ceres_cost(cost);
  ceres::Problem::Options problem_options;
  problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  problem.AddResidualBlock(&ceres_cost, nullptr, parameters->data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = limits.max_iterations;
  options.function_tolerance = limits.energy_tolerance;
  options.parameter_tolerance = limits.step_tolerance;
  options.logging_type = ceres::SILENT;
  StopCallback stop_callback;
  options.callbacks = {&stop_callback};
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary.BriefReport();
}

}  // namespace lightfit
