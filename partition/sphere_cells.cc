#include "partition/sphere_cells.h"

#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include "base/stop.h"
#include "optimizer/energy/reweighting.h"
#include "optimizer/readback/cover.h"
#include "partition/divided_maps.h"
#include "partition/served_rays.h"

namespace lightfit {

namespace {

constexpr int kNumStarts = 8;
constexpr int kMaxRounds = 30;

// The centre that a direction is closest to.
int ClosestTo(const ScratchVector<Eigen::Vector3d>& centres, const Eigen::Vector3d& direction) {
  int closest = 0;
  for (size_t k = 1; k < centres.size(); ++k) {
    if (direction.dot(centres[k]) > direction.dot(centres[closest])) closest = static_cast<int>(k);
  }
  return closest;
}

// The first centre is one of the bins; each further one the bin that is furthest from all before.
ScratchVector<Eigen::Vector3d> SpreadCentres(const ScratchVector<RayBin>& bins,
                                             size_t first,
                                             int count) {
  ScratchVector<Eigen::Vector3d> centres = {bins[first].middle};
  while (static_cast<int>(centres.size()) < count) {
    const RayBin* furthest = nullptr;
    double least_cos = std::numeric_limits<double>::infinity();
    for (const RayBin& bin : bins) {
      if (bin.hull.empty()) continue;
      const double cos = bin.middle.dot(centres[ClosestTo(centres, bin.middle)]);
      if (cos >= least_cos) continue;
      least_cos = cos;
      furthest = &bin;
    }
    if (furthest == nullptr) break;
    centres.push_back(furthest->middle);
  }
  return centres;
}

// Lloyd's rounds: clusters, their means, and again.
void MoveToMeans(const ScratchVector<RayBin>& bins, ScratchVector<Eigen::Vector3d>* centres) {
  for (int round = 0; round < kMaxRounds && !StopRequested(); ++round) {
    ScratchVector<Eigen::Vector3d> sums(centres->size(), Eigen::Vector3d::Zero());
    for (const RayBin& bin : bins) {
      sums[ClosestTo(*centres, bin.middle)] += bin.num_covered * bin.middle;
    }
    bool has_moved = false;
    for (size_t k = 0; k < centres->size(); ++k) {
      constexpr double kLeastLength = 1e-9;  // as good as a cluster all around, or an empty one
      if (!(sums[k].norm() > kLeastLength)) continue;
      const Eigen::Vector3d mean = sums[k].normalized();
      constexpr double kStandsStill = 1e-12;
      has_moved |= (mean - (*centres)[k]).squaredNorm() > kStandsStill;
      (*centres)[k] = mean;
    }
    if (!has_moved) return;
  }
}

// A centre whose cell has no map, or nothing to cover, is left out, and its bins go to the others.
Cells CellsAround(const CellFitter& fitter, ScratchVector<Eigen::Vector3d> centres) {
  const ScratchVector<RayBin>& bins = fitter.rays().bins;
  while (!centres.empty() && !StopRequested()) {
    Cells cells(centres.size());
    for (size_t i = 0; i < bins.size(); ++i) {
      cells[ClosestTo(centres, bins[i].middle)].bins.push_back(static_cast<int>(i));
    }
    size_t without_map = cells.size();
    for (size_t k = 0; k < cells.size() && without_map == cells.size(); ++k) {
      const std::optional<CellMap> map = fitter.Fit(cells[k].bins);
      if (map.has_value()) {
        cells[k].map = *map;
      } else {
        without_map = k;
      }
    }
    if (without_map == cells.size()) return cells;
    centres.erase(centres.begin() + static_cast<std::ptrdiff_t>(without_map));
  }
  return {};
}

}  // namespace

Cells ClusterCells(const CellFitter& fitter, int num_cells, double texels) {
  const ScratchVector<RayBin>& bins = fitter.rays().bins;
  BestOfRounds<Cells> best;
  best.Offer(std::numeric_limits<double>::infinity(), Cells());
  for (int start = 0; start < kNumStarts && !bins.empty() && !StopRequested(); ++start) {
    const size_t first = start * bins.size() / kNumStarts;
    if (bins[first].hull.empty()) continue;
    ScratchVector<Eigen::Vector3d> centres = SpreadCentres(bins, first, num_cells);
    MoveToMeans(bins, &centres);
    Cells cells = CellsAround(fitter, centres);
    if (cells.empty()) continue;
    const double energy = DividedMaps(fitter, cells, texels).Energy();
    best.Offer(energy, std::move(cells));
  }
  Cells cells = std::move(best).Best();
  if (cells.empty() && num_cells >= kAlwaysEnoughMaps && !StopRequested()) {
    ScratchVector<Eigen::Vector3d> faces;
    for (int axis = 0; axis < 3; ++axis) {
      faces.push_back(Eigen::Vector3d::Unit(axis));
      faces.push_back(-Eigen::Vector3d::Unit(axis));
    }
    cells = CellsAround(fitter, std::move(faces));
  }
  return cells;
}

int NumMapsAround(const CellFitter& fitter, int least) {
  int num_maps = least;
  // Whether there are cells does not depend on how many texels they have.
  while (num_maps < kAlwaysEnoughMaps && ClusterCells(fitter, num_maps, kCellTexels).empty()) {
    ++num_maps;
  }
  return num_maps;
}

absl::StatusOr<int> NumMapsAround(const LightView& view, const FitOptions& fit) {
  // A view has no cover for another reason too: all receivers in one plane with the light.
  if (view.cover.status() != SurroundedError(*view.light)) return 0;
  FitOptions coarse = fit;
  coarse.use_fine_cover = false;  // left out where it wants more maps than there may be
  const absl::StatusOr<ServedRays> rays = FindServedRays(view, coarse);
  if (!rays.ok()) return rays.status();
  const int num_maps = NumMapsAround(CellFitter(*rays, *view.light, fit), 2);
  if (absl::Status status = CheckStop(*view.light); !status.ok()) return status;
  return num_maps;
}

}  // namespace lightfit
