#include "bench/brute_force.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace lightfit {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Grids around a point have this many steps to either side, and shrink by this when the best point
// is not on their rim.
constexpr int kAngleSteps = 2, kAxisSteps = 3;
constexpr double kShrink = 0.5;
constexpr double kAngleStepEnd = 1e-4;  // radians
constexpr double kAxisStepEnd = 1e-5;   // of the way to the polar polygon's edge
constexpr int kMaxAxisGrids = 60;

double Uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

class BruteForce {
 public:
  BruteForce(const Summary& summary, MapSize map, const FitOptions& fit, int num_angles)
      : summary_(summary), min_w_(fit.min_w), num_angles_(num_angles) {
    // The shape itself has what the margins leave of the map.
    const double growth = 1.0 + 2.0 * fit.margin_percent / 100.0;
    inner_width_ = (map.width - 2.0 * fit.margin_texels) / growth;
    inner_height_ = (map.height - 2.0 * fit.margin_texels) / growth;
    for (int i = 0; i < num_angles; ++i) {
      cosine_.push_back(std::cos(AngleAt(i)));
      sine_.push_back(std::sin(AngleAt(i)));
    }
    widths_.resize(num_angles);
    energies_.resize(static_cast<size_t>(num_angles) * num_angles);
  }

  // The best pair of strips on the grid of angles, at one axis.
  BruteForceResult BestOnGrid(double a, double b) {
    BruteForceResult best;
    best = {kInfinity, a, b, 0.0, 0.0};
    if (!SetAxis(a, b)) return best;
    FillEnergies();
    const size_t i = std::min_element(energies_.begin(), energies_.end()) - energies_.begin();
    return {energies_[i], a, b, AngleAt(i / num_angles_), AngleAt(i % num_angles_)};
  }

  // The best pair of strips at one axis: every local minimum of the grid of angles, refined.
  BruteForceResult BestStrips(double a, double b) {
    BruteForceResult best = BestOnGrid(a, b);
    if (best.energy == kInfinity) return best;
    const double promising = 1.1 * best.energy;
    for (int i = 0; i < num_angles_; ++i) {
      for (int j = 0; j < num_angles_; ++j) {
        const double here = At(i, j);
        if (here > promising || here > At(i + 1, j) || here > At(i - 1, j) || here > At(i, j + 1) ||
            here > At(i, j - 1)) {
          continue;
        }
        const BruteForceResult refined = RefineAngles({here, a, b, AngleAt(i), AngleAt(j)});
        if (refined.energy < best.energy) best = refined;
      }
    }
    return best;
  }

  // Finer and finer grids of axes around `start`; `step` is in shares of the way to the edge.
  BruteForceResult RefineAxis(const BruteForceResult& start, double step) {
    BruteForceResult best = BestStrips(start.a, start.b);
    for (int grid = 0; grid < kMaxAxisGrids && step > kAxisStepEnd; ++grid) {
      const BruteForceResult center = best;
      bool on_rim = false;
      // On the spoke through the centre steps are shorter near the edge, where w is small.
      const Eigen::Vector2d axis(center.a, center.b);
      const double radius = axis.norm();
      const Eigen::Vector2d along =
          radius > 0.0 ? Eigen::Vector2d(axis / radius) : Eigen::Vector2d::UnitX();
      const Eigen::Vector2d across(-along.y(), along.x());
      const double edge = DistanceToEdge(along);
      const double along_step = step * std::max(edge - radius, min_w_ * edge);
      for (int i = -kAxisSteps; i <= kAxisSteps; ++i) {
        for (int j = -kAxisSteps; j <= kAxisSteps; ++j) {
          const Eigen::Vector2d p = axis + i * along_step * along + j * step * edge * across;
          const BruteForceResult found = BestStrips(p.x(), p.y());
          if (!(found.energy < best.energy)) continue;
          best = found;
          on_rim = std::abs(i) == kAxisSteps || std::abs(j) == kAxisSteps;
        }
      }
      if (!on_rim) step *= kShrink;
    }
    return best;
  }

