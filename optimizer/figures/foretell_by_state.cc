#include "optimizer/figures/foretell_by_state.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "base/scratch.h"
#include "base/stop.h"
#include "geometry/affine_depth.h"

namespace lightfit {

namespace {

// Large read-backs are looked at on a grid of about this many pixels.
constexpr int kMostPixels = 1 << 16;
// Places of the texel's centre in each direction, evenly spread.
constexpr int kPlaces = 3;
// A pixel belongs to the surface of another if its depth is off that one's plane by less than this
// share of the difference, or of the slope, or of the depth.
constexpr double kMostBend = 0.3;
constexpr double kDepthTolerance = 1e-3;

// How often a look-up is wrong, by what the read-back shows where its texel's centre lies. Measured
// by ray casting at 750x750, pixel by pixel, over six scenes and rounded: docs/defaults.md.
constexpr double kOtherSide = 0.9;  // the same surface, in the other state
// Dark pixels whose centre lies past a surface that is turned away are wrong where there is light
// behind it, which no read-back shows: these go with the root of the share of surfaces that are
// lit, or of a little where none is in view.
constexpr double kLeastLitShare = 0.01;
constexpr double kDarkAway = 0.4;
constexpr double kDarkAwayFar = 0.06;  // ... seen past the end of this one
constexpr double kDarkLitNear = 0.12;
constexpr double kFarAdjacent = 0.5;  // the other state goes on below the end of this surface
constexpr double kLitLitAdjacent = 0.35, kLitLitJump = 0.16;  // inside another lit thing
constexpr double kLitElseAdjacent = 0.5, kLitElseJump = 0.08;

// Of pixels that face the light although the depth says that they do not: wrong planes. For dark
// ones, too, there must be light behind.
constexpr double kEdgeOn = 0.05, kEdgeOnMost = 0.1;
constexpr double kEdgeOnSide = 180.0;  // pixels of a read-back in which it is kEdgeOn

// What a cover that is as tight as the pixels are apart leaves outside: see OutsideUnseen().
constexpr double kUnseenPixels = 1.6;
constexpr double kUnseenReach = 6.0;  // texels

enum class State : uint8_t { kBackground, kAway, kLit, kDark };

class StateForecast {
 public:
  StateForecast(const Readback& readback,
                const Light& light,
                const PixelFootprints& footprints,
                MapSize map,
                std::optional<Border> border)
      : readback_(readback),
        footprints_(footprints),
        affine_depth_(footprints.affine_depth()),
        map_from_screen_(footprints.map_from_screen()),
        world_from_screen_(footprints.world_from_screen()),
        map_(map),
        needed_(border == Border::kDark  ? State::kLit
                : border == Border::kLit ? State::kDark
                                         : State::kBackground) {
    const uint32_t bit = uint32_t{1} << light.shadow_bit;
    states_.reserve(readback.depth.size());
    int64_t num_lit = 0, num_dark = 0;
    for (size_t i = 0; i < readback.depth.size(); ++i) {
      State state = State::kBackground;
      if (affine_depth_.IsSurface(readback.depth[i])) {
        const bool faces = (readback.facing_bits[i] & bit) != 0;
        const bool is_dark = (readback.shadow_bits[i] & bit) != 0;
        state = !faces ? State::kAway : is_dark ? State::kDark : State::kLit;
        num_lit += state == State::kLit ? 1 : 0;
        num_dark += state == State::kDark ? 1 : 0;
      }
      states_.push_back(state);
    }
    const double lit_share =
        num_lit + num_dark > 0 ? static_cast<double>(num_lit) / (num_lit + num_dark) : 0.0;
    root_of_lit_share_ = std::sqrt(std::max(lit_share, kLeastLitShare));
    const double side = std::sqrt(static_cast<double>(readback.width()) * readback.height());
    edge_on_ = std::clamp(kEdgeOn * side / kEdgeOnSide, kEdgeOn, kEdgeOnMost);
  }

  // The share of wrong pixels among those in row y that are looked at, `stride` apart.
  double SumOfRow(int y, int first, int stride) const {
    double sum = 0.0;
    for (int x = first; x + 1 < readback_.width(); x += stride) {
      const State state = At(x, y);
      if (state == State::kLit || state == State::kDark) sum += WrongAt(x, y, state);
    }
    return sum;
  }

