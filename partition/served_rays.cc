#include "partition/served_rays.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include "absl/types/span.h"
#include "base/stop.h"
#include "geometry/convex_hull.h"
#include "optimizer/energy/footprint.h"
#include "optimizer/readback/needed_surfaces.h"
#include "partition/pixel_rays.h"
#include "partition/ray_leaves.h"

namespace lightfit {

namespace {

// Covered pixels that count as samples are spread out if there are more.
constexpr int64_t kMostFloorSamples = 4096;

// Something that goes into a bin: a covered pixel, or a boundary sample.
struct Item {
  Eigen::Vector3d direction;  // of its ray, unit
  int x = 0, y = 0;           // of a covered pixel
  int boundary = -1;          // index in the view's samples; -1 for a covered pixel

  std::tuple<int, int, int> Key() const { return {boundary, y, x}; }
};

// A cell of the finer cover that no bin of pixels holds.
struct FineItem {
  Eigen::Vector3d direction;  // of its ray, unit
  double distance = 0.0;      // from a point light
  int index = 0;

  int Key() const { return index; }
};

// Beyond, the plane across the middle of a bin stretches too much.
constexpr double kLeastCos = 0.1;

// The cones that bins of pixels cover.
class PixelCones {
 public:
  PixelCones(const ServedRays& rays, const Readback& readback)
      : readback_(readback),
        bin_of_(static_cast<size_t>(readback.width()) * readback.height(), -1) {
    for (size_t i = 0; i < rays.bins.size(); ++i) {
      const RayBin& bin = rays.bins[i];
      for (int at = bin.pixels_begin; at < bin.pixels_end; ++at) {
        bin_of_[readback.Index(rays.pixels[at].x(), rays.pixels[at].y())] = static_cast<int>(i);
      }
      AddSides(bin);
    }
  }

  // The bin of the pixel that a cell of the finer cover lies in, if it holds the ray; else -1.
  int HolderOf(const Eigen::Vector4d& cell, const Eigen::Vector3d& ray) const {
    const FineCover& fine = *readback_.fine_cover;
    const int x = static_cast<int>(cell.x() * readback_.width() / fine.columns);
    const int y = static_cast<int>(cell.y() * readback_.height() / fine.rows);
    const int bin = bin_of_[readback_.Index(x, y)];
    if (bin < 0) return -1;
    const size_t begin = bin == 0 ? 0 : sides_end_[bin - 1], end = sides_end_[bin];
    for (size_t i = begin; i < end; ++i) {
      if (sides_[i].dot(ray) < 0.0) return -1;
    }
    return begin < end ? bin : -1;
  }

 private:
  // None where the hull is not known to be one: ExtremeRays().
  void AddSides(const RayBin& bin) {
    const size_t n = bin.hull.size();
    const bool is_cone =
        n >= 3 && std::all_of(bin.hull.begin(), bin.hull.end(), [&](const auto& ray) {
          return bin.middle.dot(ray) > kLeastCos * ray.norm();
        });
    for (size_t i = 0; is_cone && i < n; ++i) {
      sides_.push_back(bin.hull[i].cross(bin.hull[(i + 1) % n]));
    }
    sides_end_.push_back(sides_.size());
  }

  const Readback& readback_;
  ScratchVector<int> bin_of_;             // by pixel
  ScratchVector<Eigen::Vector3d> sides_;  // of all cones, inward; by bin
  ScratchVector<size_t> sides_end_;
};

class Finder {
 public:
  Finder(const LightView& view, const FitOptions& fit, const ServedRaysOptions& options)
      : view_(view),
        fit_(fit),
        options_(options),
        surfaces_(*view.surfaces),
        metric_(WeightsOf(fit.metric, fit.along_edge_share)),
        pixels_(view, fit.samples) {
    const bool all =
        fit.cover == Cover::kReceivers || (view.cover.ok() && view.cover->nothing_to_cover);
    if (!all) needed_.emplace(surfaces_, *view.light, view.border);
  }

  absl::StatusOr<ServedRays> Find() {
    result_.normalized_from_ray = view_.normalized_from_ray();
    result_.has_single_cover = view_.cover.ok();
    CollectItems();
    if (absl::Status status = CheckStop(*view_.light); !status.ok()) return status;
    if (!items_.empty()) {
      ForEachLeaf(items_,
                  0,
                  items_.size(),
                  MostInLeaf(items_.size(), options_.max_bins),
                  [this](size_t begin, size_t end) { AddBin(begin, end); });
    }
    AddFineCover();
    WeighFloor();
    if (absl::Status status = CheckStop(*view_.light); !status.ok()) return status;
    return std::move(result_);
  }

