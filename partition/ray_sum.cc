#include "partition/ray_sum.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "absl/strings/str_format.h"
#include "base/stop.h"
#include "geometry/light_map.h"
#include "geometry/ray_maps.h"
#include "optimizer/energy/metric.h"
#include "optimizer/energy/summary.h"
#include "partition/finish_plan.h"
#include "partition/plan_cells.h"
#include "partition/ray_leaves.h"

namespace lightfit {

namespace {

DepthRange Union(DepthRange a, DepthRange b) {
  return {std::min(a.near, b.near), std::max(a.far, b.far)};
}

// Samples in rays X' = N X.
class SampleTransform {
 public:
  explicit SampleTransform(const Eigen::Matrix3d& new_from_old)
      : new_from_old_(new_from_old),
        new_from_old_tensor_(SymmetricCongruence(new_from_old.inverse().transpose())) {}

  RaySample operator()(const RaySample& sample) const {
    RaySample result = sample;
    result.X = new_from_old_ * sample.X;
    result.G = new_from_old_tensor_ * sample.G;
    return result;
  }

 private:
  Eigen::Matrix3d new_from_old_;
  Eigen::Matrix<double, 6, 6> new_from_old_tensor_;
};

// Coordinates in which all covered rays lie in front, or nothing where they surround the light.
std::optional<Eigen::Matrix3d> NormalizedFromRay(const RaySum& sum) {
  ServedRays all;
  RayBin& bin = all.bins.emplace_back();
  for (const RaySum::CoveredBin& covered : sum.covered) {
    bin.hull.insert(bin.hull.end(), covered.hull.begin(), covered.hull.end());
  }
  const int only[] = {0};
  const std::optional<CellCover> cover = CoverBins(all, only, sum.light);
  if (!cover.has_value()) return std::nullopt;
  return cover->normalized_from_ray;
}

// A covered bin, or a sample.
struct Item {
  Eigen::Vector3d direction;
  int index = 0;  // in RaySum::covered, or after them in RaySum::samples

  int Key() const { return index; }
};

class Binner {
 public:
  explicit Binner(const RaySum& sum) : sum_(sum) {
    const std::optional<Eigen::Matrix3d> normalized = NormalizedFromRay(sum);
    result_.has_single_cover = normalized.has_value();
    if (normalized.has_value()) result_.normalized_from_ray = *normalized;
    result_.distance = sum.distance;
  }

  ServedRays Bin(int max_bins) && {
    const Eigen::Matrix3d& N = result_.normalized_from_ray;
    ScratchVector<Item> items;
    for (const RaySum::CoveredBin& covered : sum_.covered) {
      Eigen::Vector3d middle = Eigen::Vector3d::Zero();
      for (const Eigen::Vector3d& ray : covered.hull) middle += (N * ray).normalized();
      items.push_back({middle.normalized(), static_cast<int>(items.size())});
    }
    for (const RaySample& sample : sum_.samples) {
      items.push_back({(N * sample.X).normalized(), static_cast<int>(items.size())});
    }
    if (!items.empty()) {
      const SampleTransform transform(N);
      ForEachLeaf(items,
                  0,
                  items.size(),
                  MostInLeaf(items.size(), max_bins),
                  [&](size_t begin, size_t end) {
                    AddBin(absl::MakeConstSpan(items).subspan(begin, end - begin), transform);
                  });
    }
    return std::move(result_);
  }

 private:
  void AddBin(absl::Span<const Item> items, const SampleTransform& transform) {
    RayBin bin;
    bin.middle = Eigen::Vector3d::Zero();
    bin.samples_begin = static_cast<int>(result_.samples.size());
    ScratchVector<Eigen::Vector3d> rays;
    for (const Item& item : items) {
      bin.middle += item.direction;
      const auto num_covered = static_cast<int>(sum_.covered.size());
      if (item.index < num_covered) {
        const RaySum::CoveredBin& covered = sum_.covered[item.index];
        for (const Eigen::Vector3d& ray : covered.hull) {
          rays.push_back(result_.normalized_from_ray * ray);
        }
        bin.distance = Union(bin.distance, covered.distance);
        bin.num_covered += covered.num_covered;
        continue;
      }
      result_.samples.push_back(transform(sum_.samples[item.index - num_covered]));
      result_.num_boundary += result_.samples.back().is_boundary ? 1 : 0;
    }
    bin.middle.normalize();
    bin.samples_end = static_cast<int>(result_.samples.size());
    if (!rays.empty()) bin.hull = ExtremeRays(rays, bin.middle);
    result_.num_covered += bin.num_covered;
    result_.bins.push_back(std::move(bin));
  }

