#include "partition/shipped/clipmap_pages.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "absl/strings/str_format.h"
#include "absl/types/span.h"
#include "methods/view_body.h"
#include "partition/shipped/receiver_pixels.h"

namespace lightfit {

namespace {

// Powers of two that a level may stand for. Beyond them numbers lose their last digits.
constexpr int kMostLevel = 200;
// A page's number on its lattice is a whole number in doubles, and so are sums with it.
constexpr double kMostPageNumber = 0x1p40;
constexpr int64_t kLeastPages = 4;

absl::Status ValidateInput(const Light& light, const ClipmapOptions& options) {
  if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  if (light.kind == Light::Kind::kPoint) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "light \"%s\": pages around the camera are for directional lights. A point light has a "
        "cube map (CubeFaces) or a pair of paraboloids (MakeParaboloidPair)",
        light.name));
  }
  if (options.page_side < 8 || options.page_side > 4096) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "clipmap pages: page_side = %d, want 8 ... 4096 texels", options.page_side));
  }
  if (options.pages_per_side < 4 || options.pages_per_side > 65536 ||
      options.pages_per_side % 2 != 0) {
    return absl::InvalidArgumentError(
        absl::StrFormat("clipmap pages: pages_per_side = %d, want an even number, 4 ... 65536",
                        options.pages_per_side));
  }
  if (options.least_bias < -8 || options.least_bias > 0) {
    return absl::InvalidArgumentError(
        absl::StrFormat("clipmap pages: least_bias = %d, want -8 ... 0", options.least_bias));
  }
  return absl::OkStatus();
}

// The pages that are asked for, or nothing once they are too many.
std::optional<std::vector<MapPage>> PagesAsked(const PagedMap& map,
                                               absl::Span<const Eigen::Vector3d> points,
                                               size_t most) {
  std::set<MapPage> asked;
  std::optional<MapPage> last;  // neighbours mostly ask the same
  for (const Eigen::Vector3d& point : points) {
    const MapPage page = map.AskedBy(point);
    if (last == page) continue;
    last = page;
    asked.insert(page);
    if (asked.size() > most) return std::nullopt;
  }
  return std::vector<MapPage>(asked.begin(), asked.end());
}

// The level from which on one page is as large as all receivers are, whatever its place.
int LevelOfOnePage(absl::Span<const Eigen::Vector3d> points, const PagedMap& map) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector3d& point : points) {
    box.extend(map.plane_from_world * point.homogeneous());
  }
  box.extend(map.eye);  // so that they are in the window
  const double extent = box.sizes().maxCoeff() / map.page_side;
  const int level = extent > 0.0 ? static_cast<int>(std::ceil(std::log2(extent))) : -kMostLevel;
  return std::clamp(level, -kMostLevel, kMostLevel);
}

}  // namespace

MapPage PagedMap::PageAround(int level, const Eigen::Vector2d& at) const {
  for (; level < last_level; ++level) {
    const double page = std::ldexp(page_side, level);
    const Eigen::Array2d number = (at / page).array().floor();
    const Eigen::Array2d middle = (eye / page).array().round();
    const bool is_inside = (number >= middle - 0.5 * pages_per_side).all() &&
                           (number < middle + 0.5 * pages_per_side).all() &&
                           (number.abs() <= kMostPageNumber).all();
    if (is_inside) break;
  }
  const Eigen::Array2d number = (at / std::ldexp(page_side, level))
                                    .array()
                                    .floor()
                                    .max(-kMostPageNumber)
                                    .min(kMostPageNumber);
  return {level, static_cast<int64_t>(number.x()), static_cast<int64_t>(number.y())};
}

MapPage PagedMap::AskedBy(const Eigen::Vector3d& world) const {
  const double pixel = std::max(depth_from_world.dot(world.homogeneous()) * pixel_per_depth,
                                std::numeric_limits<double>::min());
  const double level = std::floor(std::log2(pixel) + level_bias + 0.5);
  return PageAround(static_cast<int>(std::clamp(
                        level, -static_cast<double>(kMostLevel), static_cast<double>(last_level))),
                    plane_from_world * world.homogeneous());
}

