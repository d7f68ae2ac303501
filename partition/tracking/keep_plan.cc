#include "partition/tracking/keep_plan.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "base/stop.h"
#include "geometry/homography.h"
#include "geometry/light_map.h"
#include "partition/cell_fit.h"

namespace lightfit {

namespace {

// Of many maps only so many, the nearest, are tried to hold something or to lower the energy.
constexpr size_t kMostTried = 6;
constexpr int kMostLowered = 4;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

ScratchVector<Eigen::Vector3d> HullsOf(const ServedRays& rays, const ScratchVector<int>& bins) {
  ScratchVector<Eigen::Vector3d> hulls;
  for (const int bin : bins) {
    hulls.insert(hulls.end(), rays.bins[bin].hull.begin(), rays.bins[bin].hull.end());
  }
  return hulls;
}

// How far a ray is out of a map, as a share of the map's side.
double OverhangOf(const RayMap& map, const Eigen::Vector3d& ray) {
  const Eigen::Vector3d at = map.map_from_ray * ray;
  if (!(at.z() > 0.0)) return kInfinity;
  const double u = at.x() / at.z() / map.width, v = at.y() / at.z() / map.height;
  return std::max({-u, u - 1.0, -v, v - 1.0});
}

// Maps by how far the bins are out of them, the nearest first.
ScratchVector<int> NearestMaps(const ServedRays& rays,
                               const ScratchVector<int>& bins,
                               const KeptMaps& maps) {
  ScratchVector<double> overhangs;
  for (const KeptMap& map : maps) {
    double most = 0.0;
    for (const int bin : bins) {
      most = std::max(most, OverhangOf(map.rays, rays.bins[bin].middle));
    }
    overhangs.push_back(most);
  }
  ScratchVector<int> order(maps.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return std::pair(overhangs[a], a) < std::pair(overhangs[b], b);
  });
  return order;
}

// Those of the bins that are nearest to one and the same map, which has the most of them.
ScratchVector<int> LargestGroup(const ServedRays& rays,
                                const ScratchVector<int>& bins,
                                const KeptMaps& maps) {
  ScratchVector<ScratchVector<int>> groups(maps.size());
  for (const int bin : bins) {
    const Eigen::Vector3d& middle = rays.bins[bin].middle;
    const auto nearest =
        std::min_element(maps.begin(), maps.end(), [&](const KeptMap& a, const KeptMap& b) {
          return std::max(0.0, OverhangOf(a.rays, middle)) <
                 std::max(0.0, OverhangOf(b.rays, middle));
        });
    groups[nearest - maps.begin()].push_back(bin);
  }
  return *std::max_element(groups.begin(), groups.end(), [](const auto& a, const auto& b) {
    return a.size() < b.size();
  });
}

ScratchVector<int> Together(ScratchVector<int> bins, const ScratchVector<int>& others) {
  bins.insert(bins.end(), others.begin(), others.end());
  std::sort(bins.begin(), bins.end());
  bins.erase(std::unique(bins.begin(), bins.end()), bins.end());
  return bins;
}

}  // namespace

PlanKeeper::PlanKeeper(const LightView& view,
                       const ServedRays& rays,
                       const KeptMaps& before,
                       const PlanOptions& options,
                       const FitOptions& roomy)
    : view_(view),
      rays_(rays),
      options_(options),
      roomy_(roomy),
      pixels_(view, options.fit.samples),
      costs_(view, rays, before, options.fit, options.guard_texels) {}

HeldBins PlanKeeper::HeldBy(const KeptMaps& maps) const {
  return FindHeldBins(rays_, pixels_, RayMapsOf(maps), options_.guard_texels);
}