  // A (1 + 1) evolution strategy with Rechenberg's one-fifth rule, in all four unknowns.
  BruteForceResult Improve(const BruteForceResult& start, int num_trials, std::mt19937_64& random) {
    BruteForceResult best = start;
    double step = 1e-2;
    for (int i = 0; i < num_trials; ++i) {
      const double reach = LeastW(best.a, best.b);  // near the limit only small steps make sense
      BruteForceResult trial = best;
      trial.a += step * reach * Uniform(random, -1.0, 1.0);
      trial.b += step * reach * Uniform(random, -1.0, 1.0);
      trial.angle_u_rad += step * Uniform(random, -1.0, 1.0);
      trial.angle_v_rad += step * Uniform(random, -1.0, 1.0);
      trial.energy =
          SetAxis(trial.a, trial.b) ? Energy(trial.angle_u_rad, trial.angle_v_rad) : kInfinity;
      const bool better = trial.energy < best.energy;
      if (better) best = trial;
      step *= better ? 1.5 : 0.9036;  // 1.5^(-1/4): at rest when one trial in five succeeds
      if (step < 1e-7) step = 1e-3;   // leaves kinks that it crept along
    }
    return best;
  }

  // The polar polygon's edge in a direction, where w is min_w on some ray.
  double DistanceToEdge(const Eigen::Vector2d& direction) const {
    double steepest = 0.0;
    for (const Eigen::Vector2d& ray : summary_.cover.hull) {
      steepest = std::max(steepest, -direction.dot(ray));
    }
    return (1.0 - min_w_) / steepest;
  }

 private:
  double AngleAt(int i) const { return M_PI * i / num_angles_; }
  double At(int i, int j) const {
    const auto wrap = [this](int k) { return (k + num_angles_) % num_angles_; };
    return energies_[static_cast<size_t>(wrap(i)) * num_angles_ + wrap(j)];
  }

  // Projects the hull along p = (a, b, 1), in the plane scaled so that M is the identity, where a
  // grid of angles is equally fine in all directions. The canonical map [e1; e2; p] has
  // r1 = (1, 0, -a), r2 = (0, 1, -b); M_ij = sum c w^2 ri'G rj.   math.md 5
  bool SetAxis(double a, double b) {
    points_.clear();
    for (const Eigen::Vector2d& ray : summary_.cover.hull) {
      const double w = a * ray.x() + b * ray.y() + 1.0;
      if (!(w >= min_w_)) return false;
      points_.push_back(ray / w);
    }
    const Eigen::Matrix3d at_axis = summary_.tensor.AtAxis(Eigen::Vector3d(a, b, 1.0));
    const Eigen::Vector3d r1(1.0, 0.0, -a), r2(0.0, 1.0, -b);
    const double m11 = r1.dot(at_axis * r1);
    const double m12 = r1.dot(at_axis * r2);
    const double m22 = r2.dot(at_axis * r2);
    const double determinant = m11 * m22 - m12 * m12;
    if (!(m11 > 0.0) || !(determinant > 0.0)) return false;
    const double l11 = std::sqrt(m11), l12 = m12 / l11, l22 = std::sqrt(determinant) / l11;
    for (Eigen::Vector2d& q : points_) q = {l11 * q.x() + l12 * q.y(), l22 * q.y()};
    return true;
  }

  double Width(double cosine, double sine) const {
    double low = kInfinity, high = -kInfinity;
    for (const Eigen::Vector2d& point : points_) {
      const double along = cosine * point.x() + sine * point.y();
      low = std::min(low, along);
      high = std::max(high, along);
    }
    return high - low;
  }

  // Each edge runs inside the other strip, across its own: |edge_u| = width_u / |sine|.   (9)
  double StripEnergy(double width_u, double width_v, double sine) const {
    if (sine == 0.0) return kInfinity;
    const double u = width_u / inner_width_, v = width_v / inner_height_;
    return (u * u + v * v) / (sine * sine);
  }

  double Energy(double angle_u_rad, double angle_v_rad) const {
    return StripEnergy(Width(std::cos(angle_u_rad), std::sin(angle_u_rad)),
                       Width(std::cos(angle_v_rad), std::sin(angle_v_rad)),
                       std::sin(angle_u_rad - angle_v_rad));
  }

