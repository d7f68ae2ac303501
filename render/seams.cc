#include "render/seams.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "optimizer/figures/pixel_footprint.h"
#include "optimizer/readback/edge_normals.h"
#include "render/readback_image.h"

namespace lightfit {

namespace {

constexpr int kEdgeWindow = 2;  // pixels, SampleOptions::edge_window's default

// Everything that the seams of an image have in common.
class SeamFinder {
 public:
  SeamFinder(const SurfaceImage& image,
             absl::Span<const Lighting> truth,
             const Light& light,
             const ReadbackImage& readback,
             const PlanLookUp& look_up,
             std::vector<PixelFootprints> footprints)
      : image_(image),
        truth_(truth),
        look_up_(look_up),
        footprints_(std::move(footprints)),
        readback_(readback.View()),
        normals_(readback_, footprints_[0].affine_depth(), light.shadow_bit, kEdgeWindow) {
    asked_.assign(truth.size(), -1);
    for (size_t i = 0; i < truth.size(); ++i) {
      if (IsJudged(truth[i])) asked_[i] = look_up.At(image.pixels[i].position).map;
    }
  }

  SeamFinder(const SeamFinder&) = delete;
  SeamFinder& operator=(const SeamFinder&) = delete;

  std::vector<Seam> Found() const {
    std::vector<Seam> seams;
    const int width = image_.camera.width, height = image_.camera.height;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        if (x + 1 < width) Add(x, y, x + 1, y, &seams);
        if (y + 1 < height) Add(x, y, x, y + 1, &seams);
      }
    }
    return seams;
  }

 private:
  // Logarithms of the ratios at one pixel.
  struct Ratios {
    double footprint = 0.0, area = 0.0, across = 0.0;
  };

  void Add(int x, int y, int other_x, int other_y, std::vector<Seam>* seams) const {
    Seam seam;
    seam.pixel = IndexOf(x, y);
    seam.neighbour = IndexOf(other_x, other_y);
    seam.map = asked_[seam.pixel];
    seam.neighbour_map = asked_[seam.neighbour];
    if (seam.map < 0 || seam.neighbour_map < 0 || seam.map == seam.neighbour_map) return;
    const Eigen::Vector2d normal = normals_.At(x, y), other_normal = normals_.At(other_x, other_y);
    const std::optional<Ratios> here = RatiosAt(x, y, normal, seam),
                                there = RatiosAt(other_x, other_y, other_normal, seam);
    if (!here.has_value() || !there.has_value()) return;
    seam.is_by_density =
        IsAskable(seam.map, seam.neighbour) && IsAskable(seam.neighbour_map, seam.pixel);
    seam.is_at_edge = (IsNextToEdge(x, y) || IsNextToEdge(other_x, other_y)) && !normal.isZero() &&
                      !other_normal.isZero();
    seam.footprint = std::exp(0.5 * (here->footprint + there->footprint));
    seam.area = std::exp(0.5 * (here->area + there->area));
    if (seam.is_at_edge) seam.across = std::exp(0.5 * (here->across + there->across));
    seams->push_back(seam);
  }

  std::optional<Ratios> RatiosAt(int x,
                                 int y,
                                 const Eigen::Vector2d& normal,
                                 const Seam& seam) const {
    const auto a = footprints_[seam.map].At(x, y), b = footprints_[seam.neighbour_map].At(x, y);
    if (!a.has_value() || !b.has_value() || a->is_behind || b->is_behind) return std::nullopt;
    const Eigen::Matrix2d &J_a = a->J_screen_map, &J_b = b->J_screen_map;
    Ratios ratios;
    ratios.footprint = std::log(J_b.norm() / J_a.norm());
    ratios.area = std::log(std::abs(J_b.determinant() / J_a.determinant()));
    if (!normal.isZero()) {
      ratios.across =
          std::log((J_b.transpose() * normal).norm() / (J_a.transpose() * normal).norm());
    }
    const bool is_finite = std::isfinite(ratios.footprint) && std::isfinite(ratios.area) &&
                           std::isfinite(ratios.across);
    return is_finite ? std::optional<Ratios>(ratios) : std::nullopt;
  }

