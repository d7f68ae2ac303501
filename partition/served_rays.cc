#include "partition/served_rays.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "base/stop.h"
#include "geometry/convex_hull.h"
#include "optimizer/energy/footprint.h"
#include "optimizer/figures/forecast_places.h"
#include "optimizer/readback/covered_surfaces.h"
#include "optimizer/readback/needed_surfaces.h"

namespace lightfit {

namespace {

// Covered pixels that count as samples are spread out if there are more.
constexpr int64_t kMostFloorSamples = 4096;
constexpr int kLeastInBin = 8;

// Something that goes into a bin: a covered pixel, or a boundary sample.
struct Item {
  Eigen::Vector3d direction;  // of its ray, unit
  int x = 0, y = 0;           // of a covered pixel
  int boundary = -1;          // index in the view's samples; -1 for a covered pixel
};

// A pixel's own plane as its depth tells it, or nothing.
class PixelPlanes {
 public:
  PixelPlanes(const LightView& view, const FitOptions& fit)
      : surfaces_(*view.surfaces),
        options_(fit.samples),
        screen_from_world_(surfaces_.world_from_screen.inverse()),
        light_position_(view.light->HomogeneousPosition()) {
    options_.use_outlines = true;
  }

  // In the image's outermost rows and columns, which have no differences of their own, that of the
  // pixel beside it, if it is on the same plane.
  std::optional<DepthGradient> At(int x, int y) const {
    const Readback& readback = surfaces_.readback;
    const int inner_x = std::clamp(x, 1, readback.width() - 2);
    const int inner_y = std::clamp(y, 1, readback.height() - 2);
    DepthGradient gradient;
    if (!DepthGradientAt(readback, surfaces_.affine_depth, options_, inner_x, inner_y, &gradient)) {
      return std::nullopt;
    }
    if (inner_x == x && inner_y == y) return gradient;
    const double d = surfaces_.affine_depth.At(x, y, readback.depth[readback.Index(x, y)]);
    if (!IsOnSurface(x, y, d, {inner_x, inner_y, gradient})) return std::nullopt;
    gradient.d = d;
    return gradient;
  }

  // Whether shadows can be seen on it: neither edge-on nor turned away, from light or eye.
  bool ShowsShadows(int x, int y, const DepthGradient& gradient) const {
    const bool orthographic = surfaces_.readback.camera.orthographic;
    const Eigen::Vector3d normal = SurfaceNormal(screen_from_world_, orthographic, x, y, gradient);
    const Eigen::Vector4d screen(x + 0.5, y + 0.5, gradient.d, 1.0);
    const Eigen::Vector3d position = (surfaces_.world_from_screen * screen).hnormalized();
    const Eigen::Vector3d to_light = light_position_.head<3>() - light_position_.w() * position;
    return normal.dot(to_light) > options_.min_cos_light * to_light.norm();
  }