  void FillEnergies() {
    for (int i = 0; i < num_angles_; ++i) widths_[i] = Width(cosine_[i], sine_[i]);
    for (int i = 0; i < num_angles_; ++i) {
      for (int j = 0; j < num_angles_; ++j) {
        const double sine = sine_[i] * cosine_[j] - cosine_[i] * sine_[j];
        energies_[static_cast<size_t>(i) * num_angles_ + j] =
            StripEnergy(widths_[i], widths_[j], sine);
      }
    }
  }

  // Finer and finer grids of both angles. Requires SetAxis(start.a, start.b).
  BruteForceResult RefineAngles(const BruteForceResult& start) const {
    BruteForceResult best = start;
    for (double step = 0.5 * AngleAt(1); step > kAngleStepEnd; step *= kShrink) {
      const double angle_u = best.angle_u_rad, angle_v = best.angle_v_rad;
      double width_u[2 * kAngleSteps + 1], width_v[2 * kAngleSteps + 1];
      for (int i = -kAngleSteps; i <= kAngleSteps; ++i) {
        const double u = angle_u + i * step, v = angle_v + i * step;
        width_u[i + kAngleSteps] = Width(std::cos(u), std::sin(u));
        width_v[i + kAngleSteps] = Width(std::cos(v), std::sin(v));
      }
      for (int i = -kAngleSteps; i <= kAngleSteps; ++i) {
        for (int j = -kAngleSteps; j <= kAngleSteps; ++j) {
          const double u = angle_u + i * step, v = angle_v + j * step;
          const double energy =
              StripEnergy(width_u[i + kAngleSteps], width_v[j + kAngleSteps], std::sin(u - v));
          if (energy < best.energy) best = {energy, best.a, best.b, u, v};
        }
      }
    }
    return best;
  }

  double LeastW(double a, double b) const {
    double least = 1.0;
    for (const Eigen::Vector2d& ray : summary_.cover.hull) {
      least = std::min(least, a * ray.x() + b * ray.y() + 1.0);
    }
    return std::max(least, min_w_);
  }

  const Summary& summary_;
  double min_w_;
  int num_angles_;
  double inner_width_, inner_height_;
  std::vector<double> cosine_, sine_, widths_, energies_;
  std::vector<Eigen::Vector2d> points_;
};

}  // namespace

BruteForceResult BruteForceFit(const Summary& summary,
                               MapSize map,
                               const FitOptions& fit_options,
                               const BruteForceOptions& options) {
  BruteForce search(summary, map, fit_options, options.num_angles);
  std::vector<BruteForceResult> grid = {search.BestOnGrid(0.0, 0.0)};
  // Two thirds of a spoke's points are evenly spaced, the rest halve the way that is left: w is
  // small there.
  const int num_even = 2 * options.num_radii / 3;
  for (int i = 0; i < options.num_directions; ++i) {
    const double angle = 2.0 * M_PI * i / options.num_directions;
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    const double edge = search.DistanceToEdge(direction);
    for (int j = 0; j < options.num_radii; ++j) {
      const double share =
          j < num_even ? (j + 0.5) / num_even : 1.0 - std::pow(0.5, j - num_even + 1.0) / num_even;
      const Eigen::Vector2d p = share * edge * direction;
      grid.push_back(search.BestOnGrid(p.x(), p.y()));
    }
  }
  std::stable_sort(
      grid.begin(), grid.end(), [](const auto& x, const auto& y) { return x.energy < y.energy; });

  std::mt19937_64 random(options.seed);
  BruteForceResult best = grid.front();
  std::vector<Eigen::Vector2d> starts;
  for (const BruteForceResult& start : grid) {
    if (!(start.energy < kInfinity)) break;
    if (static_cast<int>(starts.size()) == options.num_refined) break;
    const Eigen::Vector2d axis(start.a, start.b);
    const double spacing =
        axis.norm() > 0.0 ? search.DistanceToEdge(axis.normalized()) / num_even : 0.0;
    const auto is_near = [&](const Eigen::Vector2d& other) {
      return (axis - other).norm() < 3.0 * spacing;
    };
    if (std::any_of(starts.begin(), starts.end(), is_near)) continue;
    starts.push_back(axis);
    const BruteForceResult refined =
        search.Improve(search.RefineAxis(start, 0.5 / num_even), options.num_trials, random);
    if (refined.energy < best.energy) best = refined;
  }
  return best;
}

}  // namespace lightfit
