#include "optimizer/readback/shadow_check.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "geometry/affine_depth.h"
#include "optimizer/readback/sample_options.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

namespace {

// Pixels that are looked at, over the whole image.
constexpr double kNumPlaces = 3000.0;

// Cosines: surfaces at a smaller angle to the light, or to the eye, go through their own
// neighbours.
constexpr double kLeastCosLight = 0.15;
constexpr double kLeastCosEye = 0.1;

// Pixels near the first are its own surface.
constexpr int kFirstStep = 3;

// The way from a surface to the light on the screen: (x, y, d), straight.
struct Way {
  Eigen::Vector3d begin, end;
};

class DepthWalk {
 public:
  DepthWalk(const Readback& readback, const SampleOptions& options)
      : readback_(readback),
        affine_depth_(AffineDepthOf(readback)),
        options_(options),
        nearer_sign_(readback.camera.orthographic ? -1.0 : 1.0) {}

  const AffineDepth& affine_depth() const { return affine_depth_; }

  // Whether the way goes through a surface that is seen on both sides of the place.
  bool IsBlocked(const Way& way) const {
    const Eigen::Vector2d across = (way.end - way.begin).head<2>();
    const int major = std::abs(across.x()) >= std::abs(across.y()) ? 0 : 1;
    const double length = std::abs(across[major]);
    if (!(length >= 1.0)) return false;
    const Eigen::Vector3d step = (way.end - way.begin) / length;
    const int sign = step[major] > 0.0 ? 1 : -1;
    const int size = major == 0 ? readback_.width() : readback_.height();
    // Rounding may have put its beginning anywhere.
    if (!(std::abs(way.begin[major]) <= 2.0 * size)) return false;
    int column = static_cast<int>(std::floor(way.begin[major])) + sign * kFirstStep;
    // In front of the surface (> 0) or behind it, at the last four pixels.
    std::array<double, 4> front = {}, depth = {};
    int num_seen = 0;
    for (; column >= 0 && column < size; column += sign) {
      const double steps = std::abs(column + 0.5 - way.begin[major]);
      if (steps > length) return false;
      const Eigen::Vector3d at = way.begin + steps * step;
      const std::optional<double> surface = DepthBetween(column, at[1 - major], major);
      if (!surface.has_value()) {
        num_seen = 0;
        continue;
      }
      std::rotate(front.begin(), front.begin() + 1, front.end());
      std::rotate(depth.begin(), depth.begin() + 1, depth.end());
      front[3] = nearer_sign_ * (at.z() - *surface);
      depth[3] = *surface;
      if (++num_seen >= 4 && Changes(front) && IsSmooth(depth)) return true;
    }
    return false;
  }

 private:
  static bool Changes(const std::array<double, 4>& front) {
    const auto both = [](double a, double b, double sign) { return a * sign > 0 && b * sign > 0; };
    return (both(front[0], front[1], 1.0) && both(front[2], front[3], -1.0)) ||
           (both(front[0], front[1], -1.0) && both(front[2], front[3], 1.0));
  }

  bool IsSmooth(const std::array<double, 4>& depth) const {
    for (int i = 0; i < 2; ++i) {
      const double first = depth[i + 1] - depth[i], second = depth[i + 2] - depth[i + 1];
      const double limit = options_.max_depth_bend * std::max(std::abs(first), std::abs(second)) +
                           options_.depth_noise * std::abs(depth[i + 1]);
      if (!(std::abs(second - first) <= limit)) return false;
    }
    return true;
  }

  // At a pixel's centre along the major axis, and between two of them along the other.
  std::optional<double> DepthBetween(int column, double minor, int major) const {
    const int size = major == 0 ? readback_.height() : readback_.width();
    const double centre = minor - 0.5;
    const int first = static_cast<int>(std::floor(centre));
    if (first < 0 || first + 1 >= size) return std::nullopt;
    const double share = centre - first;
    const std::optional<double> a = DepthAt(column, first, major);
    const std::optional<double> b = DepthAt(column, first + 1, major);
    if (!a.has_value() || !b.has_value()) return std::nullopt;
    constexpr double kSameSurface = 0.2;  // of the affine depth, from one pixel to the next
    if (std::abs(*a - *b) > kSameSurface * std::max(std::abs(*a), std::abs(*b))) {
      return std::nullopt;
    }
    return (1.0 - share) * *a + share * *b;
  }

  std::optional<double> DepthAt(int column, int row, int major) const {
    const int x = major == 0 ? column : row, y = major == 0 ? row : column;
    const float depth = readback_.depth[readback_.Index(x, y)];
    if (!affine_depth_.IsSurface(depth)) return std::nullopt;
    return affine_depth_.At(x, y, depth);
  }