PagePlace PagedMap::At(const Eigen::Vector3d& world) const {
  if (pages.empty()) return {};
  const Eigen::Vector2d at = plane_from_world * world.homogeneous();
  MapPage asked = AskedBy(world);
  for (int level = std::max(asked.level, pages.front().level); level <= pages.back().level;
       level = asked.level + 1) {
    asked = PageAround(level, at);
    const auto found = std::lower_bound(pages.begin(), pages.end(), asked);
    if (found == pages.end() || *found != asked) continue;
    PagePlace place;
    place.page = static_cast<int>(found - pages.begin());
    const Eigen::Vector2d corner(static_cast<double>(asked.column), static_cast<double>(asked.row));
    const double side = page_side;
    place.texel = ((at / std::ldexp(1.0, asked.level)) - side * corner)
                      .cwiseMax(0.0)
                      .cwiseMin(std::nextafter(side, 0.0));
    return place;
  }
  return {};
}

TexelRay PagedMap::RayAt(const PagePlace& place) const {
  const MapPage& page = pages[place.page];
  const Eigen::Vector2d corner(static_cast<double>(page.column), static_cast<double>(page.row));
  const Eigen::Vector2d at =
      std::ldexp(1.0, page.level) * (static_cast<double>(page_side) * corner + place.texel);
  return {plane_from_world.leftCols<3>().transpose() * at, direction};
}

int64_t NumTexels(const PagedMap& map) {
  return static_cast<int64_t>(map.pages.size()) * map.page_side * map.page_side;
}

absl::StatusOr<PagedMap> ClipmapPages(const Surfaces& surfaces,
                                      const Light& light,
                                      int64_t max_texels,
                                      const ClipmapOptions& options) {
  if (absl::Status status = ValidateInput(light, options); !status.ok()) return status;
  const int64_t page_texels = int64_t{options.page_side} * options.page_side;
  const int64_t pool = max_texels / page_texels;
  if (pool < kLeastPages) {
    return absl::InvalidArgumentError(
        absl::StrFormat("light \"%s\": max_texels = %d, want at least %d: %d pages of %dx%d",
                        light.name,
                        max_texels,
                        kLeastPages * page_texels,
                        kLeastPages,
                        options.page_side,
                        options.page_side));
  }
  std::vector<Eigen::Vector3d> points;
  ForEachReceiverPixel(surfaces, [&points](const ReceiverPixel& pixel) {
    points.insert(points.end(), pixel.points.begin(), pixel.points.end());
  });
  if (absl::Status status = CheckStop(light); !status.ok()) return status;

  const Camera& camera = surfaces.readback.camera;
  PagedMap map;
  map.light_name = light.name;
  map.page_side = options.page_side;
  map.pages_per_side = options.pages_per_side;
  map.plane_from_world = RayFromWorld(light).topRows<2>();
  map.direction = light.direction.stableNormalized();
  if (!camera.orthographic) map.depth_from_world = camera.camera_from_world.row(2);
  map.pixel_per_depth =
      1.0 / std::sqrt(std::abs(camera.screen_from_camera.topLeftCorner<2, 2>().determinant()));
  map.eye = map.plane_from_world * EyePosition(camera).homogeneous();
  map.last_level = LevelOfOnePage(points, map);

  // Down from where all ask the last level, by whole levels while the pages fit, and then by
  // eighths.
  const auto fits = [&](double bias) {
    map.level_bias = bias;
    std::optional<std::vector<MapPage>> pages = PagesAsked(map, points, static_cast<size_t>(pool));
    if (!pages.has_value()) return false;
    map.pages = *std::move(pages);
    return true;
  };
  double finest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& point : points) {
    finest = std::min(finest, map.depth_from_world.dot(point.homogeneous()) * map.pixel_per_depth);
  }
  constexpr double kStep = 0.125;
  double bias = std::max(
      map.last_level - std::floor(std::log2(std::max(finest, std::numeric_limits<double>::min()))),
      static_cast<double>(options.least_bias));
  if (!fits(bias)) {
    return absl::InternalError(absl::StrFormat(
        "light \"%s\": receivers ask for more than %d pages of the last level; please report this",
        light.name,
        kLeastPages));
  }
  while (bias > options.least_bias && fits(bias - 1.0)) {
    bias -= 1.0;
    if (absl::Status status = CheckStop(light); !status.ok()) return status;
  }
  while (bias > options.least_bias && fits(bias - kStep)) bias -= kStep;
  map.level_bias = bias;
  return map;
}

}  // namespace lightfit
