// optimizer/search/refine.h
//
// Refinement of the axis with Ceres.
// In:   a summary, a fitted map to start from.
// Out:  a fitted map that is at least as good.   math.md 4 and 6
//
// The unknowns are (a, b), the axis p = (a, b, 1) in normalised rays. The cost is the reduced
// energy E*(p): the least energy of an enclosing shape at p, as 18 residuals L'z1, L'z2 with z_i =
// p (x) r_i and Q = L L' (EnergyTensor::AsQuadraticForm), however many samples there are. Between
// changes of the rays that the shape touches E* is smooth. There the touched rays hold the rows h1,
// h2 as functions of p, and by the envelope theorem the derivative of E* is that of the energy with
// the touched rays held fixed.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "optimizer/energy/summary.h"
#include "optimizer/search/affine.h"
#include "optimizer/search/search_result.h"

namespace lightfit {

// The cost in the form that ceres::TinySolver wants; RefineAxis wraps it for ceres::Solve.
class ReducedEnergyCost {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = 18, NUM_PARAMETERS = 2 };

  // Residuals are scaled so that `unit_energy` has cost 1/2. The arguments must outlive the cost.
  ReducedEnergyCost(const Summary& summary,
                    const AffineProblem& problem,
                    double min_w,
                    double unit_energy,
                    bool heeds_stop = true);

  // `jacobian` (column-major 18 x 2) may be null. Returns false where the axis cannot be used; the
  // residuals are then large and finite, so that a solver that does not look steps back.
  bool operator()(const double* ab, double* residuals, double* jacobian) const;

  // The fit at (a, b), or nothing where the axis cannot be used, which is everywhere once the
  // StopScope says so, if it heeds that.
  std::optional<AffineFit> FitAt(const Eigen::Vector2d& ab) const;

  // Derivative of the fit's energy over (a, b), as the Jacobian has it: pixels^2 per texel^2.
  Eigen::Vector2d GradientAt(const AffineFit& fit) const;

  int num_evaluations() const { return num_evaluations_; }

 private:
  Eigen::Matrix<double, 18, 1> Residuals(const Eigen::Matrix3d& map_from_ray) const;
  // Derivatives of the rows h1, h2 over p while the touched rays stay touched, 3x3 each.
  std::array<Eigen::Matrix3d, 2> RowDerivatives(const AffineFit& fit) const;
  void AnalyticJacobian(const AffineFit& fit, Eigen::Matrix<double, 18, 2>* jacobian) const;
  void NumericJacobian(const Eigen::Vector2d& ab,
                       const AffineFit& fit,
                       Eigen::Matrix<double, 18, 2>* jacobian) const;

  const Summary& summary_;
  const AffineProblem& problem_;
  double min_w_;
  bool heeds_stop_;
  Eigen::Matrix<double, 9, 9> factor_transposed_;  // L', scaled
  mutable int num_evaluations_ = 0;
};

// (a, b) of a fit's axis.
Eigen::Vector2d AxisParameters(const AffineFit& fit);

// Never returns a fit with more energy than `start`.
SearchResult RefineAxis(const Summary& summary,
                        const AffineProblem& problem,
                        double min_w,
                        Refiner refiner,
                        const AffineFit& start);

}  // namespace lightfit
