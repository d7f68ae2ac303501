#include "geometry/enclosing_parallelogram.h"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/polar_of_difference.h"

namespace lightfit {

namespace {

// The second strip is tried at every breakpoint and, between them, at angles no further apart than
// this. Local minima among these are pursued if they are within this factor of the best.
constexpr double kMaxStartAngle = 0.35;
constexpr double kPursuedFactor = 1.2;

// A local minimum is found to this share of the way to the next start, or to this slope per such
// step, relative to the energy.
constexpr double kShareTolerance = 1e-6;
constexpr double kSlopeTolerance = 1e-7;
constexpr int kMaxRounds = 30;

// A point on the polar polygon's boundary: row = breakpoint, or between it and the next.
struct Row {
  Eigen::Vector2d value = Eigen::Vector2d::Zero();
  int index = 0;
  bool at_breakpoint = true;
};

// Two strips and their energy.
struct StripPair {
  Row searched, fixed;
  double energy = std::numeric_limits<double>::infinity();
};

class StripSearch {
 public:
  explicit StripSearch(ScratchVector<PolarBreakpoint> polar)
      : polar_(std::move(polar)), size_(static_cast<int>(polar_.size())) {}

  int size() const { return size_; }
  bool is_finite() const {
    return std::all_of(polar_.begin(), polar_.end(), [](const PolarBreakpoint& breakpoint) {
      return std::isfinite(breakpoint.row.squaredNorm());
    });
  }
  Row AtBreakpoint(int index) const { return {polar_[index].row, index, true}; }

