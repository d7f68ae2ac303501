#include "partition/tracking/held_bins.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace lightfit {

namespace {

class Divider {
 public:
  Divider(const ServedRays& rays,
          const PixelRays& pixels,
          absl::Span<const RayMap> maps,
          double guard_texels,
          double corner)
      : rays_(rays), pixels_(pixels), maps_(maps), guard_texels_(guard_texels), corner_(corner) {
    ServedRays& to = result_.rays;
    to.normalized_from_ray = rays.normalized_from_ray;
    to.has_single_cover = rays.has_single_cover;
    to.num_boundary = rays.num_boundary;
    to.num_covered = rays.num_covered;
    to.distance = rays.distance;
    to.bins.reserve(rays.bins.size());
    to.samples.reserve(rays.samples.size());
    to.pixels.reserve(rays.pixels.size());
  }

  HeldBins Divide() && {
    for (const RayBin& bin : rays_.bins) {
      const uint32_t held_by = bin.hull.empty() ? HoldersOf({&bin.middle, 1}) : HoldersOf(bin.hull);
      if (held_by != 0 || bin.hull.empty() || bin.num_covered == 1) {
        AddWhole(bin, held_by);
      } else {
        TakeApart(bin);
      }
    }
    return std::move(result_);
  }

 private:
  // A part of a bin that was taken apart.
  struct Part {
    int asked;
    uint32_t held_by;
    ScratchVector<Eigen::Vector3d> rays;
    ScratchVector<Eigen::Vector2i> pixels;
    ScratchVector<int> samples;
  };

  uint32_t HoldersOf(absl::Span<const Eigen::Vector3d> rays) const {
    uint32_t holders = 0;
    for (size_t k = 0; k < maps_.size(); ++k) {
      const bool holds = std::all_of(rays.begin(), rays.end(), [&](const Eigen::Vector3d& ray) {
        return maps_[k].Holds(ray, guard_texels_ - kHeldTolerance);
      });
      if (holds) holders |= uint32_t{1} << k;
    }
    return holders;
  }

  // Where depth differs much within a pixel its centre need not be between its corners, and may be
  // behind a map that holds those.
  int DensestOf(uint32_t holders, const Eigen::Vector3d& middle) const {
    const int asked = DensestAt(maps_, middle, [&](int k) { return (holders >> k & 1) != 0; });
    return asked < 0 && holders != 0 ? std::countr_zero(holders) : asked;
  }

  void AddWhole(const RayBin& bin, uint32_t held_by) {
    ServedRays& to = result_.rays;
    RayBin added = bin;
    added.samples_begin = static_cast<int>(to.samples.size());
    to.samples.insert(to.samples.end(),
                      rays_.samples.begin() + bin.samples_begin,
                      rays_.samples.begin() + bin.samples_end);
    added.samples_end = static_cast<int>(to.samples.size());
    added.pixels_begin = static_cast<int>(to.pixels.size());
    to.pixels.insert(to.pixels.end(),
                     rays_.pixels.begin() + bin.pixels_begin,
                     rays_.pixels.begin() + bin.pixels_end);
    added.pixels_end = static_cast<int>(to.pixels.size());
    to.bins.push_back(std::move(added));
    result_.held_by.push_back(held_by);
    result_.asked.push_back(DensestOf(held_by, bin.middle));
  }

  void TakeApart(const RayBin& bin) {
    ScratchVector<Part> parts;
    for (int i = bin.pixels_begin; i < bin.pixels_end; ++i) {
      const Eigen::Vector2i& pixel = rays_.pixels[i];
      ScratchVector<Eigen::Vector3d> corners;
      pixels_.AddCorners(
          pixel.x(), pixel.y(), pixels_.PlaneAt(pixel.x(), pixel.y()), corner_, &corners);
      const uint32_t held_by = HoldersOf(corners);
      const int asked = DensestOf(held_by, corners.front());
      auto part = std::find_if(
          parts.begin(), parts.end(), [asked](const Part& p) { return p.asked == asked; });
      if (part == parts.end()) part = parts.insert(parts.end(), {asked, held_by, {}, {}, {}});
      part->held_by &= held_by;
      part->rays.insert(part->rays.end(), corners.begin(), corners.end());
      part->pixels.push_back(pixel);
    }
    // Samples go with the pixels that ask the same map.
    for (int i = bin.samples_begin; i < bin.samples_end; ++i) {
      const int asked = DensestAt(maps_, rays_.samples[i].X, guard_texels_);
      const auto part = std::find_if(
          parts.begin(), parts.end(), [asked](const Part& p) { return p.asked == asked; });
      (part == parts.end() ? parts.front() : *part).samples.push_back(i);
    }
    for (const Part& part : parts) AddPart(bin, part);
  }

  void AddPart(const RayBin& bin, const Part& part) {
    ServedRays& to = result_.rays;
    RayBin added;
    added.middle = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& ray : part.rays) added.middle += ray.normalized();
    added.middle.normalize();
    added.hull = ExtremeRays(part.rays, added.middle);
    added.distance = bin.distance;
    added.num_covered = static_cast<int>(part.pixels.size());
    added.samples_begin = static_cast<int>(to.samples.size());
    for (const int i : part.samples) to.samples.push_back(rays_.samples[i]);
    added.samples_end = static_cast<int>(to.samples.size());
    added.pixels_begin = static_cast<int>(to.pixels.size());
    to.pixels.insert(to.pixels.end(), part.pixels.begin(), part.pixels.end());
    added.pixels_end = static_cast<int>(to.pixels.size());
    to.bins.push_back(std::move(added));
    result_.held_by.push_back(part.held_by);
    result_.asked.push_back(part.asked);
  }

  const ServedRays& rays_;
  const PixelRays& pixels_;
  absl::Span<const RayMap> maps_;
  double guard_texels_;
  double corner_;
  HeldBins result_;
};

}  // namespace

ScratchVector<int> HeldBins::BinsOf(int k) const {
  ScratchVector<int> bins;
  for (size_t i = 0; i < asked.size(); ++i) {
    if (asked[i] == k) bins.push_back(static_cast<int>(i));
  }
  return bins;
}

ScratchVector<int> HeldBins::BinsIn(int k) const {
  ScratchVector<int> bins;
  for (size_t i = 0; i < held_by.size(); ++i) {
    if ((held_by[i] >> k & 1) != 0) bins.push_back(static_cast<int>(i));
  }
  return bins;
}

ScratchVector<int> HeldBins::BinsOnlyIn(int k) const {
  ScratchVector<int> bins;
  for (size_t i = 0; i < held_by.size(); ++i) {
    if (held_by[i] == uint32_t{1} << k && !rays.bins[i].hull.empty()) {
      bins.push_back(static_cast<int>(i));
    }
  }
  return bins;
}

ScratchVector<int> HeldBins::BinsOutside() const {
  ScratchVector<int> bins;
  for (size_t i = 0; i < held_by.size(); ++i) {
    if (held_by[i] == 0 && !rays.bins[i].hull.empty()) bins.push_back(static_cast<int>(i));
  }
  return bins;
}

bool HeldBins::HoldsAll() const { return BinsOutside().empty(); }

HeldBins FindHeldBins(const ServedRays& rays,
                      const PixelRays& pixels,
                      absl::Span<const RayMap> maps,
                      double guard_texels,
                      double corner) {
  return Divider(rays, pixels, maps, guard_texels, corner).Divide();
}

}  // namespace lightfit