  const Readback& readback_;
  AffineDepth affine_depth_;
  const SampleOptions& options_;
  double nearer_sign_;
};

// Nothing where the light stands in the way of the eye.
std::optional<Way> WayToLight(const Eigen::Matrix4d& screen_from_world,
                              const Eigen::Vector3d& position,
                              const Eigen::Vector4d& light,
                              double pixels) {
  const Eigen::Vector4d begin = screen_from_world * position.homogeneous();
  const Eigen::Vector4d towards =
      screen_from_world *
      (light.w() != 0.0 ? Eigen::Vector4d(light - position.homogeneous()) : light);
  if (!(begin.w() > 0.0)) return std::nullopt;
  // As far as the way lies in front of the camera; up to the light itself.
  constexpr double kInFront = 0.95;
  double length = towards.w() < 0.0 ? -kInFront * begin.w() / towards.w() : 0.0;
  if (light.w() != 0.0) {
    length = length > 0.0 ? std::min(length, 1.0) : 1.0;
  } else if (length == 0.0) {
    // A sun: until it has crossed the image, or nearly to where it vanishes.
    const double speed = towards.head<2>().norm();
    const double vanishes = towards.w() > 0.0 ? 1e3 * begin.w() / towards.w() : 1e30;
    length = speed > 0.0 ? std::min(2.0 * pixels * begin.w() / speed, vanishes) : vanishes;
  }
  const Eigen::Vector4d end = begin + length * towards;
  if (!(end.w() > 0.0) || !end.allFinite()) return std::nullopt;
  return Way{begin.hnormalized(), end.hnormalized()};
}

}  // namespace

double ShadowCheck::LitBlockedShare() const {
  return num_lit > 0 ? static_cast<double>(num_lit_blocked) / num_lit : 0.0;
}

double ShadowCheck::ShadowedBlockedShare() const {
  return num_shadowed > 0 ? static_cast<double>(num_shadowed_blocked) / num_shadowed : 0.0;
}

ShadowCheck CheckShadows(const Readback& readback, const Light& light) {
  SampleOptions options;
  options.use_outlines = false;
  const DepthWalk walk(readback, options);
  const Eigen::Matrix4d world_from_screen = readback.camera.WorldFromScreen();
  const Eigen::Matrix4d screen_from_world = world_from_screen.inverse();
  const Eigen::Vector4d homogeneous = light.HomogeneousPosition();
  const uint32_t bit = uint32_t{1} << light.shadow_bit;
  const double num_pixels = static_cast<double>(readback.width()) * readback.height();
  const int step = std::max(1, static_cast<int>(std::sqrt(num_pixels / kNumPlaces)));
  ShadowCheck check;
  for (int y = 1 + step / 2; y + 1 < readback.height(); y += step) {
    for (int x = 1 + step / 2; x + 1 < readback.width(); x += step) {
      DepthGradient gradient;
      if (!DepthGradientAt(readback, walk.affine_depth(), options, x, y, &gradient)) continue;
      const Eigen::Vector3d position =
          (world_from_screen * Eigen::Vector4d(x + 0.5, y + 0.5, gradient.d, 1.0)).hnormalized();
      const Eigen::Vector3d normal =
          SurfaceNormal(screen_from_world, readback.camera.orthographic, x, y, gradient);
      const Eigen::Vector3d to_light = homogeneous.head<3>() - homogeneous.w() * position;
      if (!(normal.dot(to_light) >= kLeastCosLight * to_light.norm())) continue;
      const Eigen::Vector3d to_eye =
          readback.camera.orthographic
              ? Eigen::Vector3d(-world_from_screen.block<3, 1>(0, 2))
              : Eigen::Vector3d(world_from_screen.block<3, 1>(0, 2) / world_from_screen(3, 2) -
                                position);
      if (!(normal.dot(to_eye) >= kLeastCosEye * to_eye.norm())) continue;
      const std::optional<Way> way = WayToLight(screen_from_world,
                                                position,
                                                homogeneous,
                                                double{1.0} * readback.width() + readback.height());
      if (!way.has_value()) continue;
      const bool is_shadowed = (readback.shadow_bits[readback.Index(x, y)] & bit) != 0;
      const bool is_blocked = walk.IsBlocked(*way);
      ++(is_shadowed ? check.num_shadowed : check.num_lit);
      if (is_blocked) ++(is_shadowed ? check.num_shadowed_blocked : check.num_lit_blocked);
    }
  }
  return check;
}

ShadowVerdict VerdictOf(const ShadowCheck& check) {
  // Of right read-backs, rendered and ray cast, at most 1.4 % of the lit pixels are blocked, and 29
  // times as many of those in shadow; where fewer than a few are, one may be chance.
  // tests/io/shadow_rates_test.cc has the rates.
  constexpr int kLeastBlocked = 6, kManyBlocked = 15;
  constexpr double kLitBlocked = 0.015, kMostLitBlocked = 0.05;
  constexpr double kTimesInShadow = 5.0, kInverted = 0.1;
  const double lit = check.LitBlockedShare(), shadowed = check.ShadowedBlockedShare();
  if (check.num_lit_blocked < kLeastBlocked || lit < kLitBlocked) return ShadowVerdict::kPlausible;
  if (check.num_shadowed > 0 && shadowed <= kInverted * lit) return ShadowVerdict::kInverted;
  const bool are_many = check.num_lit_blocked >= kManyBlocked && lit >= kMostLitBlocked;
  return are_many || shadowed <= kTimesInShadow * lit ? ShadowVerdict::kOfAnother
                                                      : ShadowVerdict::kPlausible;
}

}  // namespace lightfit
