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

class Finder {
 public:
  Finder(const LightView& view, const FitOptions& fit, const ServedRaysOptions& options)
      : view_(view),
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
      const double distance = DistanceOf(item);
      bin.distance.near = std::min(bin.distance.near, distance);
      bin.distance.far = std::max(bin.distance.far, distance);
      ++bin.num_covered;
      AddCovered(item, &rays);
    }
    bin.middle.normalize();
    bin.samples_end = static_cast<int>(result_.samples.size());
    bin.pixels_end = static_cast<int>(result_.pixels.size());
    if (!rays.empty()) bin.hull = ExtremeRays(rays, bin.middle);
    result_.bins.push_back(std::move(bin));
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
  constexpr double kLeastCos = 0.1;  // beyond, the plane across the middle stretches too much
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

absl::StatusOr<ServedRays> FindServedRays(const LightView& view,
                                          const FitOptions& fit,
                                          const ServedRaysOptions& options) {
  return Finder(view, fit, options).Find();
}

}  // namespace lightfit