  // Energy in terms of two rows a, b: with s = a x b,
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
        i = Wrap(i + 1);
        here = ahead;
        ahead = at(i + 1);
      } while (ahead < here && ++steps < size_);
    } else {
      double behind = at(i - 1);
      while (behind < here && ++steps < size_) {
        i = Wrap(i - 1);
        here = behind;
        behind = at(i - 1);
      }
    }
    Row best = AtBreakpoint(i);
    // The minimum may lie inside one of the polar edges at this vertex: that which leads downhill.
    const Eigen::Vector2d& vertex = polar_[best.index].row;
    const Eigen::Vector2d after = NextRow(best.index) - vertex;
    const double s = Cross(vertex, b);
    const double numerator =
        b.squaredNorm() * inverse_width_squared + vertex.squaredNorm() * inverse_height_squared;
    // The sign of the derivative of Energy along a direction.
    const auto falls = [&](const Eigen::Vector2d& along) {
      return s * (inverse_height_squared * vertex.dot(along) * s - numerator * Cross(along, b)) <
             0.0;
    };
    if (falls(after)) {
      TryEdge(best.index, b, inverse_width_squared, inverse_height_squared, &best, &here);
    } else {
      const int index = Wrap(best.index - 1);
      const Eigen::Vector2d from =
          best.index == 0 ? Eigen::Vector2d(-polar_[index].row) : polar_[index].row;
      if (falls(from - vertex)) {
        TryEdge(index, b, inverse_width_squared, inverse_height_squared, &best, &here);
      }
    }
    *energy = here;
    return best;
  }

  // Rows in order along half the boundary: every breakpoint, and rows between.
  ScratchVector<Row> Starts() const {
    ScratchVector<Row> starts;
    starts.reserve(size_ + static_cast<int>(M_PI / kMaxStartAngle));
    for (int i = 0; i < size_; ++i) {
      starts.push_back(AtBreakpoint(i));
      const Eigen::Vector2d from = polar_[i].row;
      const Eigen::Vector2d to = NextRow(i);
      // Most polar edges are short: no need to ask for the angle.
      const double sine = Cross(from, to), cosine = from.dot(to);
      const int num_between = sine < kMaxStartAngle * cosine
                                  ? 0
                                  : static_cast<int>(std::atan2(sine, cosine) / kMaxStartAngle);
      for (int k = 1; k <= num_between; ++k) {
        const double share = static_cast<double>(k) / (num_between + 1);
        starts.push_back({from + share * (to - from), i, false});
      }
    }
    return starts;
  }

  // Closes in on the local minimum next to start `i`, whose neighbours have more energy. By the
  // envelope theorem the slope over the fixed row is that with the searched row held; its zero is
  // found by the Illinois method (regula falsi that halves the weight of a stale end).
  StripPair Pursue(
      const ScratchVector<Row>& starts, int i, int hint, double first, double second) const {
    StripPair best = At(starts[i], hint, first, second);
    const int n = static_cast<int>(starts.size());
    // Between neighbouring starts rows lie on a straight polar edge. Across the seam of the half
    // boundary they change sign.
    for (const bool ahead : {true, false}) {
      const bool seam = ahead ? i + 1 == n : i == 0;
      const Row& neighbour = starts[ahead ? (seam ? 0 : i + 1) : (seam ? n - 1 : i - 1)];
      const Eigen::Vector2d step =
          (seam ? Eigen::Vector2d(-neighbour.value) : neighbour.value) - starts[i].value;
      const double slope = Slope(best, step, first, second);
      if (slope >= 0.0) continue;
      // The polar edge is named after the breakpoint where it begins, on this half of the boundary.
      const int index = ahead ? starts[i].index : neighbour.index;
      const double sign = !ahead && seam ? -1.0 : 1.0;
      const auto at = [&](double share) {
        return At({sign * (starts[i].value + share * step), index, false},
                  best.searched.index,
                  first,
                  second);
      };
      StripPair far = At(neighbour, best.searched.index, first, second);
      double low = 0.0, low_slope = slope;
      double high = 1.0,
             high_slope = Slope(far, seam ? Eigen::Vector2d(-step) : step, first, second);
      for (int round = 0; round < kMaxRounds && high - low > kShareTolerance; ++round) {
        // Without a change of sign (or near a crease) bisect.
        const double share = high_slope > 0.0
                                 ? low - low_slope * (high - low) / (high_slope - low_slope)
                                 : 0.5 * (low + high);
        const StripPair pair = at(share);
        if (pair.energy < best.energy) best = pair;
        const double share_slope = Slope(pair, sign * step, first, second);
        if (std::abs(share_slope) <= kSlopeTolerance * pair.energy) break;
        if (share_slope < 0.0) {
          low = share;
          low_slope = share_slope;
          high_slope *= 0.5;
        } else {
          high = share;
          high_slope = share_slope;
          low_slope *= 0.5;
        }
      }
      break;
    }
    return best;
  }

  StripContacts Contacts(const Row& row) const {
    StripContacts contacts;
    const PolarBreakpoint& here = polar_[row.index];
    contacts.low_vertex = here.low;
    contacts.high_vertex = here.high;
    if (row.at_breakpoint) {
      // The pair before this breakpoint shares one vertex with the pair after it. Across the seam
      // of the half boundary low and high change places.
      const PolarBreakpoint& before = polar_[Wrap(row.index - 1)];
      const int before_low = row.index == 0 ? before.high : before.low;
      const int before_high = row.index == 0 ? before.low : before.high;
      contacts.flush_on_high = before_low == here.low;
      contacts.flush_vertex = contacts.flush_on_high ? before_high : before_low;
    }
    return contacts;
  }

 private:
  StripPair At(const Row& fixed, int hint, double first, double second) const {
    StripPair pair;
    pair.fixed = fixed;
    pair.searched = Best(fixed.value, first, second, hint, &pair.energy);
    return pair;
  }

  // The derivative of the energy as the fixed row moves by `step`, the searched one held.
  static double Slope(const StripPair& pair,
                      const Eigen::Vector2d& step,
                      double first,
                      double second) {
    const Eigen::Vector2d& a = pair.searched.value;
    const Eigen::Vector2d& b = pair.fixed.value;
    const double s = Cross(a, b);
    const double numerator = first * b.squaredNorm() + second * a.squaredNorm();
    return 2.0 * (first * b.dot(step) * s - numerator * Cross(a, step)) / (s * s * s);
  }

  // Into 0 ... size - 1, from at most one turn around.
  int Wrap(int i) const { return i < 0 ? i + size_ : i < size_ ? i : i - size_; }

  // The row at the far end of a polar edge; the last edge ends where the other half begins.
  Eigen::Vector2d NextRow(int index) const {
    return index + 1 == size_ ? Eigen::Vector2d(-polar_[0].row) : polar_[index + 1].row;
  }

  // On the edge with pair c (a.c = 1) the energy is a'Qa / (a.e)^2 with e normal to b and
  // Q = cc' |b|^2 / width^2 + I / height^2, least at a ~ Q^-1 e.
  void TryEdge(int index,
               const Eigen::Vector2d& b,
               double inverse_width_squared,
               double inverse_height_squared,
               Row* best,
               double* energy) const {
    const PolarBreakpoint& from = polar_[index];
    const Eigen::Vector2d to = NextRow(index);
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

  ScratchVector<PolarBreakpoint> polar_;
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
  // Whitening: metric = L L', and q -> L' q keeps orientation as both diagonal entries are
  // positive.
  Eigen::Matrix2d whiten;
  whiten << metric_00, metric(0, 1) / metric_00, 0.0,
      std::sqrt(std::max(metric(1, 1) - metric(0, 1) * metric(0, 1) / metric(0, 0),
                         std::numeric_limits<double>::min()));
  Polygon points(polygon.size());
  for (size_t i = 0; i < polygon.size(); ++i) points[i] = whiten * polygon[i];
  const StripSearch search(PolarOfDifference(points));
  EnclosingParallelogram result;
  if (!search.is_finite()) {
    result.energy = std::numeric_limits<double>::infinity();
    return result;
  }

  const double iw2 = 1.0 / (width * width);
  const double ih2 = 1.0 / (height * height);
  const ScratchVector<Row> starts = search.Starts();
  const int num_starts = static_cast<int>(starts.size());
  ScratchVector<double> energies(starts.size());
  ScratchVector<int> hints(starts.size());
  StripPair best;
  // `fixed_is_v`: the start fixes the strip of edge_v and searches that of edge_u, or the reverse.
  for (const bool fixed_is_v : {true, false}) {
    if (!fixed_is_v && width == height) break;  // the same by symmetry
    const double first = fixed_is_v ? iw2 : ih2;
    const double second = fixed_is_v ? ih2 : iw2;
    int hint = search.size() / 2;
    for (int i = 0; i < num_starts; ++i) {
      hint = search.Best(starts[i].value, first, second, hint, &energies[i]).index;
      hints[i] = hint;
    }
    const double limit =
        kPursuedFactor * std::min(best.energy, *std::min_element(energies.begin(), energies.end()));
    for (int i = 0; i < num_starts; ++i) {
      const int before = i == 0 ? num_starts - 1 : i - 1;
      const int after = i + 1 == num_starts ? 0 : i + 1;
      if (energies[i] > energies[before] || energies[i] >= energies[after] || energies[i] > limit) {
        continue;
      }
      StripPair found = search.Pursue(starts, i, hints[i], first, second);
      if (found.energy < best.energy) {
        best = found;
        if (!fixed_is_v) std::swap(best.searched, best.fixed);
      }
    }
  }
  const Row& best_u = best.searched;
  const Row& best_v = best.fixed;

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
  result.energy = best.energy;
  return result;
}

}  // namespace lightfit