  bool IsAskable(int map, int32_t pixel) const {
    Eigen::Vector2d texel;
    return look_up_.IsAskable(map, image_.pixels[pixel].position, &texel);
  }

  // Whether the shadow begins or ends between the pixel and one of its four neighbours.
  bool IsNextToEdge(int x, int y) const {
    constexpr std::array<std::array<int, 2>, 4> kSides = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
    const Lighting own = truth_[IndexOf(x, y)];
    return std::any_of(kSides.begin(), kSides.end(), [&](const std::array<int, 2>& side) {
      const int other_x = x + side[0], other_y = y + side[1];
      if (other_x < 0 || other_x >= image_.camera.width) return false;
      if (other_y < 0 || other_y >= image_.camera.height) return false;
      const Lighting other = truth_[IndexOf(other_x, other_y)];
      return IsJudged(other) && other != own;
    });
  }

  int32_t IndexOf(int x, int y) const { return y * image_.camera.width + x; }

  const SurfaceImage& image_;
  absl::Span<const Lighting> truth_;
  const PlanLookUp& look_up_;
  std::vector<PixelFootprints> footprints_;  // of each map
  Readback readback_;
  EdgeNormals normals_;     // refer to the two above
  std::vector<int> asked_;  // by each pixel: a map, or -1
};

SeamJump JumpOf(std::vector<double> ratios) {
  SeamJump jump;
  if (ratios.empty()) return jump;
  double sum = 0.0;
  for (double& ratio : ratios) {
    ratio = std::max(ratio, 1.0 / ratio);
    sum += std::log(ratio);
  }
  jump.mean = std::exp(sum / static_cast<double>(ratios.size()));
  const size_t rank = static_cast<size_t>(std::ceil(0.99 * static_cast<double>(ratios.size()))) - 1;
  std::nth_element(ratios.begin(), ratios.begin() + static_cast<ptrdiff_t>(rank), ratios.end());
  jump.p99 = ratios[rank];
  return jump;
}

SeamJumps JumpsOf(absl::Span<const Seam> seams, bool by_density_alone) {
  SeamJumps jumps;
  std::vector<double> footprint, area, across;
  for (const Seam& seam : seams) {
    if (by_density_alone && !seam.is_by_density) continue;
    footprint.push_back(seam.footprint);
    area.push_back(seam.area);
    if (seam.is_at_edge) across.push_back(seam.across);
  }
  jumps.seams = static_cast<int64_t>(footprint.size());
  jumps.at_edges = static_cast<int64_t>(across.size());
  jumps.footprint = JumpOf(std::move(footprint));
  jumps.area = JumpOf(std::move(area));
  jumps.across = JumpOf(std::move(across));
  return jumps;
}

}  // namespace

absl::StatusOr<std::vector<Seam>> FindSeams(const SurfaceImage& image,
                                            absl::Span<const Lighting> truth,
                                            const Light& light,
                                            const Plan& plan) {
  if (absl::Status status = ValidateLighting(truth, image, light); !status.ok()) return status;
  const absl::StatusOr<PlanLookUp> look_up = PlanLookUp::Create(plan, light);
  if (!look_up.ok()) return look_up.status();
  ReadbackImage readback = ReadbackOf(image);
  AddShadow(truth, light.shadow_bit, &readback);
  SampleOptions options;
  options.use_outlines = false;  // neighbours must be of one surface
  std::vector<PixelFootprints> footprints;
  for (const PlanMap& map : plan.maps) {
    absl::StatusOr<PixelFootprints> of_map =
        PixelFootprints::Create(readback.View(), light, map.map_from_world, options);
    if (!of_map.ok()) return of_map.status();
    footprints.push_back(*std::move(of_map));
  }
  return SeamFinder(image, truth, light, readback, *look_up, std::move(footprints)).Found();
}

SeamStatistics StatisticsOf(absl::Span<const Seam> seams) {
  return {JumpsOf(seams, false), JumpsOf(seams, true)};
}

}  // namespace lightfit
