#include "partition/cell_fit.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/stop.h"
#include "geometry/convex_hull.h"
#include "geometry/ray_cone.h"
#include "optimizer/energy/reweighting.h"
#include "optimizer/energy/summary.h"
#include "optimizer/search/axis_evaluator.h"
#include "optimizer/search/global_search.h"
#include "optimizer/search/polish.h"

namespace lightfit {

namespace {

// As optimizer/energy/l1_weights.cc.
constexpr double kReweightingFloor = 0.02;
constexpr double kMostAspect = 16.0;
constexpr int kRefitRounds = 2;

constexpr int kRow[6] = {0, 0, 0, 1, 1, 2};
constexpr int kColumn[6] = {0, 1, 2, 1, 2, 2};

SymmetricVector Outer(const Eigen::Vector3d& v) {
  SymmetricVector outer;
  for (int i = 0; i < 6; ++i) outer(i) = v(kRow[i]) * v(kColumn[i]);
  return outer;
}

// So that its dot product with a symmetric matrix' entries is v'Gv.
SymmetricVector OuterForForms(const Eigen::Vector3d& v) {
  SymmetricVector outer = Outer(v);
  for (const int i : {1, 2, 4}) outer(i) *= 2.0;
  return outer;
}

MapSize WholeSize(const CellMap& map) {
  return {static_cast<int>(std::lround(map.width)), static_cast<int>(std::lround(map.height))};
}

void SetAspect(double aspect, CellMap* map) {
  aspect = std::clamp(aspect, 1.0 / kMostAspect, kMostAspect);
  map->width = std::sqrt(kCellTexels * aspect);
  map->height = kCellTexels / map->width;
}

// One pixel or a row of them, seen edge-on: with a little area around it.
Polygon Thickened(const Polygon& points) {
  constexpr double kShare = 0.01, kLeast = 1e-3;  // of the length; of the distance
  const Eigen::Vector2d along = points.back() - points.front();
  const double reach = std::max(kShare * along.norm(), kLeast * (1.0 + points.front().norm()));
  ScratchVector<Eigen::Vector2d> corners;
  for (const Eigen::Vector2d& point : points) {
    for (const double dx : {-reach, reach}) {
      for (const double dy : {-reach, reach}) corners.push_back(point + Eigen::Vector2d(dx, dy));
    }
  }
  return ConvexHull(corners);
}

}  // namespace

MapExtents::MapExtents(const Eigen::Matrix3d& map_from_ray) : axis_(map_from_ray.row(2)) {
  const Eigen::Matrix3d ray_from_map = map_from_ray.inverse();
  outer_u_ = OuterForForms(ray_from_map.col(0));
  outer_v_ = OuterForForms(ray_from_map.col(1));
}

Extents MapExtents::Of(const RaySample& sample) const {
  const double w = axis_.dot(sample.X);
  return {w * w * outer_u_.dot(sample.G), w * w * outer_v_.dot(sample.G)};
}

std::optional<CellCover> CoverBins(const ServedRays& rays, Bins bins, const Light& light) {
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();
  if (light.kind == Light::Kind::kPoint) {
    ScratchVector<Eigen::Vector3d> hull;
    for (const int bin : bins) {
      hull.insert(hull.end(), rays.bins[bin].hull.begin(), rays.bins[bin].hull.end());
    }
    const std::optional<Eigen::Vector3d> axis = FeasibleAxis(hull);
    if (!axis.has_value()) return std::nullopt;
    frame = FrameAlong(*axis);
  }
  ConvexHullBuilder builder;
  for (const int bin : bins) {
    for (const Eigen::Vector3d& ray : rays.bins[bin].hull) {
      builder.Add((frame * ray).hnormalized());
    }
  }
  CellCover cover;
  cover.hull = builder.Hull();
  if (cover.hull.empty()) return std::nullopt;
  std::optional<Eigen::Matrix3d> normalized;
  if (cover.hull.size() >= 3) normalized = NormalizeRays(frame, &cover.hull);
  if (!normalized.has_value()) {
    cover.hull = Thickened(cover.hull);
    normalized = NormalizeRays(frame, &cover.hull);
  }
  if (!normalized.has_value()) return std::nullopt;
  cover.normalized_from_ray = *normalized;
  return cover;
}

CellFitter::CellFitter(const ServedRays& rays, const Light& light, const SearchOptions& options)
    : rays_(rays), light_(light), options_(options), is_l1_(IsL1(options.metric)) {}

double CellFitter::EnergyOf(Bins bins, const MapExtents& extents) const {
  double sum = 0.0;
  for (const int bin : bins) {
    for (int i = rays_.bins[bin].samples_begin; i < rays_.bins[bin].samples_end; ++i) {
      const RaySample& sample = rays_.samples[i];
      const Extents of = extents.Of(sample);
      const double squared = of.along_u + of.along_v;
      sum += sample.weight * (is_l1_ ? std::sqrt(squared) : squared);
    }
  }
  return sum;
}

double CellFitter::FloorOf(Bins bins, const MapExtents& extents) const {
  if (!is_l1_) return 0.0;
  double weight = 0.0;
  for (const int bin : bins) {
    for (int i = rays_.bins[bin].samples_begin; i < rays_.bins[bin].samples_end; ++i) {
      weight += rays_.samples[i].weight;
    }
  }
  return weight > 0.0 ? kReweightingFloor * EnergyOf(bins, extents) / weight : 0.0;
}

SampleSums CellFitter::SumsOf(const RayBin& bin, const MapExtents& extents, double floor) const {
  SampleSums sums;
  Eigen::Matrix<double, 6, 6> tensor = Eigen::Matrix<double, 6, 6>::Zero();
  for (int i = bin.samples_begin; i < bin.samples_end; ++i) {
    const RaySample& sample = rays_.samples[i];
    double weight = sample.weight;
    if (is_l1_) {
      const Extents of = extents.Of(sample);
      const double footprint = std::max(std::sqrt(of.along_u + of.along_v), floor);
      sums.footprint_sum += weight * footprint;
      weight /= footprint;
    }
    tensor.noalias() += (weight * Outer(sample.X)) * sample.G.transpose();
  }
  sums.tensor = EnergyTensor(tensor);
  return sums;
}

bool CellFitter::HasSamples(Bins bins) const {
  return std::any_of(bins.begin(), bins.end(), [this](int bin) {
    return rays_.bins[bin].samples_end > rays_.bins[bin].samples_begin;
  });
}

// Without samples no map has more energy than another: the focused one.
std::optional<CellMap> CellFitter::MapWithoutSamples(const CellCover& cover) const {
  CellMap map;
  SetAspect(1.0, &map);
  const std::optional<Eigen::Matrix3d> map_from_ray = FocusedMap(cover, WholeSize(map), 0.0);
  if (!map_from_ray.has_value()) return std::nullopt;
  map.map_from_ray = *map_from_ray;
  return map;
}

std::optional<Eigen::Matrix3d> CellFitter::FocusedMap(const CellCover& cover,
                                                      MapSize size,
                                                      double guard_texels) const {
  AffineProblem problem;
  problem.map = size;
  problem.affine = Affine::kMinAreaRectangle;
  problem.normalized_from_ray = cover.normalized_from_ray;
  problem.margin_percent = options_.margin_percent;
  problem.margin_texels = guard_texels;
  const absl::StatusOr<AffineFit> fit =
      FitAffine(problem, cover.hull, Eigen::Matrix3d::Identity(), Eigen::Vector3d::UnitZ());
  if (!fit.ok()) return std::nullopt;
  return fit->map_from_ray * cover.normalized_from_ray;
}

std::optional<CellMap> CellFitter::Rounds(Bins bins, const CellMap* start, int num_rounds) const {
  const std::optional<CellCover> cover = CoverBins(rays_, bins, light_);
  if (!cover.has_value()) return std::nullopt;
  const Eigen::Matrix3d ray_from_normalized = cover->normalized_from_ray.inverse();

  if (!HasSamples(bins)) return MapWithoutSamples(*cover);

  // Whether there is a map yet whose footprints weigh the samples.
  CellMap current;
  bool is_first = start == nullptr;
  if (is_first) {
    SetAspect(1.0, &current);
  } else {
    current = *start;
  }
  BestOfRounds<CellMap> best;
  bool has_any = false;
  for (int round = 0; round < num_rounds; ++round) {
    if (StopRequested()) return std::nullopt;
    Eigen::Matrix<double, 6, 6> sum = Eigen::Matrix<double, 6, 6>::Zero();
    if (is_first) {
      for (const int bin : bins) {
        for (int i = rays_.bins[bin].samples_begin; i < rays_.bins[bin].samples_end; ++i) {
          const RaySample& sample = rays_.samples[i];
          sum.noalias() += (sample.weight * Outer(sample.X)) * sample.G.transpose();
        }
      }
    } else {
      const MapExtents extents(current.map_from_ray);
      const double floor = FloorOf(bins, extents);
      for (const int bin : bins) sum += SumsOf(rays_.bins[bin], extents, floor).tensor.entries();
    }
    Summary summary;
    summary.tensor = EnergyTensor(sum).Transformed(cover->normalized_from_ray);
    summary.cover.normalized_from_ray = cover->normalized_from_ray;
    summary.cover.hull = cover->hull;
    AffineProblem problem;
    problem.map = WholeSize(current);
    problem.normalized_from_ray = cover->normalized_from_ray;
    problem.margin_percent = options_.margin_percent;
    SummaryEvaluator evaluator(summary, problem, options_.min_w);
    AffineFit fit;
    if (is_first) {
      const std::optional<AffineFit> middle = evaluator.Evaluate(Eigen::Vector3d::UnitZ());
      if (!middle.has_value()) return std::nullopt;
      fit =
          GlobalSearch(summary, evaluator, *middle, options_.grid_directions, options_.refiner).fit;
    } else {
      const Eigen::Vector3d axis =
          ray_from_normalized.transpose() * current.map_from_ray.row(2).transpose();
      std::optional<AffineFit> from = evaluator.Evaluate(axis);
      if (!from.has_value()) from = evaluator.Evaluate(Eigen::Vector3d::UnitZ());
      if (!from.has_value()) break;
      fit = PolishAxis(summary, problem, options_.min_w, Polish::kQuick, *from).fit;
    }
    is_first = false;
    current.map_from_ray = fit.map_from_ray * cover->normalized_from_ray;
    const MapExtents extents(current.map_from_ray);
    current.energy = EnergyOf(bins, extents);
    if (!std::isfinite(current.energy)) break;
    const bool gained = best.Offer(current.energy, current);
    has_any = true;
    if (round > 1 && !gained) break;

    // The best aspect of these edges.   math.md (15)
    const double floor = FloorOf(bins, extents);
    Extents total;
    for (const int bin : bins) {
      for (int i = rays_.bins[bin].samples_begin; i < rays_.bins[bin].samples_end; ++i) {
        const Extents of = extents.Of(rays_.samples[i]);
        double weight = rays_.samples[i].weight;
        if (is_l1_) weight /= std::max(std::sqrt(of.along_u + of.along_v), floor);
        total.along_u += weight * of.along_u;
        total.along_v += weight * of.along_v;
      }
    }
    const double aspect = current.width / current.height * std::sqrt(total.along_u / total.along_v);
    if (std::isfinite(aspect) && aspect > 0.0) SetAspect(aspect, &current);
  }
  if (!has_any) return std::nullopt;
  return std::move(best).Best();
}

std::optional<CellMap> CellFitter::Fit(Bins bins) const {
  return Rounds(bins, nullptr, std::max(1, options_.reweighting_rounds));
}

std::optional<CellMap> CellFitter::Refit(Bins bins, const CellMap& start) const {
  return Rounds(bins, &start, kRefitRounds);
}

std::optional<Eigen::Matrix3d> CellFitter::MapOfSize(Bins bins,
                                                     const CellMap& map,
                                                     MapSize size,
                                                     double guard_texels) const {
  const std::optional<CellCover> cover = CoverBins(rays_, bins, light_);
  if (!cover.has_value()) return std::nullopt;
  if (!HasSamples(bins)) return FocusedMap(*cover, size, guard_texels);
  const MapExtents extents(map.map_from_ray);
  const double floor = FloorOf(bins, extents);
  Eigen::Matrix<double, 6, 6> sum = Eigen::Matrix<double, 6, 6>::Zero();
  for (const int bin : bins) sum += SumsOf(rays_.bins[bin], extents, floor).tensor.entries();
  Summary summary;
  summary.tensor = EnergyTensor(sum).Transformed(cover->normalized_from_ray);
  summary.cover.hull = cover->hull;
  AffineProblem problem;
  problem.map = size;
  problem.normalized_from_ray = cover->normalized_from_ray;
  problem.margin_percent = options_.margin_percent;
  problem.margin_texels = guard_texels;
  SummaryEvaluator evaluator(summary, problem, options_.min_w);
  const Eigen::Vector3d axis =
      cover->normalized_from_ray.inverse().transpose() * map.map_from_ray.row(2).transpose();
  const std::optional<AffineFit> fit = evaluator.Evaluate(axis);
  if (!fit.has_value()) return std::nullopt;
  return fit->map_from_ray * cover->normalized_from_ray;
}

}  // namespace lightfit
