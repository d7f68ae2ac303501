#include "geometry/enclosing_parallelogram.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

namespace lightfit {

namespace {

// Relative gain below which alternating the strips has converged.
constexpr double kAlternationTolerance = 1e-13;
constexpr int kMaxAlternations = 50;

// Edges count as parallel when the sine of their angle is below this: one breakpoint, not two.
constexpr double kParallelTolerance = 1e-12;

// One vertex of the polar polygon (a breakpoint: the strip lies along an edge of the polygon) and
// the antipodal pair that is touched from here to the next breakpoint.
struct Breakpoint {
  Eigen::Vector2d row;   // n / W(n)
  Eigen::Vector2d pair;  // high - low of the pair after this breakpoint
  int low, high;         // that pair
};

// A point on the polar polygon's boundary: row = breakpoint, or between it and the next.
struct Row {
  Eigen::Vector2d value = Eigen::Vector2d::Zero();
  int index = 0;
  bool at_breakpoint = true;
};

// Half the boundary of the polar of K - K; the other half is its mirror image.
std::vector<Breakpoint> PolarOfDifference(const std::vector<Eigen::Vector2d>& points) {
  const int n = static_cast<int>(points.size());
  const auto next = [n](int i) { return i + 1 == n ? 0 : i + 1; };
  const auto edge = [&](int i) -> Eigen::Vector2d { return points[next(i)] - points[i]; };

  // Calipers: `low` starts an edge whose opposite vertex is `high`; advance whichever turns first.
  int low = 0, high = 1;
  while (Cross(edge(low), edge(high)) > 0.0) high = next(high);
  std::vector<Breakpoint> polar;
  polar.reserve(n);
  // Together `low` and `high` pass n edges while the strip turns by half a turn.
  for (int passed = 0; passed < n;) {
    // The strip turns counter-clockwise; it next lies along the edge at `low`, that at `high`, or
    // both at once.
    const Eigen::Vector2d edge_low = edge(low);
    const Eigen::Vector2d edge_high = -edge(high);
    const double turn = Cross(edge_low, edge_high);
    const bool parallel =
        std::abs(turn) <= kParallelTolerance * edge_low.norm() * edge_high.norm();
    const bool pass_low = parallel || turn > 0.0;
    const bool pass_high = (parallel || turn < 0.0) && passed + 2 <= n + (pass_low ? 0 : 1);
    const Eigen::Vector2d normal = Perpendicular(pass_low ? edge_low : edge_high);
    const double width = normal.dot(points[high] - points[low]);
    if (pass_low) low = next(low);
    if (pass_high) high = next(high);
    passed += static_cast<int>(pass_low) + static_cast<int>(pass_high);
    polar.push_back({normal / width, points[high] - points[low], low, high});
  }
  return polar;
}

class StripSearch {
 public:
  explicit StripSearch(std::vector<Breakpoint> polar)
      : polar_(std::move(polar)), size_(static_cast<int>(polar_.size())) {}

  int size() const { return size_; }
  Row AtBreakpoint(int index) const { return {polar_[index].row, index, true}; }

  // Energy of two rows: (1/|b|^2 ...) in terms of rows a, b: with s = a x b,
  //   E = ( |b|^2 / width^2 + |a|^2 / height^2 ) / s^2,   as |e_u| = |b| / s and |e_v| = |a| / s.
  static double Energy(const Eigen::Vector2d& a,
                       const Eigen::Vector2d& b,
                       double inverse_width_squared,
                       double inverse_height_squared) {
    const double s = Cross(a, b);
    return (b.squaredNorm() * inverse_width_squared + a.squaredNorm() * inverse_height_squared) /
           (s * s);
  }

  // The row a that minimises Energy(a, b) for a fixed b, walking downhill from `hint`.
  Row Best(const Eigen::Vector2d& b,
           double inverse_width_squared,
           double inverse_height_squared,
           int hint,
           double* energy) const {
    const auto at = [&](int i) {
      return Energy(polar_[Wrap(i)].row, b, inverse_width_squared, inverse_height_squared);
    };
    int i = hint;
    double here = at(i);
    if (!(here < std::numeric_limits<double>::infinity())) {  // b's own breakpoint: s = 0
      i = Wrap(i + size_ / 2);
      here = at(i);
    }
    int steps = 0;
    double ahead = at(i + 1);
    if (ahead < here) {
      do {
        ++i;
        here = ahead;
        ahead = at(i + 1);
      } while (ahead < here && ++steps < size_);
    } else {
      double behind = at(i - 1);
      while (behind < here && ++steps < size_) {
        --i;
        here = behind;
        behind = at(i - 1);
      }
    }
    Row best = AtBreakpoint(Wrap(i));
    // The minimum may lie inside either polar edge at this vertex.
    TryEdge(Wrap(i), b, inverse_width_squared, inverse_height_squared, &best, &here);
    TryEdge(Wrap(i - 1), b, inverse_width_squared, inverse_height_squared, &best, &here);
    *energy = here;
    return best;
  }

  StripContacts Contacts(const Row& row) const {
    StripContacts contacts;
    const Breakpoint& here = polar_[row.index];
    contacts.low_vertex = here.low;
    contacts.high_vertex = here.high;
    if (row.at_breakpoint) {
      // The pair before this breakpoint shares one vertex with the pair after it. Across the seam
      // of the half boundary low and high change places.
      const Breakpoint& before = polar_[Wrap(row.index - 1)];
      const int before_low = row.index == 0 ? before.high : before.low;
      const int before_high = row.index == 0 ? before.low : before.high;
      contacts.flush_on_high = before_low == here.low;
      contacts.flush_vertex = contacts.flush_on_high ? before_high : before_low;
    }
    return contacts;
  }

