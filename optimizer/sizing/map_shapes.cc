#include "optimizer/sizing/map_shapes.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_format.h"
#include "base/stop.h"
#include "optimizer/energy/reweighting.h"
#include "optimizer/fit.h"
#include "optimizer/fit_matrix.h"
#include "optimizer/search/axis_search.h"
#include "optimizer/sizing/enough_samples.h"

namespace lightfit {

namespace {

constexpr int kNumAspects = 9;       // 1, sqrt 2, 2 ... 16
constexpr int kMaxAlternations = 8;  // three or four are usual
constexpr double kLeastGain = 1e-5;  // of the energy
constexpr double kLeastReweightingGain = 1e-3;
constexpr double kMaxAspect = 64.0;
constexpr double kSide = 8192.0;  // texels; so large that whole texels do not matter

double BestProduct(const MapShape& shape) { return shape.along_u * shape.along_v; }

// Of kSide^2 texels.
MapSize MapOfAspect(double aspect) {
  return {static_cast<int>(std::lround(kSide * std::sqrt(aspect))),
          static_cast<int>(std::lround(kSide / std::sqrt(aspect)))};
}

// The shape that is best for maps of this size.
absl::StatusOr<MapShape> FitShape(const Summary& summary,
                                  const Light& light,
                                  MapSize map,
                                  const FitOptions& options) {
  const absl::StatusOr<SearchResult> result = SearchAxis({light, summary}, map, options);
  if (!result.ok()) return result.status();
  const Eigen::Matrix3d& map_from_ray = result->fit.map_from_ray;
  const Eigen::Matrix<double, 3, 2> r = map_from_ray.inverse().leftCols<2>();
  const Eigen::Matrix3d metric = summary.tensor.AtAxis(map_from_ray.row(2));
  const double inner_width = map.width - 2.0 * options.margin_texels;
  const double inner_height = map.height - 2.0 * options.margin_texels;
  const double along_u = inner_width * inner_width * r.col(0).dot(metric * r.col(0));
  const double along_v = inner_height * inner_height * r.col(1).dot(metric * r.col(1));
  return MapShape{std::max(along_u, along_v), std::min(along_u, along_v)};
}

}  // namespace

double MapShapes::Energy(double width, double height) const {
  const double longer = std::max(width, height) - 2.0 * margin_texels;
  const double shorter = std::min(width, height) - 2.0 * margin_texels;
  double least = std::numeric_limits<double>::infinity();
  if (!(shorter > 0.0)) return least;
  for (const MapShape& shape : shapes) {
    const double energy = shape.along_u / (longer * longer) + shape.along_v / (shorter * shorter);
    least = std::min(least, energy);
  }
  return footprint_sum > 0.0 ? std::sqrt(least * footprint_sum) : least;
}

double MapShapes::BestAspect() const {
  const auto best =
      std::min_element(shapes.begin(), shapes.end(), [](const MapShape& a, const MapShape& b) {
        return BestProduct(a) < BestProduct(b);
      });
  return std::min(std::sqrt(best->along_u / best->along_v), kMaxAspect);
}

MapSize MapShapes::BestMap() const { return MapOfAspect(BestAspect()); }

double MapShapes::UnitEnergy() const {
  double least = std::numeric_limits<double>::infinity();
  for (const MapShape& shape : shapes) {
    least = std::min(least, 2.0 * std::sqrt(BestProduct(shape)));
  }
  return footprint_sum > 0.0 ? std::sqrt(least * footprint_sum) : least;
}

absl::StatusOr<MapShapes> FindMapShapes(const Summary& summary,
                                        const Light& light,
                                        const FitOptions& options) {
  // Checks all that a fit checks, once.
  const absl::StatusOr<LightMatrix> square = Fit(summary, light, MapOfAspect(1.0), options);
  if (!square.ok()) return square.status();
  if (absl::Status status = CheckEnoughSamples(light, summary.counts, options); !status.ok()) {
    return status;
  }
  MapShapes result;
  result.margin_texels = options.margin_texels;
  result.footprint_sum = summary.footprint_sum;
  const auto add = [&](double aspect) -> absl::Status {
    const absl::StatusOr<MapShape> shape = FitShape(summary, light, MapOfAspect(aspect), options);
    if (!shape.ok()) return shape.status();
    if (!(BestProduct(*shape) > 0.0) || !std::isfinite(BestProduct(*shape))) {
      return absl::FailedPreconditionError(
          absl::StrFormat("light \"%s\": its %d samples have no footprint at any size of the map, "
                          "so that no size is better than another; leave the light out",
                          light.name,
                          summary.counts.used));
    }
    result.shapes.push_back(*shape);
    return absl::OkStatus();
  };
  for (int i = 0; i < kNumAspects; ++i) {
    if (absl::Status status = add(std::exp2(0.5 * i)); !status.ok()) return status;
  }
  for (int i = 0; i < kMaxAlternations; ++i) {
    const double before = result.UnitEnergy();
    if (absl::Status status = add(result.BestAspect()); !status.ok()) return status;
    if (!(result.UnitEnergy() < before * (1.0 - kLeastGain))) break;
  }
  return result;
}

std::vector<RatedSize> RateSizes(const MapShapes& shapes,
                                 double weight,
                                 const MapSizeRules& rules) {
  constexpr size_t kMaxUnsorted = 1 << 14;  // a millisecond or two
  const std::vector<int> sides = AllowedSides(rules);
  std::vector<RatedSize> sizes;
  for (const int height : sides) {
    for (const int width : sides) {
      if (width < height) continue;
      const MapSize map = {width, height};
      sizes.push_back({map, TexelsOf(map), weight * shapes.Energy(width, height)});
    }
    if (StopRequested()) break;
    if (sizes.size() > kMaxUnsorted) sizes = WorthwhileSizes(std::move(sizes));
  }
  return WorthwhileSizes(std::move(sizes));
}

absl::StatusOr<Summary> SummarizeForAnyAspect(const LightView& view, const FitOptions& options) {
  const Light& light = *view.light;
  absl::StatusOr<Summary> summary = Summarize(view, options);
  if (!summary.ok() || !IsL1(options.metric) || summary->counts.used == 0) return summary;
  absl::StatusOr<MapShapes> shapes = FindMapShapes(*summary, light, options);
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  if (!shapes.ok()) return summary;
  BestOfRounds<Summary> best(kLeastReweightingGain);
  best.Offer(shapes->UnitEnergy(), *summary);
  for (int round = 0; round < options.reweighting_rounds; ++round) {
    const absl::StatusOr<LightMatrix> fit =
        FitMatrix({light, best.Best()}, shapes->BestMap(), options);
    if (!fit.ok()) break;
    absl::StatusOr<Summary> next = SummarizeInMap(view, fit->map_from_world, options);
    if (!next.ok()) break;
    shapes = FindMapShapes(*next, light, options);
    if (!shapes.ok() || !best.Offer(shapes->UnitEnergy(), *std::move(next))) break;
  }
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  return std::move(best).Best();
}

absl::StatusOr<Summary> SummarizeForAnyAspect(const Readback& readback,
                                              const Light& light,
                                              const FitOptions& options) {
  return AskView(readback, light, options, [&](const LightView& view) {
    return SummarizeForAnyAspect(view, options);
  });
}

}  // namespace lightfit