 private:
  void CollectItems() {
    const Readback& readback = surfaces_.readback;
    result_.distance = DistancesFromLight(surfaces_, *view_.light);
    const uint32_t bit = uint32_t{1} << view_.light->shadow_bit;
    for (int y = 0; y < readback.height() && !StopRequested(); ++y) {
      for (int x = 0; x < readback.width(); ++x) {
        const size_t pixel = readback.Index(x, y);
        if (needed_.has_value() && (needed_->words()[pixel] & bit) == 0) continue;
        if (!surfaces_.affine_depth.IsSurface(readback.depth[pixel])) continue;
        const double d = surfaces_.affine_depth.At(x, y, readback.depth[pixel]);
        items_.push_back({pixels_.RayOf(x + 0.5, y + 0.5, d).normalized(), x, y, -1});
      }
    }
    result_.num_covered = static_cast<int64_t>(items_.size());
    floor_stride_ = 1;
    while (result_.num_covered > kMostFloorSamples * floor_stride_ * floor_stride_) ++floor_stride_;
    for (size_t i = 0; i < view_.samples.size(); ++i) {
      items_.push_back({view_.samples.At(i).X.normalized(), 0, 0, static_cast<int>(i)});
    }
  }

  void AddBin(size_t begin, size_t end) {
    RayBin bin;
    bin.samples_begin = static_cast<int>(result_.samples.size());
    bin.pixels_begin = static_cast<int>(result_.pixels.size());
    bin.middle = Eigen::Vector3d::Zero();
    ScratchVector<Eigen::Vector3d> rays;
    for (size_t i = begin; i < end; ++i) {
      const Item& item = items_[i];
      bin.middle += item.direction;
      if (item.boundary >= 0) {
        AddSample(view_.samples.At(item.boundary), /*is_boundary=*/true);
        ++result_.num_boundary;
        continue;
      }
      result_.pixels.push_back({item.x, item.y});
      Widen(DistanceOf(item), &bin.distance);
      ++bin.num_covered;
      AddCovered(item, &rays);
    }
    bin.middle.normalize();
    bin.samples_end = static_cast<int>(result_.samples.size());
    bin.pixels_end = static_cast<int>(result_.pixels.size());
    if (!rays.empty()) bin.hull = ExtremeRays(rays, bin.middle);
    result_.bins.push_back(std::move(bin));
  }

  // Widens the distances of the bins that hold cells already, and adds bins of the other cells.
  void AddFineCover() {
    const ScratchVector<FineSurfaces> fine = FineSurfacesServed(view_, fit_);
    if (fine.empty()) return;
    const PixelCones cones(result_, surfaces_.readback);
    ScratchVector<FineItem> items;
    for (const FineSurfaces& layer : fine) {
      const Matrix34d ray_from_screen = result_.normalized_from_ray * layer.ray_from_screen;
      layer.ForEach([&](const Eigen::Vector4d& cell) {
        const Eigen::Vector3d direction = (ray_from_screen * cell).normalized();
        const Eigen::Vector3d world = (layer.surfaces.world_from_screen * cell).hnormalized();
        const double distance = DistanceFromLight(*view_.light, world);
        Widen(distance, &result_.distance);
        result_.has_single_cover = result_.has_single_cover && direction.z() > 0.0;
        const int holder = cones.HolderOf(cell, direction);
        if (holder >= 0) {
          Widen(distance, &result_.bins[holder].distance);
        } else {
          items.push_back({direction, distance, static_cast<int>(items.size())});
        }
      });
    }
    if (items.empty()) return;
    // However few there are: they may lie far apart.
    const auto max_bins = static_cast<size_t>(options_.max_fine_bins);
    ForEachLeaf(items,
                0,
                items.size(),
                (items.size() + max_bins - 1) / max_bins,
                [&](size_t begin, size_t end) {
                  AddFineBin(absl::MakeConstSpan(items).subspan(begin, end - begin));
                });
  }

  void AddFineBin(absl::Span<const FineItem> items) {
    RayBin bin;
    bin.samples_begin = bin.samples_end = static_cast<int>(result_.samples.size());
    bin.pixels_begin = bin.pixels_end = static_cast<int>(result_.pixels.size());
    bin.middle = Eigen::Vector3d::Zero();
    ScratchVector<Eigen::Vector3d> rays;
    for (const FineItem& item : items) {
      bin.middle += item.direction;
      rays.push_back(item.direction);
      Widen(item.distance, &bin.distance);
    }
    bin.middle.normalize();
    bin.hull = ExtremeRays(rays, bin.middle);
    result_.bins.push_back(std::move(bin));
  }

