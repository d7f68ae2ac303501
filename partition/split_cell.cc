#include "partition/split_cell.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/stop.h"
#include "geometry/convex_hull.h"
#include "geometry/ray_cone.h"
#include "optimizer/search/axis_evaluator.h"
#include "optimizer/search/polish.h"

namespace lightfit {

namespace {

constexpr int kNumDirections = 8;
constexpr int kNumQuantiles = 6;
constexpr int kNumExtremes = 32;
constexpr size_t kNumFinalists = 4;

constexpr MapSize kSquare = {1 << 10, 1 << 10};  // kCellTexels

// The points that reach furthest in directions all around.
struct ExtremePoints {
  std::array<double, kNumExtremes> reach;
  std::array<Eigen::Vector2d, kNumExtremes> points;

  ExtremePoints() {
    reach.fill(-std::numeric_limits<double>::infinity());
    points.fill(Eigen::Vector2d::Zero());
  }

  void Add(const ExtremePoints& other) {
    for (int i = 0; i < kNumExtremes; ++i) {
      if (other.reach[i] <= reach[i]) continue;
      reach[i] = other.reach[i];
      points[i] = other.points[i];
    }
  }

  Polygon Hull() const {
    if (!(reach[0] > -std::numeric_limits<double>::infinity())) return {};
    return ConvexHull(points);
  }
};

// A direction of the ray plane, one of `count` all around.
Eigen::Vector2d DirectionOf(int index, double count) {
  const double angle_rad = 2.0 * M_PI * index / count;
  return {std::cos(angle_rad), std::sin(angle_rad)};
}

// What is known of the bins on one side of a cut.
struct Side {
  Eigen::Matrix<double, 6, 6> tensor = Eigen::Matrix<double, 6, 6>::Zero();
  double footprint_sum = 0.0;
  ExtremePoints extremes;

  void Add(const Side& other) {
    tensor += other.tensor;
    footprint_sum += other.footprint_sum;
    extremes.Add(other.extremes);
  }
};

struct Cut {
  double value;  // sum of PlanTerm, bounded
  int direction;
  size_t num_before;  // bins in order along the direction
};

class Splitter {
 public:
  Splitter(const CellFitter& fitter, const Cell& cell, const CellCover& cover)
      : fitter_(fitter), cell_(cell), cover_(cover) {
    const MapExtents extents(cell.map.map_from_ray);
    const double floor = fitter.FloorOf(cell.bins, extents);
    std::array<Eigen::Vector2d, kNumExtremes> directions;
    for (int i = 0; i < kNumExtremes; ++i) directions[i] = DirectionOf(i, kNumExtremes);
    for (const int index : cell.bins) {
      const RayBin& bin = fitter.rays().bins[index];
      const SampleSums sums = fitter.SumsOf(bin, extents, floor);
      Side side;
      side.tensor = sums.tensor.entries();
      side.footprint_sum = fitter.is_l1() ? sums.footprint_sum : side.tensor.trace();
      for (const Eigen::Vector3d& ray : bin.hull) {
        const Eigen::Vector2d point = (cover.normalized_from_ray * ray).hnormalized();
        for (int i = 0; i < kNumExtremes; ++i) {
          const double reach = directions[i].dot(point);
          if (reach <= side.extremes.reach[i]) continue;
          side.extremes.reach[i] = reach;
          side.extremes.points[i] = point;
        }
      }
      sides_.push_back(side);
      const Eigen::Vector3d middle = cover.normalized_from_ray * bin.middle;
      // Those with lit samples alone may lie behind.
      constexpr double kLeastZ = 1e-3;
      middles_.push_back(middle.head<2>() / std::max(middle.z(), kLeastZ * middle.norm()));
    }
  }

  std::optional<std::pair<Cell, Cell>> Split() const {
    ScratchVector<Cut> cuts;
    for (int direction = 0; direction < kNumDirections; ++direction) {
      if (StopRequested()) return std::nullopt;
      RateCuts(direction, &cuts);
    }
    std::sort(cuts.begin(), cuts.end(), [](const Cut& a, const Cut& b) {
      return std::tuple(a.value, a.direction, a.num_before) <
             std::tuple(b.value, b.direction, b.num_before);
    });
    if (cuts.size() > kNumFinalists) cuts.resize(kNumFinalists);
    const Cut* best = nullptr;
    for (Cut& cut : cuts) {
      if (StopRequested()) return std::nullopt;
      const ScratchVector<int> order = Order(cut.direction);
      Side before, after;
      for (size_t i = 0; i < order.size(); ++i) {
        (i < cut.num_before ? before : after).Add(sides_[order[i]]);
      }
      cut.value = Rated(before, /*searches=*/true) + Rated(after, /*searches=*/true);
      if (best == nullptr || cut.value < best->value) best = &cut;
    }
    if (best == nullptr) return std::nullopt;
    return Cells(*best);
  }

 private:
  // Bins by how far along they are, as indices in `cell_.bins`.
  ScratchVector<int> Order(int direction) const {
    const Eigen::Vector2d along = DirectionOf(direction, 2.0 * kNumDirections);
    ScratchVector<int> order(sides_.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int a, int b) {
      return std::pair(along.dot(middles_[a]), a) < std::pair(along.dot(middles_[b]), b);
    });
    return order;
  }