std::optional<KeptMap> PlanKeeper::FittedTo(const HeldBins& held,
                                            const ScratchVector<int>& bins,
                                            const KeptMap& start,
                                            MapSize size,
                                            const FitOptions& fit,
                                            TrackerAction action) const {
  if (bins.empty()) return std::nullopt;
  const CellFitter fitter(held.rays, *view_.light, fit);
  const double scale = std::sqrt(kCellTexels / (start.rays.width * start.rays.height));
  CellMap from;
  from.map_from_ray = start.rays.map_from_ray;
  from.map_from_ray.topRows<2>() *= scale;
  from.width = scale * start.rays.width;
  from.height = scale * start.rays.height;
  const std::optional<CellMap> fitted = fitter.Refit(bins, from);
  if (!fitted.has_value()) return std::nullopt;
  const std::optional<Eigen::Matrix3d> map_from_ray =
      fitter.MapOfSize(bins, *fitted, size, options_.guard_texels + fit.margin_texels);
  if (!map_from_ray.has_value()) return std::nullopt;
  const Eigen::Matrix<double, 3, 4> rows =
      Unmirrored(*map_from_ray, size) * view_.normalized_from_ray() * RayFromWorld(*view_.light);
  Eigen::Matrix4d map_from_world = Eigen::Matrix4d::Zero();
  map_from_world.topRows<2>() = rows.topRows<2>();
  map_from_world.row(3) = rows.row(2);
  const absl::StatusOr<KeptMap> map = MakeKeptMap(view_, map_from_world, size, action);
  if (!map.ok()) return std::nullopt;
  for (const int bin : bins) {
    for (const Eigen::Vector3d& ray : held.rays.bins[bin].hull) {
      if (!map->rays.Holds(ray, options_.guard_texels - kHeldTolerance)) return std::nullopt;
    }
  }
  return *map;
}

bool PlanKeeper::HoldByOne(const ScratchVector<int>& outside,
                           const HeldBins& held,
                           KeptMaps* maps) const {
  double least = kInfinity;
  KeptMaps best;
  const auto offer = [&](int k, const std::optional<KeptMap>& map) {
    if (!map.has_value()) return;
    KeptMaps changed = *maps;
    changed[k] = *map;
    const double cost = costs_.CostOf(changed);
    if (!(cost < least)) return;
    least = cost;
    best = std::move(changed);
  };
  const auto offer_fit = [&](int k, const ScratchVector<int>& bins, const KeptMap& start) {
    offer(k, FittedTo(held, bins, start, (*maps)[k].size, roomy_, TrackerAction::kInvalid));
  };
  const auto offer_both = [&](int k, const ScratchVector<int>& bins) {
    offer(k, ShiftedToHold((*maps)[k], HullsOf(held.rays, bins), options_.guard_texels));
    offer_fit(k, bins, (*maps)[k]);
  };
  const ScratchVector<int> order = NearestMaps(held.rays, outside, *maps);
  for (size_t i = 0; i < order.size(); ++i) {
    const int k = order[i];
    const ScratchVector<int> only = held.BinsOnlyIn(k);
    if (i >= kMostTried && !only.empty()) continue;
    offer_both(k, Together(held.BinsOf(k), outside));
    offer_both(k, Together(only, outside));
    if (!only.empty() || order.size() == 1) continue;
    // Nobody needs it: it may take over a neighbour's work.
    const int neighbour = i == 0 ? order[1] : order[0];
    offer_fit(k, Together(held.BinsOf(neighbour), outside), (*maps)[neighbour]);
  }
  if (best.empty()) return false;
  *maps = std::move(best);
  return true;
}

std::optional<HeldBins> PlanKeeper::HoldStepByStep(bool by_groups,
                                                   HeldBins held,
                                                   KeptMaps* maps) const {
  const size_t most_steps = 3 * maps->size() + 2;
  for (size_t step = 0; step < most_steps && !StopRequested(); ++step) {
    if (step > 0) held = HeldBy(*maps);
    const ScratchVector<int> outside = held.BinsOutside();
    if (outside.empty()) return held;
    const bool holds =
        HoldByOne(by_groups ? LargestGroup(held.rays, outside, *maps) : outside, held, maps);
    if (!holds) return std::nullopt;
  }
  return std::nullopt;
}