  static void Widen(double distance, DepthRange* range) {
    range->near = std::min(range->near, distance);
    range->far = std::max(range->far, distance);
  }

  // From the light, of a covered pixel.
  double DistanceOf(const Item& item) const {
    const double depth = surfaces_.readback.depth[surfaces_.readback.Index(item.x, item.y)];
    const double d = surfaces_.affine_depth.At(item.x, item.y, depth);
    const Eigen::Vector4d screen(item.x + 0.5, item.y + 0.5, d, 1.0);
    const Eigen::Vector3d world = (surfaces_.world_from_screen * screen).hnormalized();
    return (world - view_.light->position).norm();
  }

  // The rays of a covered pixel's corners, and its sample.
  void AddCovered(const Item& item, ScratchVector<Eigen::Vector3d>* rays) {
    const std::optional<DepthGradient> plane = pixels_.PlaneAt(item.x, item.y);
    pixels_.AddCorners(item.x, item.y, plane, options_.corner, rays);
    if (!plane.has_value()) return;
    const bool counts = item.x % floor_stride_ == 0 && item.y % floor_stride_ == 0;
    if (!counts || !pixels_.ShowsShadows(item.x, item.y, *plane)) return;
    // math.md (11), (1)
    Sample sample;
    const Eigen::Matrix<double, 3, 4>& ray_from_screen = pixels_.ray_from_screen();
    sample.X = pixels_.RayOf(item.x + 0.5, item.y + 0.5, plane->d);
    const Eigen::Vector3d T1 = ray_from_screen.col(0) + plane->d_x * ray_from_screen.col(2);
    const Eigen::Vector3d T2 = ray_from_screen.col(1) + plane->d_y * ray_from_screen.col(2);
    const double V = sample.X.dot(T1.cross(T2));
    sample.D.row(0) = T2.cross(sample.X) / V;
    sample.D.row(1) = sample.X.cross(T1) / V;
    if (!sample.D.allFinite()) return;
    sample.edge_normal.setZero();
    AddSample(sample, /*is_boundary=*/false);
  }

  void AddSample(const Sample& sample, bool is_boundary) {
    result_.samples.push_back(
        {sample.X, ToSymmetricVector(MetricTensor(sample, metric_)), sample.weight, is_boundary});
  }

  void WeighFloor() {
    double boundary_weight = 0.0;
    int64_t num_floor = 0;
    for (const RaySample& sample : result_.samples) {
      if (sample.is_boundary) {
        boundary_weight += sample.weight;
      } else {
        ++num_floor;
      }
    }
    if (num_floor == 0) return;
    const double weight = boundary_weight > 0.0 ? options_.floor_share * boundary_weight /
                                                      static_cast<double>(num_floor)
                                                : 1.0;
    for (RaySample& sample : result_.samples) {
      if (!sample.is_boundary) sample.weight = weight;
    }
  }

  const LightView& view_;
  const FitOptions& fit_;
  const ServedRaysOptions& options_;
  const Surfaces& surfaces_;
  MetricWeights metric_;
  PixelRays pixels_;
  std::optional<NeededSurfaces> needed_;  // nothing: all surfaces
  int floor_stride_ = 1;
  ScratchVector<Item> items_;
  ServedRays result_;
};

}  // namespace

ScratchVector<Eigen::Vector3d> ExtremeRays(const ScratchVector<Eigen::Vector3d>& rays,
                                           const Eigen::Vector3d& middle) {
  const Eigen::Matrix3d frame = FrameAlong(middle);
  ScratchVector<Eigen::Vector2d> points;
  for (const Eigen::Vector3d& ray : rays) {
    const Eigen::Vector3d in_frame = frame * ray;
    if (!(in_frame.z() > kLeastCos * ray.norm())) return rays;
    points.push_back(in_frame.hnormalized());
  }
  ScratchVector<Eigen::Vector3d> hull;
  for (const Eigen::Vector2d& point : ConvexHull(points)) {
    hull.push_back(frame.transpose() * point.homogeneous());
  }
  return hull;
}

ScratchVector<FineSurfaces> FineSurfacesServed(const LightView& view, const FitOptions& fit) {
  const bool covers_all =
      fit.cover == Cover::kReceivers || (view.cover.ok() && view.cover->nothing_to_cover);
  if (covers_all || !fit.use_fine_cover) return {};
  return FindFineSurfaces(*view.surfaces, *view.light, view.border);
}

absl::StatusOr<ServedRays> FindServedRays(const LightView& view,
                                          const FitOptions& fit,
                                          const ServedRaysOptions& options) {
  return Finder(view, fit, options).Find();
}

}  // namespace lightfit