  // A fit covers what its own read-back shows, so that none of it lies outside; things thinner than
  // a pixel do. Where the outermost pixel to cover stands far from the next, as the tip of a shadow
  // does, more of the kind is not seen. In read-back pixels.
  double OutsideUnseen() const {
    constexpr double kFar = std::numeric_limits<double>::infinity();
    if (needed_ == State::kBackground) return 0.0;
    std::array<std::array<double, 2>, 4> gaps;  // by side: the two smallest
    for (auto& side : gaps) side = {kFar, kFar};
    for (int y = 0; y < readback_.height(); ++y) {
      for (int x = 0; x < readback_.width(); ++x) {
        if (At(x, y) != needed_) continue;
        const Eigen::Vector3d map = map_from_screen_ * Screen(x, y);
        if (!(map.z() > 0.0)) continue;
        const double u = map.x() / map.z(), v = map.y() / map.z();
        const double to_side[4] = {u, map_.width - u, v, map_.height - v};
        if (*std::min_element(to_side, to_side + 4) < 0.0) continue;
        for (int i = 0; i < 4; ++i) {
          auto& [least, second] = gaps[i];
          if (to_side[i] < least) {
            second = least;
            least = to_side[i];
          } else {
            second = std::min(second, to_side[i]);
          }
        }
      }
    }
    double pixels = 0.0;
    for (const auto& [least, second] : gaps) {
      if (least < kUnseenReach && second < kFar) {
        pixels += std::clamp((second - least) / std::max(least, 1e-9), 0.0, 1.0);
      }
    }
    return kUnseenPixels * pixels;
  }

 private:
  State At(int x, int y) const { return states_[readback_.Index(x, y)]; }

  double AffineAt(int x, int y) const {
    return affine_depth_.At(x, y, readback_.depth[readback_.Index(x, y)]);
  }

  Eigen::Vector4d Screen(int x, int y) const { return {x + 0.5, y + 0.5, AffineAt(x, y), 1.0}; }

  Eigen::Vector3d World(double column, double row, double d) const {
    return (world_from_screen_ * Eigen::Vector4d(column, row, d, 1.0)).hnormalized();
  }

  double WrongAt(int x, int y, State state) const {
    const Eigen::Vector3d map = map_from_screen_ * Screen(x, y);
    const Eigen::Vector2d texel = map.hnormalized();
    const bool is_inside = map.z() > 0.0 && texel.x() >= 0.0 && texel.y() >= 0.0 &&
                           texel.x() <= map_.width && texel.y() <= map_.height;
    if (!is_inside) return state == needed_ ? 1.0 : 0.0;
    const std::optional<PixelFootprint> pixel = footprints_.At(x, y);
    const double edge_on = edge_on_ * (state == State::kDark ? root_of_lit_share_ : 1.0);
    if (!pixel.has_value()) return edge_on;

    // Places of the pixel's plane are linear in their texel.
    const DepthGradient& plane = pixel->gradient;
    Eigen::Matrix3d map_from_plane;
    map_from_plane.col(0) = map_from_screen_.col(0) + plane.d_x * map_from_screen_.col(2);
    map_from_plane.col(1) = map_from_screen_.col(1) + plane.d_y * map_from_screen_.col(2);
    map_from_plane.col(2) =
        map_from_screen_.col(3) +
        (plane.d - plane.d_x * (x + 0.5) - plane.d_y * (y + 0.5)) * map_from_screen_.col(2);
    const Eigen::Matrix3d plane_from_map = map_from_plane.inverse();
    if (!plane_from_map.allFinite()) return edge_on;
    double sum = 0.0;
    for (int j = 0; j < kPlaces; ++j) {
      for (int i = 0; i < kPlaces; ++i) {
        const Eigen::Vector2d centre =
            texel + Eigen::Vector2d((i + 0.5) / kPlaces - 0.5, (j + 0.5) / kPlaces - 0.5);
        const Eigen::Vector3d place = plane_from_map * centre.homogeneous();
        // Beyond the plane's horizon nothing of it is seen.
        if (place.z() > 0.0) sum += WrongIfCentred(place.hnormalized(), x, y, state, plane);
      }
    }
    return sum / (kPlaces * kPlaces);
  }

  // How often the look-up is wrong if its texel's centre is at this place of the pixel's plane.
  double WrongIfCentred(
      const Eigen::Vector2d& place, int x, int y, State state, const DepthGradient& plane) const {
    const int width = readback_.width(), height = readback_.height();
    if (!(place.x() >= 0.0 && place.y() >= 0.0 && place.x() <= width && place.y() <= height)) {
      return 0.0;
    }
    const double column = std::clamp(place.x() - 0.5, 0.0, width - 1.0);
    const double row = std::clamp(place.y() - 0.5, 0.0, height - 1.0);
    const int left = std::min(static_cast<int>(column), width - 2);
    const int top = std::min(static_cast<int>(row), height - 2);
    double sum = 0.0;
    for (int j = 0; j < 2; ++j) {
      for (int i = 0; i < 2; ++i) {
        const double weight = (i == 1 ? column - left : 1.0 - (column - left)) *
                              (j == 1 ? row - top : 1.0 - (row - top));
        if (weight > 0.0) sum += weight * RateAt(left + i, top + j, place, x, y, state, plane);
      }
    }
    return sum;
  }