  void RateCuts(int direction, ScratchVector<Cut>* cuts) const {
    const ScratchVector<int> order = Order(direction);
    double total = 0.0;
    for (const Side& side : sides_) total += side.footprint_sum;
    // Where to cut: the first so many in order have their share of the energy.
    std::array<size_t, kNumQuantiles> num_before{};
    double sum = 0.0;
    size_t next = 0;
    for (size_t i = 0; i < order.size() && next < kNumQuantiles; ++i) {
      sum += sides_[order[i]].footprint_sum;
      while (next < kNumQuantiles && sum >= total * (next + 1) / (kNumQuantiles + 1)) {
        num_before[next++] = i + 1;
      }
    }
    std::array<Side, kNumQuantiles> before, after;
    Side running;
    size_t done = 0;
    for (size_t cut = 0; cut < next; ++cut) {
      for (; done < num_before[cut]; ++done) running.Add(sides_[order[done]]);
      before[cut] = running;
    }
    running = Side();
    done = order.size();
    for (size_t cut = next; cut-- > 0;) {
      for (; done > num_before[cut]; --done) running.Add(sides_[order[done - 1]]);
      after[cut] = running;
    }
    for (size_t cut = 0; cut < next; ++cut) {
      if (num_before[cut] == order.size()) continue;
      const double value = Rated(before[cut], false) + Rated(after[cut], false);
      if (std::isfinite(value)) cuts->push_back({value, direction, num_before[cut]});
    }
  }

  // PlanTerm of a bound of what one map reaches around one side; infinity where it has none.
  double Rated(const Side& side, bool searches) const {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    Summary summary;
    summary.cover.hull = side.extremes.Hull();
    if (summary.cover.hull.size() < 3 || !(side.footprint_sum > 0.0)) return kNone;
    const std::optional<Eigen::Matrix3d> normalized =
        NormalizeRays(Eigen::Matrix3d::Identity(), &summary.cover.hull);
    if (!normalized.has_value()) return kNone;
    const Eigen::Matrix3d side_from_ray = *normalized * cover_.normalized_from_ray;
    summary.tensor = EnergyTensor(side.tensor).Transformed(side_from_ray);
    AffineProblem problem;
    problem.map = kSquare;
    problem.normalized_from_ray = side_from_ray;
    problem.margin_percent = fitter_.options().margin_percent;
    SummaryEvaluator evaluator(summary, problem, fitter_.options().min_w);
    std::optional<AffineFit> best = evaluator.Evaluate(Eigen::Vector3d::UnitZ());
    if (!best.has_value()) return kNone;
    // That of the cell's map is often near.
    const Eigen::Vector3d axis =
        side_from_ray.inverse().transpose() * cell_.map.map_from_ray.row(2).transpose();
    const std::optional<AffineFit> same = evaluator.Evaluate(axis);
    if (same.has_value() && same->energy < best->energy) best = same;
    if (searches) {
      best = PolishAxis(summary, problem, fitter_.options().min_w, Polish::kQuick, *best).fit;
    }
    // math.md (15): at the best aspect.
    const MapExtents extents(best->map_from_ray);
    const Eigen::Matrix3d ray_from_map = best->map_from_ray.inverse();
    const Eigen::Matrix3d metric = summary.tensor.AtAxis(best->map_from_ray.row(2));
    const double along_u = ray_from_map.col(0).dot(metric * ray_from_map.col(0));
    const double along_v = ray_from_map.col(1).dot(metric * ray_from_map.col(1));
    const double squares = 2.0 * std::sqrt(along_u * along_v);
    const double energy = fitter_.is_l1() ? std::sqrt(squares * side.footprint_sum) : squares;
    return std::isfinite(energy) ? PlanTerm(fitter_, energy) : kNone;
  }

  std::optional<std::pair<Cell, Cell>> Cells(const Cut& cut) const {
    const ScratchVector<int> order = Order(cut.direction);
    std::pair<Cell, Cell> cells;
    for (size_t i = 0; i < order.size(); ++i) {
      (i < cut.num_before ? cells.first : cells.second).bins.push_back(cell_.bins[order[i]]);
    }
    for (Cell* cell : {&cells.first, &cells.second}) {
      std::sort(cell->bins.begin(), cell->bins.end());
      const std::optional<CellMap> map = fitter_.Fit(cell->bins);
      if (!map.has_value()) return std::nullopt;
      cell->map = *map;
    }
    return cells;
  }

  const CellFitter& fitter_;
  const Cell& cell_;
  const CellCover& cover_;
  ScratchVector<Side> sides_;               // by bin of the cell
  ScratchVector<Eigen::Vector2d> middles_;  // of the bins, in the cover's rays
};

}  // namespace

double PlanTerm(const CellFitter& fitter, double energy) {
  const double exponent = fitter.is_l1() ? 0.5 : 1.0;
  return std::pow(energy, 1.0 / (1.0 + exponent));
}

std::optional<std::pair<Cell, Cell>> SplitCell(const CellFitter& fitter, const Cell& cell) {
  if (cell.bins.size() < 2) return std::nullopt;
  const std::optional<CellCover> cover = CoverBins(fitter.rays(), cell.bins, fitter.light());
  if (!cover.has_value()) return std::nullopt;
  return Splitter(fitter, cell, *cover).Split();
}

}  // namespace lightfit
