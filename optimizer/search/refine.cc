#include "optimizer/search/refine.h"

#include <ceres/tiny_solver.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "base/stop.h"
#include "optimizer/search/refine_ceres.h"

namespace lightfit {

namespace {

constexpr double kUnusableResidual = 1e3;

// Derivative of a row h over p, 3x3, from the rays that its strip touches: each gives one equation
// h.X = t p.X with t the texel coordinate of that side. A strip that touches only two rays keeps
// its third degree of freedom, the turn, which does not matter at an optimum (envelope theorem).
Eigen::Matrix3d RowDerivative(const StripContacts& contacts,
                              const Polygon& hull,
                              const InnerInterval& texels) {
  const Eigen::Vector3d low = hull[contacts.low_vertex].homogeneous();
  const Eigen::Vector3d high = hull[contacts.high_vertex].homogeneous();
  Eigen::Matrix3d rays, right_side;
  rays.row(0) = low;
  rays.row(1) = high;
  right_side.row(0) = texels.low * low;
  right_side.row(1) = texels.high * high;
  if (contacts.flush_vertex >= 0) {
    const Eigen::Vector3d flush = hull[contacts.flush_vertex].homogeneous();
    rays.row(2) = flush;
    right_side.row(2) = (contacts.flush_on_high ? texels.high : texels.low) * flush;
  } else {
    rays.row(2) = low.cross(high).normalized();
    right_side.row(2).setZero();
  }
  return rays.inverse() * right_side;
}

}  // namespace

Eigen::Vector2d AxisParameters(const AffineFit& fit) {
  return fit.map_from_ray.row(2).head<2>().transpose() / fit.map_from_ray(2, 2);
}

ReducedEnergyCost::ReducedEnergyCost(const Summary& summary,
                                     const AffineProblem& problem,
                                     double min_w,
                                     double unit_energy,
                                     bool heeds_stop)
    : summary_(summary), problem_(problem), min_w_(min_w), heeds_stop_(heeds_stop) {
  // LDL' with pivoting copes with semidefinite forms (few samples).
  const Eigen::LDLT<Eigen::Matrix<double, 9, 9>> ldlt(summary.tensor.AsQuadraticForm());
  const Eigen::Matrix<double, 9, 1> diagonal =
      (ldlt.vectorD().cwiseMax(0.0) / unit_energy).cwiseSqrt();
  using Matrix9d = Eigen::Matrix<double, 9, 9>;
  const Matrix9d permutation = ldlt.transpositionsP() * Matrix9d::Identity();
  const Matrix9d upper = ldlt.matrixU();
  factor_transposed_ = diagonal.asDiagonal() * upper * permutation;
}

std::optional<AffineFit> ReducedEnergyCost::FitAt(const Eigen::Vector2d& ab) const {
  if ((heeds_stop_ && StopRequested()) || !ab.allFinite()) return std::nullopt;
  for (const Eigen::Vector2d& ray : summary_.cover.hull) {
    if (!(ab.dot(ray) + 1.0 >= min_w_)) return std::nullopt;
  }
  ++num_evaluations_;
  const Eigen::Vector3d axis = ab.homogeneous();
  absl::StatusOr<AffineFit> fit =
      FitAffine(problem_, summary_.cover.hull, summary_.tensor.AtAxis(axis), axis);
  if (!fit.ok()) return std::nullopt;
  return *std::move(fit);
}

Eigen::Matrix<double, 18, 1> ReducedEnergyCost::Residuals(
    const Eigen::Matrix3d& map_from_ray) const {
  const Eigen::Matrix3d R = map_from_ray.inverse();
  Eigen::Matrix<double, 18, 1> residuals;
  for (Eigen::Index i = 0; i < 2; ++i) {
    Eigen::Matrix<double, 9, 1> z;  // p (x) r_i
    for (Eigen::Index a = 0; a < 3; ++a) z.segment<3>(3 * a) = map_from_ray(2, a) * R.col(i);
    residuals.segment<9>(9 * i) = factor_transposed_ * z;
  }
  return residuals;
}

std::array<Eigen::Matrix3d, 2> ReducedEnergyCost::RowDerivatives(const AffineFit& fit) const {
  const Polygon& hull = summary_.cover.hull;
  const auto texels = [this](int size) {
    return InnerTexels(size, problem_.margin_percent, problem_.margin_texels);
  };
  return {RowDerivative(fit.contacts[0], hull, texels(problem_.map.width)),
          RowDerivative(fit.contacts[1], hull, texels(problem_.map.height))};
}

Eigen::Vector2d ReducedEnergyCost::GradientAt(const AffineFit& fit) const {
  if (problem_.affine != Affine::kMinEnergyParallelogram) {
    constexpr double kStep = 1e-5;
    const Eigen::Vector2d ab = AxisParameters(fit);
    Eigen::Vector2d gradient;
    for (Eigen::Index k = 0; k < 2; ++k) {
      const std::optional<AffineFit> ahead = FitAt(ab + kStep * Eigen::Vector2d::Unit(k));
      const std::optional<AffineFit> behind = FitAt(ab - kStep * Eigen::Vector2d::Unit(k));
      gradient(k) =
          ((ahead ? ahead->energy : fit.energy) - (behind ? behind->energy : fit.energy)) /
          (kStep * std::max(1, static_cast<int>(ahead.has_value()) + behind.has_value()));
    }
    return gradient;
  }
  // E = sum r_i'G r_i with G = T p p: its derivative over all of H, then the chain rule.
  const Eigen::Matrix3d R = fit.map_from_ray.inverse();
  const Eigen::Matrix3d G = summary_.tensor.AtAxis(fit.map_from_ray.row(2));
  Eigen::Matrix3d dE_dH = -2.0 * R.transpose() * G * R.leftCols<2>() * R.leftCols<2>().transpose();
  dE_dH.row(2) = summary_.tensor.EnergyAndGradient(fit.map_from_ray).dE_dp;
  const std::array<Eigen::Matrix3d, 2> dh_dp = RowDerivatives(fit);
  return (dE_dH.row(0) * dh_dp[0] + dE_dH.row(1) * dh_dp[1] + dE_dH.row(2)).head<2>().transpose();
}

void ReducedEnergyCost::AnalyticJacobian(const AffineFit& fit,
                                         Eigen::Matrix<double, 18, 2>* jacobian) const {
  const std::array<Eigen::Matrix3d, 2> dh_dp = RowDerivatives(fit);
  const Eigen::Matrix3d R = fit.map_from_ray.inverse();
  for (Eigen::Index k = 0; k < 2; ++k) {
    Eigen::Matrix3d dH;
    dH.row(0) = dh_dp[0].col(k);
    dH.row(1) = dh_dp[1].col(k);
    dH.row(2) = Eigen::RowVector3d::Unit(k);
    const Eigen::Matrix3d dR = -R * dH * R;
    for (Eigen::Index i = 0; i < 2; ++i) {
      Eigen::Matrix<double, 9, 1> dz;
      for (Eigen::Index a = 0; a < 3; ++a) {
        dz.segment<3>(3 * a) = dH(2, a) * R.col(i) + fit.map_from_ray(2, a) * dR.col(i);
      }
      jacobian->block<9, 1>(9 * i, k) = factor_transposed_ * dz;
    }
  }
}

void ReducedEnergyCost::NumericJacobian(const Eigen::Vector2d& ab,
                                        const AffineFit& fit,
                                        Eigen::Matrix<double, 18, 2>* jacobian) const {
  constexpr double kStep = 1e-5;
  const Eigen::Matrix<double, 18, 1> here = Residuals(fit.map_from_ray);
  for (Eigen::Index k = 0; k < 2; ++k) {
    const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(k);
    const std::optional<AffineFit> ahead = FitAt(ab + step);
    const std::optional<AffineFit> behind = FitAt(ab - step);
    const Eigen::Matrix<double, 18, 1> from = behind ? Residuals(behind->map_from_ray) : here;
    const Eigen::Matrix<double, 18, 1> to = ahead ? Residuals(ahead->map_from_ray) : here;
    const double length = kStep * (static_cast<int>(ahead.has_value()) + behind.has_value());
    jacobian->col(k) = length > 0.0 ? Eigen::Matrix<double, 18, 1>((to - from) / length)
                                    : Eigen::Matrix<double, 18, 1>::Zero();
  }
}

bool ReducedEnergyCost::operator()(const double* ab, double* residuals, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 18, 1>> residual_vector(residuals);
  const Eigen::Vector2d parameters(ab[0], ab[1]);
  const std::optional<AffineFit> fit = FitAt(parameters);
  if (!fit.has_value()) {
    residual_vector.setConstant(kUnusableResidual);
    return false;
  }
  residual_vector = Residuals(fit->map_from_ray);
  if (jacobian != nullptr) {
    Eigen::Matrix<double, 18, 2> derivative;
    if (problem_.affine == Affine::kMinEnergyParallelogram) {
      AnalyticJacobian(*fit, &derivative);
    } else {
      NumericJacobian(parameters, *fit, &derivative);
    }
    if (!derivative.allFinite()) derivative.setZero();
    Eigen::Map<Eigen::Matrix<double, 18, 2>>(jacobian, 18, 2) = derivative;
  }
  return true;
}

SearchResult RefineAxis(const Summary& summary,
                        const AffineProblem& problem,
                        double min_w,
                        Refiner refiner,
                        const AffineFit& start) {
  SearchResult result;
  result.fit = start;
  // Ceres aborts on parameters that are not finite; a start without energy has nothing to refine.
  Eigen::Vector2d parameters = AxisParameters(start);
  if (!parameters.allFinite() || !(start.energy > 0.0) || !std::isfinite(start.energy)) {
    return result;
  }
  if (StopRequested()) return result;
  const ReducedEnergyCost cost(summary, problem, min_w, start.energy, refiner != Refiner::kCeres);
  if (!cost.FitAt(parameters).has_value()) return result;

  constexpr RefineLimits kLimits;
  if (refiner == Refiner::kTinySolver) {
    ceres::TinySolver<ReducedEnergyCost> solver;
    solver.options.max_num_iterations = kLimits.max_iterations;
    solver.options.function_tolerance = kLimits.energy_tolerance;
    solver.options.parameter_tolerance = kLimits.step_tolerance;
    solver.Solve(cost, &parameters);
  } else {
    result.report.solver_report = SolveWithCeres(cost, kLimits, &parameters);
  }
  const std::optional<AffineFit> refined = cost.FitAt(parameters);
  if (refined.has_value() && refined->energy < start.energy) result.fit = *refined;
  result.report.evaluations = cost.num_evaluations();
  return result;
}

}  // namespace lightfit