  // The same by what pixel (px, py) beside the place shows.
  double RateAt(int px,
                int py,
                const Eigen::Vector2d& place,
                int x,
                int y,
                State state,
                const DepthGradient& plane) const {
    const State there = At(px, py);
    if (there == State::kBackground) return 0.0;
    const bool is_dark = state == State::kDark;
    const double d = AffineAt(px, py);
    const double expected_rise = (px - x) * plane.d_x + (py - y) * plane.d_y;
    const double rise = d - plane.d;
    const double slope = std::abs(plane.d_x) + std::abs(plane.d_y);
    if (std::abs(rise - expected_rise) <=
        kMostBend * std::max(std::abs(rise), slope) + kDepthTolerance * std::abs(plane.d)) {
      if (there == State::kAway) return is_dark ? kDarkAway * root_of_lit_share_ : 0.0;
      return there != state ? kOtherSide : 0.0;
    }
    const double expected = plane.d + expected_rise;
    const bool orthographic = readback_.camera.orthographic;
    if (!orthographic && !(expected > 0.0)) return 0.0;  // beyond the plane's horizon
    const bool is_near = orthographic ? rise < expected_rise : rise > expected_rise;
    if (!is_near) {
      if (there == State::kAway) return is_dark ? kDarkAwayFar * root_of_lit_share_ : 0.0;
      return there != state && IsAdjacent(px, py, d, place, x, y, plane) ? kFarAdjacent : 0.0;
    }
    if (is_dark) {
      if (there == State::kAway) return kDarkAway * root_of_lit_share_;
      return there == State::kLit ? kDarkLitNear : 0.0;
    }
    const bool is_adjacent = IsAdjacent(px, py, d, place, x, y, plane);
    if (there == State::kLit) return is_adjacent ? kLitLitAdjacent : kLitLitJump;
    return is_adjacent ? kLitElseAdjacent : kLitElseJump;
  }

  // Whether what the pixel (px, py) shows is off the plane of (x, y), along the eye's ray, by less
  // than the place is away from (x, y).
  bool IsAdjacent(int px,
                  int py,
                  double d,
                  const Eigen::Vector2d& place,
                  int x,
                  int y,
                  const DepthGradient& plane) const {
    const auto plane_at = [&](double column, double row) {
      return plane.d + (column - x - 0.5) * plane.d_x + (row - y - 0.5) * plane.d_y;
    };
    const Eigen::Vector3d seen = World(px + 0.5, py + 0.5, d);
    const Eigen::Vector3d on_plane = World(px + 0.5, py + 0.5, plane_at(px + 0.5, py + 0.5));
    const Eigen::Vector3d centre = World(place.x(), place.y(), plane_at(place.x(), place.y()));
    const Eigen::Vector3d pixel = World(x + 0.5, y + 0.5, plane.d);
    return (seen - on_plane).squaredNorm() < (centre - pixel).squaredNorm();
  }

  const Readback& readback_;
  const PixelFootprints& footprints_;
  const AffineDepth& affine_depth_;
  const Eigen::Matrix<double, 3, 4> map_from_screen_;
  const Eigen::Matrix4d world_from_screen_;
  MapSize map_;
  State needed_;  // what the border answers wrongly; kBackground: nothing
  ScratchVector<State> states_;
  double root_of_lit_share_, edge_on_;
};

}  // namespace

absl::StatusOr<double> ForetellByState(const Readback& readback,
                                       const Light& light,
                                       const PixelFootprints& footprints,
                                       MapSize map,
                                       std::optional<Border> border) {
  const StateForecast forecast(readback, light, footprints, map, border);
  const double num_pixels = static_cast<double>(readback.width()) * readback.height();
  const int stride = std::max(1, static_cast<int>(std::ceil(std::sqrt(num_pixels / kMostPixels))));
  const int first = std::max(1, stride / 2);
  double sum = 0.0;
  int64_t num_looked_at = 0;
  for (int y = first; y + 1 < readback.height(); y += stride) {
    if (absl::Status status = CheckStop(light); !status.ok()) return status;
    sum += forecast.SumOfRow(y, first, stride);
    num_looked_at += std::max(0, (readback.width() - 2 - first) / stride + 1);
  }
  if (num_looked_at == 0) return 0.0;
  const double share =
      sum / static_cast<double>(num_looked_at) + forecast.OutsideUnseen() / num_pixels;
  return std::clamp(share, 0.0, 1.0);
}

}  // namespace lightfit
