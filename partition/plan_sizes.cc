#include "partition/plan_sizes.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "optimizer/sizing/allocation.h"
#include "optimizer/sizing/map_sizes.h"
#include "partition/divided_maps.h"

namespace lightfit {

namespace {

// Of about this shape, and of no more texels.
MapSize WholeSize(const CellMap& map, double texels) {
  const auto side_of = [](double side) {
    return static_cast<int>(std::clamp(side, 1.0, static_cast<double>(kMaxMapSide)));
  };
  const int width =
      side_of(std::round(std::min(std::sqrt(texels * map.width / map.height), texels)));
  return {width, side_of(texels / width)};
}

// Energy of a cell's map cut into other texels: a share of it falls with the width, the other with
// the height.   math.md (15)
class ShapeOfCell {
 public:
  ShapeOfCell(const CellFitter& fitter, const Cell& cell) : map_(cell.map), is_l1_(fitter.is_l1()) {
    const MapExtents extents(cell.map.map_from_ray);
    for (const int bin : cell.bins) {
      const RayBin& of = fitter.rays().bins[bin];
      for (int i = of.samples_begin; i < of.samples_end; ++i) {
        const RaySample& sample = fitter.rays().samples[i];
        const Extents extent = extents.Of(sample);
        const double squared = extent.along_u + extent.along_v;
        if (!(squared > 0.0)) continue;
        const double weight = is_l1_ ? sample.weight / std::sqrt(squared) : sample.weight;
        along_u_ += weight * extent.along_u;
        along_v_ += weight * extent.along_v;
      }
    }
    // Without samples it is the texels that count, in the map's own shape.
    if (!(along_u_ + along_v_ > 0.0)) along_u_ = along_v_ = 1.0;
  }

  double EnergyAt(MapSize size) const {
    const double u = map_.width / size.width, v = map_.height / size.height;
    const double squared = along_u_ * u * u + along_v_ * v * v;
    return is_l1_ ? std::sqrt(squared * (along_u_ + along_v_)) : squared;
  }

 private:
  const CellMap& map_;
  bool is_l1_;
  double along_u_ = 0.0, along_v_ = 0.0;
};

absl::StatusOr<ScratchVector<MapSize>> AllowedSizesOf(const CellFitter& fitter,
                                                      const Cells& cells,
                                                      const PlanOptions& options) {
  const std::vector<int> sides = AllowedSides(*options.sizes);
  const int64_t least = int64_t{sides.front()} * sides.front();
  if (least * static_cast<int64_t>(cells.size()) > options.texels) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "light \"%s\": options.texels = %d, want at least %d for %d maps of the smallest size",
        fitter.light().name,
        options.texels,
        least * static_cast<int64_t>(cells.size()),
        cells.size()));
  }
  std::vector<std::vector<RatedSize>> rated;
  for (const Cell& cell : cells) {
    const ShapeOfCell shape(fitter, cell);
    std::vector<RatedSize> sizes;
    for (const int width : sides) {
      for (const int height : sides) {
        const MapSize size = {width, height};
        if (TexelsOf(size) > options.texels) break;
        sizes.push_back({size, TexelsOf(size), shape.EnergyAt(size)});
      }
    }
    rated.push_back(WorthwhileSizes(std::move(sizes)));
  }
  const std::vector<size_t> chosen = ChooseSizes(rated, options.texels);
  ScratchVector<MapSize> sizes;
  for (size_t k = 0; k < cells.size(); ++k) sizes.push_back(rated[k][chosen[k]].map);
  return sizes;
}

}  // namespace

absl::StatusOr<ScratchVector<MapSize>> SizesOfCells(const CellFitter& fitter,
                                                    const Cells& cells,
                                                    const PlanOptions& options) {
  if (options.each.has_value()) return ScratchVector<MapSize>(cells.size(), *options.each);
  if (options.sizes.has_value()) return AllowedSizesOf(fitter, cells, options);
  const ScratchVector<double> texels =
      DivideTexels(fitter, cells, static_cast<double>(options.texels));
  ScratchVector<MapSize> sizes;
  for (size_t k = 0; k < cells.size(); ++k) {
    sizes.push_back(WholeSize(cells[k].map, texels[k]));
  }
  return sizes;
}

MapSize SizeOfOneMap(const PlanOptions& options) {
  if (options.each.has_value()) return *options.each;
  int side = static_cast<int>(std::sqrt(static_cast<double>(options.texels)));
  if (options.sizes.has_value()) {
    const std::vector<int> sides = AllowedSides(*options.sizes);
    const auto above = std::upper_bound(sides.begin(), sides.end(), side);
    side = above == sides.begin() ? sides.front() : *(above - 1);
  }
  side = std::min(side, kMaxMapSide);
  return {side, side};
}

}  // namespace lightfit