  const RaySum& sum_;
  ServedRays result_;
};

// How w grows along a light-space ray: with the distance from a point light; for a directional one
// rays have third component 1.
double LengthOf(const Eigen::Vector3d& light_ray, const Light& light) {
  return light.kind == Light::Kind::kPoint ? light_ray.norm() : light_ray.z();
}

// The range that the depth row of a map is laid over, and the least w there.
struct Depths {
  DepthRange range;
  double w_min = 0.0;
};

// Over all bins that may ask the map, those that it overlaps whatever cell they are in; and, as
// lit receivers must not be clipped, over whatever else may lie behind its texels.
Depths DepthsOf(const MapOfCell& map, const ServedRays& rays, const Light& light) {
  constexpr double kBetweenPixels = 0.01;  // room for what no pixel's centre showed
  constexpr double kMostStretch = 16.0;    // as optimizer/fit_matrix.cc
  const Eigen::Matrix3d light_from_ray = rays.normalized_from_ray.inverse();
  const Eigen::Matrix3d ray_from_map = map.map_from_ray.inverse();
  const double width = map.size.width, height = map.size.height;
  // Of rays of length 1 in the rectangle: least at a corner, as w is concave along every segment.
  double w_corners = std::numeric_limits<double>::infinity();
  for (const double u : {0.0, width}) {
    for (const double v : {0.0, height}) {
      const Eigen::Vector3d ray = light_from_ray * (ray_from_map * Eigen::Vector3d(u, v, 1.0));
      const double length = LengthOf(ray, light);
      if (length > 0.0) w_corners = std::min(w_corners, 1.0 / length);
    }
  }
  double w_least = std::numeric_limits<double>::infinity();
  double near = std::numeric_limits<double>::infinity();
  for (const RayBin& bin : rays.bins) {
    Eigen::AlignedBox2d box;
    double w_bin = std::numeric_limits<double>::infinity();
    bool reaches_behind = false;  // then it may lie anywhere in the map
    for (const Eigen::Vector3d& ray : bin.hull) {
      const Eigen::Vector3d at = map.map_from_ray * ray;
      reaches_behind = reaches_behind || !(at.z() > 0.0);
      if (!(at.z() > 0.0)) continue;
      box.extend(at.hnormalized());
      w_bin = std::min(w_bin, at.z() / LengthOf(light_from_ray * ray, light));
    }
    if (box.isEmpty()) continue;
    if (!reaches_behind && (!(box.min().x() < width && box.max().x() > 0.0) ||
                            !(box.min().y() < height && box.max().y() > 0.0))) {
      continue;
    }
    if (std::isfinite(w_corners)) w_bin = reaches_behind ? w_corners : std::max(w_bin, w_corners);
    w_least = std::min(w_least, w_bin);
    near = std::min(near, w_bin * bin.distance.near);
  }
  if (light.kind == Light::Kind::kPoint) {
    const Eigen::Vector3d axis =
        rays.normalized_from_ray.transpose() * map.map_from_ray.row(2).transpose();
    near /= 1.0 + kBetweenPixels;
    return {{near, axis.norm() * rays.distance.far * (1.0 + kBetweenPixels)}, near};
  }
  const double room = kBetweenPixels * (rays.distance.far - rays.distance.near);
  const double w_min = std::max(std::min(w_least, w_corners), w_least / kMostStretch);
  return {{rays.distance.near - room, rays.distance.far + room}, w_min / (1.0 + kBetweenPixels)};
}

// Energies of the boundary samples, in the maps that they ask.
void MeasureMaps(const ServedRays& rays,
                 absl::Span<const RayMap> ray_maps,
                 const PlanOptions& options,
                 LightPlan* plan) {
  ScratchVector<MapExtents> extents;
  for (const RayMap& map : ray_maps) extents.push_back(MapExtents(map.map_from_ray));
  for (const RaySample& sample : rays.samples) {
    if (!sample.is_boundary) continue;
    const int asked = DensestAt(ray_maps, sample.X, options.guard_texels);
    if (asked < 0) continue;
    const Extents of = extents[asked].Of(sample);
    const double squared = of.along_u + of.along_v;
    const double energy = sample.weight * (IsL1(options.fit.metric) ? std::sqrt(squared) : squared);
    Figures& figures = plan->maps[asked].figures;
    figures.energy += energy;
    ++figures.samples.used;
    plan->energy += energy;
  }
}

}  // namespace

RaySum SumOfRays(const ServedRays& rays, const LightView& view, int most_samples) {
  const Eigen::Matrix3d light_from_ray = rays.normalized_from_ray.inverse();
  RaySum sum;
  sum.light = *view.light;
  sum.border = view.border;
  sum.facing = view.facing();
  sum.num_frames = 1;
  sum.distance = rays.distance;
  for (const RayBin& bin : rays.bins) {
    if (bin.hull.empty()) continue;
    RaySum::CoveredBin& covered = sum.covered.emplace_back();
    for (const Eigen::Vector3d& ray : bin.hull) covered.hull.push_back(light_from_ray * ray);
    covered.num_covered = bin.num_covered;
    covered.distance = bin.distance;
  }
  const auto num_samples = static_cast<int>(rays.samples.size());
  const int stride = std::max(1, (num_samples + most_samples - 1) / std::max(1, most_samples));
  const int num_taken = (num_samples + stride - 1) / stride;
  const SampleTransform transform(light_from_ray);
  for (int i = 0; i < num_samples; i += stride) {
    sum.samples.push_back(transform(rays.samples[i]));
    sum.samples.back().weight *= static_cast<double>(num_samples) / num_taken;
  }
  return sum;
}

absl::Status AddToSum(const RaySum& other, RaySum* sum) {
  const Light& a = sum->light;
  const Light& b = other.light;
  if (a.name != b.name || a.kind != b.kind || a.position != b.position ||
      a.direction != b.direction) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "light \"%s\": want the same light as in the sum, \"%s\", in the same place",
        b.name,
        a.name));
  }
  if (sum->border != other.border) {
    return absl::InvalidArgumentError(
        absl::StrFormat("light \"%s\": its border is %s, want %s, that of the sum",
                        b.name,
                        BorderName(other.border),
                        BorderName(sum->border)));
  }
  if (other.facing == FacingSource::kGuessed) sum->facing = FacingSource::kGuessed;
  sum->num_frames += other.num_frames;
  sum->distance = Union(sum->distance, other.distance);
  sum->covered.insert(sum->covered.end(), other.covered.begin(), other.covered.end());
  sum->samples.insert(sum->samples.end(), other.samples.begin(), other.samples.end());
  return absl::OkStatus();
}