 private:
  int Wrap(int i) const { return ((i % size_) + size_) % size_; }

  // On the edge with pair c (a.c = 1) the energy is a'Qa / (a.e)^2 with e normal to b and
  // Q = cc' |b|^2 / width^2 + I / height^2, least at a ~ Q^-1 e.
  void TryEdge(int index,
               const Eigen::Vector2d& b,
               double inverse_width_squared,
               double inverse_height_squared,
               Row* best,
               double* energy) const {
    const Breakpoint& from = polar_[index];
    const bool seam = index + 1 == size_;
    const Eigen::Vector2d to = seam ? Eigen::Vector2d(-polar_[0].row) : polar_[index + 1].row;
    const Eigen::Vector2d& c = from.pair;
    // Q^-1 e up to scale, by Sherman-Morrison.
    const Eigen::Vector2d e = Perpendicular(b);
    const double k = b.squaredNorm() * inverse_width_squared;
    const Eigen::Vector2d a = e - c * (k * c.dot(e) / (inverse_height_squared + k * c.dot(c)));
    const double scale = a.dot(c);
    if (scale == 0.0) return;
    const Eigen::Vector2d row = a / scale;
    // Only between the two breakpoints does the strip touch the pair c.
    if (Cross(from.row, row) <= 0.0 || Cross(row, to) <= 0.0) return;
    const double candidate = Energy(row, b, inverse_width_squared, inverse_height_squared);
    if (candidate < *energy) {
      *energy = candidate;
      *best = {row, index, false};
    }
  }

  std::vector<Breakpoint> polar_;
  int size_;
};

}  // namespace

double ParallelogramEnergy(const Parallelogram& shape,
                           const Eigen::Matrix2d& metric,
                           double width,
                           double height) {
  return shape.edge_u.dot(metric * shape.edge_u) / (width * width) +
         shape.edge_v.dot(metric * shape.edge_v) / (height * height);
}

EnclosingParallelogram MinEnergyParallelogram(const Polygon& polygon,
                                              const Eigen::Matrix2d& metric,
                                              double width,
                                              double height) {
  assert(polygon.size() >= 3);
  const double metric_00 = std::sqrt(metric(0, 0));
  assert(metric_00 > 0.0);
  // Whitening: metric = L L', and q -> L' q keeps orientation as both diagonal entries are positive.
  Eigen::Matrix2d whiten;
  whiten << metric_00, metric(0, 1) / metric_00, 0.0,
      std::sqrt(std::max(metric(1, 1) - metric(0, 1) * metric(0, 1) / metric(0, 0),
                         std::numeric_limits<double>::min()));
  std::vector<Eigen::Vector2d> points(polygon.size());
  for (size_t i = 0; i < polygon.size(); ++i) points[i] = whiten * polygon[i];
  const StripSearch search(PolarOfDifference(points));

  const double iw2 = 1.0 / (width * width);
  const double ih2 = 1.0 / (height * height);
  double best_energy = std::numeric_limits<double>::infinity();
  Row best_u, best_v;
  // `fixed_is_v`: the start fixes the strip of edge_v and searches that of edge_u, or the reverse.
  for (const bool fixed_is_v : {true, false}) {
    if (!fixed_is_v && width == height) break;  // the same by symmetry
    const double first = fixed_is_v ? iw2 : ih2;
    const double second = fixed_is_v ? ih2 : iw2;
    int hint = search.size() / 2;
    for (int start = 0; start < search.size(); ++start) {
      Row fixed = search.AtBreakpoint(start);
      double energy = 0.0;
      Row found = search.Best(fixed.value, first, second, hint, &energy);
      hint = found.index;
      for (int i = 0; i < kMaxAlternations; ++i) {
        double improved = 0.0;
        fixed = search.Best(found.value, second, first, fixed.index, &improved);
        if (!(improved < energy * (1.0 - kAlternationTolerance))) break;
        energy = improved;
        found = search.Best(fixed.value, first, second, found.index, &improved);
        if (!(improved < energy * (1.0 - kAlternationTolerance))) break;
        energy = improved;
      }
      if (energy < best_energy) {
        best_energy = energy;
        best_u = fixed_is_v ? found : fixed;
        best_v = fixed_is_v ? fixed : found;
      }
    }
  }

  EnclosingParallelogram result;
  result.contacts = {search.Contacts(best_u), search.Contacts(best_v)};
  // Rows a, b with a.(y - low) in [0, 1] are the inverse of the matrix of edges.
  Eigen::Matrix2d rows;
  rows << best_u.value.transpose() * whiten, best_v.value.transpose() * whiten;
  const Eigen::Matrix2d edges = rows.inverse();
  const Eigen::Vector2d low(rows.row(0).dot(polygon[result.contacts[0].low_vertex]),
                            rows.row(1).dot(polygon[result.contacts[1].low_vertex]));
  result.shape.corner = edges * low;
  result.shape.edge_u = edges.col(0);
  result.shape.edge_v = edges.col(1);
  result.energy = best_energy;
  return result;
}

}  // namespace lightfit
