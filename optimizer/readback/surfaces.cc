#include "optimizer/readback/surfaces.h"

#include <Eigen/LU>
#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <optional>

#include "absl/strings/str_format.h"
#include "base/stop.h"
#include "geometry/affine_depth.h"
#include "optimizer/readback/background.h"
#include "optimizer/readback/kernels.h"

namespace lightfit {

namespace {

std::atomic<int64_t> num_surfaces_found = 0;

absl::Status NoReceiversError(const Readback& readback, int64_t num_invalid, int64_t num_pixels) {
  if (num_invalid == 0) {
    const float background = readback.background.value_or(kBackgroundDepth);
    return absl::InvalidArgumentError(absl::StrFormat(
        "readback.depth: all %d pixels are background%s, want at least one surface (depth kind %s)",
        num_pixels,
        background < kBackgroundDepth ? absl::StrFormat(", which begins at %.9g", background) : "",
        DepthKindName(readback.depth_kind)));
  }
  return absl::InvalidArgumentError(absl::StrFormat(
      "readback.depth: no surface; %d of %d pixels are NaN, negative or out of range for depth "
      "kind "
      "%s (the first value is %g). Is this the depth channel, and is its depth kind right?",
      num_invalid,
      num_pixels,
      DepthKindName(readback.depth_kind),
      readback.depth[0]));
}

// The shadow bits, 0 where there is no surface: what renderers write there means nothing.
ScratchVector<uint32_t> BitsOfSurfaces(const Readback& readback, const AffineDepth& affine_depth) {
  const auto surface_min = static_cast<float>(affine_depth.surface_min());
  const auto surface_max = static_cast<float>(affine_depth.surface_max());
  const size_t num_pixels = readback.depth.size();
  const float* depth = readback.depth.data();
  const uint32_t* bits = readback.shadow_bits.data();
  ScratchVector<uint32_t> words(num_pixels);
  for (size_t i = 0; i < num_pixels; ++i) {
    const uint32_t is_surface = depth[i] > surface_min && depth[i] < surface_max ? ~0U : 0U;
    words[i] = bits[i] & is_surface;
  }
  return words;
}

// At one pixel, the lights whose bit differs from a neighbour's, and from one that is a surface:
// the outline of a shadowed thing against the background is no edge of a shadow.
struct Differences {
  uint32_t from_any = 0, from_surface = 0;
};

Differences DifferencesAt(const Surfaces& surfaces, const uint32_t* words, int x, int y) {
  const int width = surfaces.readback.width();
  const size_t at = surfaces.readback.Index(x, y);
  Differences differences;
  for (const size_t neighbour : {at - 1, at + 1, at - width, at + width}) {
    const uint32_t differing = words[at] ^ words[neighbour];
    differences.from_any |= differing;
    if (differing != 0 && surfaces.affine_depth.IsSurface(surfaces.readback.depth[neighbour])) {
      differences.from_surface |= differing;
    }
  }
  return differences;
}

}  // namespace

bool DepthGradientAt(const Readback& readback,
                     const AffineDepth& affine_depth,
                     const SampleOptions& options,
                     int x,
                     int y,
                     DepthGradient* gradient) {
  const int width = readback.width();
  if (x < 1 || y < 1 || x + 1 >= width || y + 1 >= readback.height()) return false;
  const float* centre = readback.depth.data() + static_cast<size_t>(y) * width + x;
  if (!affine_depth.IsSurface(*centre)) return false;
  const double d = affine_depth.At(x, y, *centre);
  // How much deeper the pixel `steps` away along (dx, dy) is than this one.
  const auto rise = [&](int dx, int dy, int steps) -> std::optional<double> {
    const int px = x + steps * dx, py = y + steps * dy;
    if (px < 0 || py < 0 || px >= width || py >= readback.height()) return std::nullopt;
    const float depth = readback.depth[static_cast<size_t>(py) * width + px];
    if (!affine_depth.IsSurface(depth)) return std::nullopt;
    return affine_depth.At(px, py, depth) - d;
  };
  const double noise = options.depth_noise * std::abs(d);
  bool is_one_sided = false;
  const auto derivative = [&](int dx, int dy) -> std::optional<double> {
    const std::optional<double> back = rise(dx, dy, -1), ahead = rise(dx, dy, 1);
    if (back.has_value() && ahead.has_value()) {
      const double second = std::abs(*back + *ahead);
      const double first = std::max(std::abs(*back), std::abs(*ahead));
      const bool bends = second > options.max_depth_bend * first && second > noise;
      if (!bends) return 0.5 * (*ahead - *back);
    }
    if (!options.use_outlines) return std::nullopt;
    is_one_sided = true;
    if (!back.has_value() || !ahead.has_value()) {
      return back.has_value() ? std::optional<double>(-*back) : ahead;
    }
    // The side that goes on as it begins is the surface's own; else the one nearer in depth.
    const std::optional<double> back_twice = rise(dx, dy, -2), ahead_twice = rise(dx, dy, 2);
    double back_misfit = std::abs(*back), ahead_misfit = std::abs(*ahead);
    if (back_twice.has_value() && ahead_twice.has_value()) {
      back_misfit = std::abs(*back_twice - 2.0 * *back);
      ahead_misfit = std::abs(*ahead_twice - 2.0 * *ahead);
    }
    return back_misfit < ahead_misfit ? -*back : *ahead;
  };
  const std::optional<double> d_x = derivative(1, 0);
  const std::optional<double> d_y = derivative(0, 1);
  if (!d_x.has_value() || !d_y.has_value()) return false;
  *gradient = {d, *d_x, *d_y, is_one_sided};
  return true;
}

Eigen::Vector3d SurfaceNormal(const Eigen::Matrix4d& screen_from_world,
                              bool orthographic,
                              int x,
                              int y,
                              const DepthGradient& gradient) {
  // The plane d = d0 + d_x (x - x0) + d_y (y - y0), as a covector on (x, y, d, 1) and then on world
  // points. Its value at the eye is negative for a perspective camera (whose eye is at d =
  // infinity) and positive for an orthographic one (d = -infinity).
  const Eigen::Vector4d plane_in_screen(
      gradient.d_x,
      gradient.d_y,
      -1.0,
      gradient.d - gradient.d_x * (x + 0.5) - gradient.d_y * (y + 0.5));
  const Eigen::Vector3d normal = screen_from_world.leftCols<3>().transpose() * plane_in_screen;
  return (orthographic ? 1.0 : -1.0) * normal.normalized();
}

absl::StatusOr<Surfaces> FindSurfaces(const Readback& given,
                                      uint32_t light_mask,
                                      const SampleOptions& options) {
  num_surfaces_found.fetch_add(1, std::memory_order_relaxed);
  if (absl::Status status = ValidateReadback(given); !status.ok()) return status;
  Readback readback = given;
  SettleBackground(light_mask, &readback);
  SampleOptions with_outlines = options;
  with_outlines.use_outlines = true;
  constexpr char kSubject[] = "readback";
  const int width = readback.width();
  const int height = readback.height();
  Surfaces surfaces(readback, options);
  const AffineDepth& affine_depth = surfaces.affine_depth;
  surfaces.tiles = BuildDepthTiles(readback, affine_depth, SurfaceFilter());
  if (absl::Status status = CheckStop(kSubject); !status.ok()) return status;
  const int64_t num_receivers = surfaces.tiles.num_surfaces;
  const int64_t num_pixels = static_cast<int64_t>(width) * height;
  const int64_t num_invalid = num_pixels - num_receivers - surfaces.tiles.num_background;
  if (num_receivers == 0) return NoReceiversError(readback, num_invalid, num_pixels);
  for (SampleCounts& counts : surfaces.counts) {
    counts.receivers = num_receivers;
    counts.invalid_depth = num_invalid;
  }

  const Eigen::Matrix4d screen_from_world = surfaces.world_from_screen.inverse();
  const Eigen::Vector3d eye =
      surfaces.world_from_screen.block<3, 1>(0, 2) /
      (readback.camera.orthographic ? 1.0 : surfaces.world_from_screen(3, 2));
  ScratchVector<int32_t> columns(width);
  ScratchVector<uint32_t> bits_of_surfaces;
  if (num_receivers < num_pixels) bits_of_surfaces = BitsOfSurfaces(readback, affine_depth);
  const uint32_t* words =
      bits_of_surfaces.empty() ? readback.shadow_bits.data() : bits_of_surfaces.data();
  for (int y = 1; y + 1 < height; ++y) {
    if (absl::Status status = CheckStop(kSubject); !status.ok()) return status;
    const uint32_t* row = words + static_cast<size_t>(y) * width;
    const size_t num_columns =
        internal::ScanBoundary(row, width, width, light_mask, columns.data());
    for (size_t i = 0; i < num_columns; ++i) {
      BoundaryPixel pixel;
      const int x = columns[i];
      pixel.x = x;
      pixel.y = y;
      const Differences differences = DifferencesAt(surfaces, words, x, y);
      pixel.lights = light_mask & differences.from_surface;
      DepthGradient gradient;
      const bool is_surface =
          affine_depth.IsSurface(readback.depth[static_cast<size_t>(y) * width + x]);
      const bool continues =
          is_surface && pixel.lights != 0 &&
          DepthGradientAt(readback, affine_depth, with_outlines, x, y, &gradient);
      for (uint32_t bits = light_mask & differences.from_any; bits != 0; bits &= bits - 1) {
        SampleCounts& counts = surfaces.counts[std::countr_zero(bits)];
        ++counts.candidates;
        if (!is_surface || (pixel.lights & bits & -bits) == 0) {
          ++counts.background;
        } else if (!continues) {
          ++counts.discontinuity;
        }
      }
      if (!continues) continue;
      pixel.d = gradient.d;
      pixel.d_x = gradient.d_x;
      pixel.d_y = gradient.d_y;
      const Eigen::Vector4d position =
          surfaces.world_from_screen * Eigen::Vector4d(x + 0.5, y + 0.5, gradient.d, 1.0);
      pixel.position = position.head<3>() / position.w();
      pixel.normal = SurfaceNormal(screen_from_world, readback.camera.orthographic, x, y, gradient);
      const Eigen::Vector3d to_eye = readback.camera.orthographic
                                         ? Eigen::Vector3d(-eye)
                                         : Eigen::Vector3d(eye - pixel.position);
      pixel.eye_along_normal = pixel.normal.dot(to_eye);
      pixel.eye_distance = to_eye.norm();
      pixel.is_outline = gradient.is_one_sided;
      surfaces.boundary.push_back(pixel);
    }
  }
  return surfaces;
}

int64_t NumSurfacesFound() { return num_surfaces_found.load(std::memory_order_relaxed); }

}  // namespace lightfit