 private:
  const Surfaces& surfaces_;
  SampleOptions options_;
  Eigen::Matrix4d screen_from_world_;
  Eigen::Vector4d light_position_;
};

// Sorts items into a tree of halves and calls visit(begin, end) for each leaf, left to right.
template <typename Visitor>
void ForEachLeaf(ScratchVector<Item>& items,
                 size_t begin,
                 size_t end,
                 size_t most_in_leaf,
                 const Visitor& visit) {
  if (end - begin <= most_in_leaf) {
    visit(begin, end);
    return;
  }
  Eigen::AlignedBox3d box;
  for (size_t i = begin; i < end; ++i) box.extend(items[i].direction);
  int along = 0;
  box.sizes().maxCoeff(&along);
  const size_t middle = begin + (end - begin) / 2;
  std::nth_element(items.begin() + begin,
                   items.begin() + middle,
                   items.begin() + end,
                   [along](const Item& a, const Item& b) {
                     // The same order on every machine.
                     const auto key = [along](const Item& item) {
                       return std::tuple(item.direction(along), item.boundary, item.y, item.x);
                     };
                     return key(a) < key(b);
                   });
  ForEachLeaf(items, begin, middle, most_in_leaf, visit);
  ForEachLeaf(items, middle, end, most_in_leaf, visit);
}

// The extreme ones of rays that are close together.
ScratchVector<Eigen::Vector3d> HullOf(const ScratchVector<Eigen::Vector3d>& rays,
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

class Finder {
 public:
  Finder(const LightView& view, const FitOptions& fit, const ServedRaysOptions& options)
      : view_(view),
        options_(options),
        surfaces_(*view.surfaces),
        metric_(WeightsOf(fit.metric, fit.along_edge_share)),
        planes_(view, fit),
        ray_from_screen_(view.normalized_from_ray() * RayFromWorld(*view.light) *
                         surfaces_.world_from_screen) {
    const bool all =
        fit.cover == Cover::kReceivers || (view.cover.ok() && view.cover->nothing_to_cover);
    if (!all) needed_.emplace(surfaces_, *view.light, view.border);
  }

  absl::StatusOr<ServedRays> Find() {
    result_.normalized_from_ray = view_.normalized_from_ray();
    result_.has_single_cover = view_.cover.ok();
    CollectItems();
    if (absl::Status status = CheckStop(*view_.light); !status.ok()) return status;
    const size_t most_in_leaf =
        std::max<size_t>(kLeastInBin, (items_.size() + options_.max_bins - 1) / options_.max_bins);
    if (!items_.empty()) {
      ForEachLeaf(items_, 0, items_.size(), most_in_leaf, [this](size_t begin, size_t end) {
        AddBin(begin, end);
      });
    }
    WeighFloor();
    if (absl::Status status = CheckStop(*view_.light); !status.ok()) return status;
    return std::move(result_);
  }

 private:
  Eigen::Vector3d RayOf(double x, double y, double d) const {
    return ray_from_screen_ * Eigen::Vector4d(x, y, d, 1.0);
  }

  void CollectItems() {
    const Readback& readback = surfaces_.readback;
    const Eigen::Vector4d light = view_.light->HomogeneousPosition();
    DepthRange& distance = result_.distance;
    distance = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    ForEachTile(surfaces_.tiles.grids[0], [&](const DepthTile& tile) {
      for (const Eigen::Vector4d& corner : Corners(tile)) {
        const Eigen::Vector3d world = (surfaces_.world_from_screen * corner).hnormalized();
        const double at =
            light.w() > 0.0 ? (world - light.head<3>()).norm() : -light.head<3>().dot(world);
        distance = {std::min(distance.near, at), std::max(distance.far, at)};
      }
    });
    const uint32_t bit = uint32_t{1} << view_.light->shadow_bit;
    for (int y = 0; y < readback.height() && !StopRequested(); ++y) {
      for (int x = 0; x < readback.width(); ++x) {
        const size_t pixel = readback.Index(x, y);
        if (needed_.has_value() && (needed_->words()[pixel] & bit) == 0) continue;
        if (!surfaces_.affine_depth.IsSurface(readback.depth[pixel])) continue;
        const double d = surfaces_.affine_depth.At(x, y, readback.depth[pixel]);
        items_.push_back({RayOf(x + 0.5, y + 0.5, d).normalized(), x, y, -1});
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
    bin.middle = Eigen::Vector3d::Zero();
    ScratchVector<Eigen::Vector3d> rays;
    for (size_t i = begin; i < end; ++i) {
      const Item& item = items_[i];
      bin.middle += item.direction;
      if (item.boundary >= 0) {
        AddSample(view_.samples.At(item.boundary));
        ++result_.num_boundary;
        continue;
      }
      const double distance = DistanceOf(item);
      bin.nearest = bin.num_covered == 0 ? distance : std::min(bin.nearest, distance);
      ++bin.num_covered;
      AddCovered(item, &rays);
    }
    bin.middle.normalize();
    bin.samples_end = static_cast<int>(result_.samples.size());
    if (!rays.empty()) bin.hull = HullOf(rays, bin.middle);
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
    const double x = item.x + 0.5, y = item.y + 0.5;
    const std::optional<DepthGradient> plane = planes_.At(item.x, item.y);
    if (!plane.has_value()) {
      const double depth = surfaces_.readback.depth[surfaces_.readback.Index(item.x, item.y)];
      rays->push_back(RayOf(x, y, surfaces_.affine_depth.At(item.x, item.y, depth)));
      return;
    }
    const bool orthographic = surfaces_.readback.camera.orthographic;
    const double h = options_.corner;
    for (const double dx : {-h, h}) {
      for (const double dy : {-h, h}) {
        double d = plane->d + dx * plane->d_x + dy * plane->d_y;
        // A plane nearly edge-on to the eye reaches its horizon within the pixel.
        constexpr double kMostChange = 2.0;
        if (!orthographic) d = std::clamp(d, plane->d / kMostChange, plane->d * kMostChange);
        rays->push_back(RayOf(x + dx, y + dy, d));
      }
    }
    const bool counts = item.x % floor_stride_ == 0 && item.y % floor_stride_ == 0;
    if (!counts || !planes_.ShowsShadows(item.x, item.y, *plane)) return;
    // math.md (11), (1)
    Sample sample;
    sample.X = RayOf(x, y, plane->d);
    const Eigen::Vector3d T1 = ray_from_screen_.col(0) + plane->d_x * ray_from_screen_.col(2);
    const Eigen::Vector3d T2 = ray_from_screen_.col(1) + plane->d_y * ray_from_screen_.col(2);
    const double V = sample.X.dot(T1.cross(T2));
    sample.D.row(0) = T2.cross(sample.X) / V;
    sample.D.row(1) = sample.X.cross(T1) / V;
    if (!sample.D.allFinite()) return;
    sample.weight = -1.0;  // told from the others until they are weighed
    sample.edge_normal.setZero();
    AddSample(sample);
  }

  void AddSample(const Sample& sample) {
    result_.samples.push_back(
        {sample.X, ToSymmetricVector(MetricTensor(sample, metric_)), sample.weight});
  }

  void WeighFloor() {
    double boundary_weight = 0.0;
    int64_t num_floor = 0;
    for (const RaySample& sample : result_.samples) {
      if (sample.weight < 0.0) {
        ++num_floor;
      } else {
        boundary_weight += sample.weight;
      }
    }
    if (num_floor == 0) return;
    const double weight = boundary_weight > 0.0 ? options_.floor_share * boundary_weight /
                                                      static_cast<double>(num_floor)
                                                : 1.0;
    for (RaySample& sample : result_.samples) {
      if (sample.weight < 0.0) sample.weight = weight;
    }
  }

  const LightView& view_;
  const ServedRaysOptions& options_;
  const Surfaces& surfaces_;
  MetricWeights metric_;
  PixelPlanes planes_;
  Matrix34d ray_from_screen_;
  std::optional<NeededSurfaces> needed_;  // nothing: all surfaces
  int floor_stride_ = 1;
  ScratchVector<Item> items_;
  ServedRays result_;
};

}  // namespace

absl::StatusOr<ServedRays> FindServedRays(const LightView& view,
                                          const FitOptions& fit,
                                          const ServedRaysOptions& options) {
  return Finder(view, fit, options).Find();
}

}  // namespace lightfit
