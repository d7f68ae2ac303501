#include "jobs/tune/minimize.h"

#include <nlopt.h>

#include <algorithm>
#include <limits>
#include <memory>

#include "render/generator/dice.h"

namespace lightfit {

namespace {

// A step this small moves no texel that matters.
constexpr double kSmallestStep = 2e-3;

// What the callbacks of one run share.
struct Run {
  const Objective& objective;
  const MinimizeOptions& options;
  nlopt_opt solver = nullptr;  // of the present round
  Minimum best = {};
  bool is_stopped = false;
};

bool IsDone(const Run& run) {
  return run.is_stopped || run.best.evaluations >= run.options.evaluations;
}

double Evaluate(unsigned num_coordinates, const double* point, double* /*gradient*/, void* data) {
  Run& run = *static_cast<Run*>(data);
  const std::vector<double> coordinates(point, point + num_coordinates);
  const std::optional<double> value = IsDone(run) ? std::nullopt : run.objective(coordinates);
  if (!value.has_value()) {
    run.is_stopped = run.is_stopped || !IsDone(run);
    nlopt_force_stop(run.solver);
    return std::numeric_limits<double>::max();
  }
  ++run.best.evaluations;
  if (run.best.evaluations == 1 || *value < run.best.value) {
    run.best.value = *value;
    run.best.point = coordinates;
  }
  if (IsDone(run)) nlopt_force_stop(run.solver);
  return *value;
}

// Until it has converged or the budget is spent.
void RunSubplex(std::vector<double> start, double step, Run* run) {
  const auto num_coordinates = static_cast<unsigned>(start.size());
  const std::unique_ptr<nlopt_opt_s, void (*)(nlopt_opt)> solver(
      nlopt_create(NLOPT_LN_SBPLX, num_coordinates), nlopt_destroy);
  run->solver = solver.get();
  nlopt_set_min_objective(solver.get(), Evaluate, run);
  nlopt_set_lower_bounds1(solver.get(), -run->options.bound);
  nlopt_set_upper_bounds1(solver.get(), run->options.bound);
  nlopt_set_initial_step1(solver.get(), step);
  nlopt_set_xtol_abs1(solver.get(), kSmallestStep);
  double value = 0.0;
  nlopt_optimize(solver.get(), start.data(), &value);
}

}  // namespace

std::optional<Minimum> Minimize(const Objective& objective,
                                const std::vector<double>& start,
                                const MinimizeOptions& options) {
  Run run{objective, options};
  Dice dice(options.seed);
  RunSubplex(start, options.step, &run);
  while (!IsDone(run)) {
    std::vector<double> restart = run.best.point;
    for (double& coordinate : restart) {
      const double move = dice.Uniform(-options.step, options.step);
      coordinate = std::clamp(coordinate + move, -options.bound, options.bound);
    }
    RunSubplex(restart, options.step, &run);
  }
  if (run.best.evaluations == 0) return std::nullopt;
  return run.best;
}

}  // namespace lightfit