ServedRays RaysOfSum(const RaySum& sum, int max_bins) { return Binner(sum).Bin(max_bins); }

absl::StatusOr<LightPlan> FitRaySum(const RaySum& sum, const PlanOptions& options) {
  if (absl::Status status = ValidatePlanOptions(options); !status.ok()) return status;
  if (absl::Status status = ValidateLight(sum.light); !status.ok()) return status;
  const ServedRays rays = RaysOfSum(sum);
  const PlanCells plan_cells(rays, sum.light, options.fit, options);
  const absl::StatusOr<Cells> cells = plan_cells.Of(options.max_maps);
  if (!cells.ok()) return cells.status();
  const absl::StatusOr<ScratchVector<MapOfCell>> maps =
      MapsOfCells(plan_cells.fitter(), *cells, options);
  if (!maps.ok()) return maps.status();
  LightPlan plan;
  plan.light_name = sum.light.name;
  plan.border = sum.border;
  plan.facing = sum.facing;
  ScratchVector<RayMap> ray_maps;
  for (const MapOfCell& map : *maps) {
    const Depths depths = DepthsOf(map, rays, sum.light);
    const absl::StatusOr<Eigen::Matrix4d> map_from_world =
        FinishMap(map.map_from_ray * rays.normalized_from_ray,
                  RayFromWorld(sum.light),
                  sum.light,
                  depths.range,
                  depths.w_min);
    if (!map_from_world.ok()) return map_from_world.status();
    LightMatrix& matrix = plan.maps.emplace_back();
    matrix.light_name = sum.light.name;
    matrix.map = map.size;
    matrix.border = sum.border;
    matrix.facing = sum.facing;
    matrix.map_from_world = *map_from_world;
    ray_maps.push_back(RayMap(map.map_from_ray, map.size.width, map.size.height));
  }
  if (plan.maps.empty()) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "light \"%s\": %d texels are too few for any map", sum.light.name, options.texels));
  }
  MeasureMaps(rays, ray_maps, options, &plan);
  if (absl::Status status = CheckStop(sum.light); !status.ok()) return status;
  return plan;
}

}  // namespace lightfit