std::optional<HeldBins> PlanKeeper::HoldAll(KeptMaps* maps) const {
  HeldBins held = HeldBy(*maps);
  const ScratchVector<int> outside = held.BinsOutside();
  if (outside.empty()) return held;
  // By one map, or each group of bins by its own.
  KeptMaps by_one = *maps, by_several = *maps;
  const bool has_groups = LargestGroup(held.rays, outside, *maps).size() < outside.size();
  std::optional<HeldBins> held_by_several;
  if (has_groups) held_by_several = HoldStepByStep(/*by_groups=*/true, held, &by_several);
  std::optional<HeldBins> held_by_one =
      HoldStepByStep(/*by_groups=*/false, std::move(held), &by_one);
  if (!held_by_one.has_value() && !held_by_several.has_value()) return std::nullopt;
  const bool takes_several =
      held_by_several.has_value() &&
      (!held_by_one.has_value() || costs_.CostOf(by_several) < costs_.CostOf(by_one));
  *maps = takes_several ? std::move(by_several) : std::move(by_one);
  return takes_several ? std::move(held_by_several) : std::move(held_by_one);
}

double PlanKeeper::TightEnergyOf(const KeptMaps& maps, const HeldBins& held) const {
  KeptMaps tight = maps;
  for (size_t k = 0; k < maps.size(); ++k) {
    const std::optional<KeptMap> fitted = FittedTo(held,
                                                   held.BinsOf(static_cast<int>(k)),
                                                   maps[k],
                                                   maps[k].size,
                                                   options_.fit,
                                                   TrackerAction::kReplaced);
    if (fitted.has_value()) tight[k] = *fitted;
  }
  const ScratchVector<double> energies = costs_.EnergiesOf(maps);
  const ScratchVector<double> of_tight = costs_.EnergiesInstead(maps, tight);
  double sum = 0.0;
  for (size_t k = 0; k < maps.size(); ++k) sum += std::min(energies[k], of_tight[k]);
  return sum;
}

double PlanKeeper::LowerEnergy(double most, KeptMaps* maps) const {
  KeptMaps now = *maps, best;
  double least_price = kInfinity;
  for (int step = 0; step < kMostLowered && !StopRequested(); ++step) {
    const HeldBins held = HeldBy(now);
    KeptMaps next;
    double least = costs_.EnergyOf(now), price_of_next = kInfinity;
    const auto offer = [&](int k, const ScratchVector<int>& bins) {
      const std::optional<KeptMap> fitted =
          FittedTo(held, bins, now[k], now[k].size, roomy_, TrackerAction::kReplaced);
      if (!fitted.has_value()) return;
      KeptMaps changed = now;
      changed[k] = *fitted;
      const double energy = costs_.EnergyOf(changed), price = costs_.PriceOf(changed, most);
      // Of what is enough the cheapest, else what gains most.
      const bool is_enough = price < kInfinity;
      if (!(is_enough ? price < price_of_next : price_of_next == kInfinity && energy < least)) {
        return;
      }
      price_of_next = price;
      least = energy;
      next = std::move(changed);
    };
    for (int k = 0; k < static_cast<int>(now.size()); ++k) {
      offer(k, held.BinsOf(k));
      offer(k, held.BinsOnlyIn(k));
    }
    if (next.empty()) break;
    now = std::move(next);
    if (price_of_next < least_price) {
      least_price = price_of_next;
      best = now;
    }
  }
  if (!best.empty()) *maps = std::move(best);
  return least_price;
}

void PlanKeeper::MakeRoomy(KeptMaps* maps) const {
  const HeldBins held = HeldBy(*maps);
  for (size_t k = 0; k < maps->size(); ++k) {
    KeptMap& map = (*maps)[k];
    const std::optional<KeptMap> fitted =
        FittedTo(held, held.BinsOf(static_cast<int>(k)), map, map.size, roomy_, map.action);
    if (fitted.has_value()) map = *fitted;
  }
}

}  // namespace lightfit
