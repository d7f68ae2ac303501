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
#include "optimizer/figures/forecast_places.h"

namespace lightfit {

namespace {

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
                std::optional<Border> border)
      : readback_(readback),
        footprints_(footprints),
        affine_depth_(footprints.affine_depth()),
        world_from_screen_(footprints.world_from_screen()),
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
    for (int x = first; x + 1 < readback_.width(); x += stride) sum += WrongOf(x, y);
    return sum;
  }

  // How likely the pixel is to be wrong; not for the outermost.
  double WrongOf(int x, int y) const {
    const State state = At(x, y);
    return state == State::kLit || state == State::kDark ? WrongAt(x, y, state) : 0.0;
  }

  // A fit covers what its own read-back shows, so that none of it lies outside; things thinner than
  // a pixel do. Where the outermost pixel to cover stands far from the next, as the tip of a shadow
  // does, more of the kind is not seen; unless another map goes on there. In read-back pixels.
  double OutsideUnseen() const {
    if (needed_ == State::kBackground) return 0.0;
    double pixels = 0.0;
    for (int k = 0; k < footprints_.num_maps(); ++k) pixels += UnseenBeyond(k);
    return kUnseenPixels * pixels;
  }

 private:
  State At(int x, int y) const { return states_[readback_.Index(x, y)]; }

  double AffineAt(int x, int y) const {
    return affine_depth_.At(x, y, readback_.depth[readback_.Index(x, y)]);
  }

  // The two outermost pixels of those that ask a map, on one of its sides: their distances from it.
  struct Outermost {
    double least = std::numeric_limits<double>::infinity(), second = least;  // texels
    Eigen::Vector2d texel = Eigen::Vector2d::Zero();                         // of the first
  };

  double UnseenBeyond(int k) const {
    const Eigen::Matrix<double, 3, 4>& map_from_screen = footprints_.map_from_screen(k);
    const MapSize size = footprints_.size(k);
    std::array<Outermost, 4> sides;
    for (int y = 0; y < readback_.height(); ++y) {
      for (int x = 0; x < readback_.width(); ++x) {
        if (At(x, y) != needed_) continue;
        const Eigen::Vector4d screen = Screen(x, y);
        if (footprints_.MapAt(screen) != k) continue;
        const Eigen::Vector3d map = map_from_screen * screen;
        if (!(map.z() > 0.0)) continue;
        const double u = map.x() / map.z(), v = map.y() / map.z();
        const double to_side[4] = {u, size.width - u, v, size.height - v};
        if (*std::min_element(to_side, to_side + 4) < 0.0) continue;
        for (int i = 0; i < 4; ++i) {
          Outermost& side = sides[i];
          if (to_side[i] < side.least) {
            side.second = side.least;
            side.least = to_side[i];
            side.texel = {u, v};
          } else {
            side.second = std::min(side.second, to_side[i]);
          }
        }
      }
    }
    double pixels = 0.0;
    for (int i = 0; i < 4; ++i) {
      const Outermost& side = sides[i];
      if (!(side.least < kUnseenReach && std::isfinite(side.second))) continue;
      if (footprints_.num_maps() > 1 && GoesOnBeyond(k, i, side.texel)) continue;
      pixels += std::clamp((side.second - side.least) / std::max(side.least, 1e-9), 0.0, 1.0);
    }
    return pixels;
  }

  // Whether another map holds the ray just outside of this one's side, beside a texel.
  bool GoesOnBeyond(int k, int side, Eigen::Vector2d texel) const {
    constexpr double kBeyond = 0.5;  // texels
    const MapSize size = footprints_.size(k);
    const double beyond[4] = {-kBeyond, size.width + kBeyond, -kBeyond, size.height + kBeyond};
    texel(side / 2) = beyond[side];
    return footprints_.IsHeldByOther(k, texel);
  }

  Eigen::Vector4d Screen(int x, int y) const { return {x + 0.5, y + 0.5, AffineAt(x, y), 1.0}; }

  Eigen::Vector3d World(double column, double row, double d) const {
    return (world_from_screen_ * Eigen::Vector4d(column, row, d, 1.0)).hnormalized();
  }

  double WrongAt(int x, int y, State state) const {
    const Eigen::Vector4d screen = Screen(x, y);
    const int asked = footprints_.MapAt(screen);
    if (asked < 0) return state == needed_ ? 1.0 : 0.0;
    const Eigen::Matrix<double, 3, 4>& map_from_screen = footprints_.map_from_screen(asked);
    const MapSize size = footprints_.size(asked);
    const Eigen::Vector3d map = map_from_screen * screen;
    const Eigen::Vector2d texel = map.hnormalized();
    const bool is_inside = map.z() > 0.0 && texel.x() >= 0.0 && texel.y() >= 0.0 &&
                           texel.x() <= size.width && texel.y() <= size.height;
    if (!is_inside) return state == needed_ ? 1.0 : 0.0;
    const std::optional<PixelFootprint> pixel = footprints_.At(x, y);
    const double edge_on = edge_on_ * (state == State::kDark ? root_of_lit_share_ : 1.0);
    if (!pixel.has_value()) return edge_on;

    // Places of the pixel's plane are linear in their texel.
    const PixelPlane plane = {x, y, pixel->gradient};
    const DepthGradient& d = plane.gradient;
    Eigen::Matrix3d map_from_plane;
    map_from_plane.col(0) = map_from_screen.col(0) + d.d_x * map_from_screen.col(2);
    map_from_plane.col(1) = map_from_screen.col(1) + d.d_y * map_from_screen.col(2);
    map_from_plane.col(2) = map_from_screen.col(3) +
                            (d.d - d.d_x * (x + 0.5) - d.d_y * (y + 0.5)) * map_from_screen.col(2);
    const Eigen::Matrix3d plane_from_map = map_from_plane.inverse();
    if (!plane_from_map.allFinite()) return edge_on;
    return MeanOverPlaces([&](const Eigen::Vector2d& delta) {
      const Eigen::Vector3d place = plane_from_map * Eigen::Vector2d(texel + delta).homogeneous();
      // Beyond the plane's horizon nothing of it is seen.
      return place.z() > 0.0 ? WrongIfCentred({plane, state, place.hnormalized()}) : 0.0;
    });
  }

  // A pixel in a state, and where on the screen the centre of its texel is seen.
  struct Look {
    const PixelPlane& plane;
    State state;
    Eigen::Vector2d place;
  };

  // How often the look-up is wrong.
  double WrongIfCentred(const Look& look) const {
    const Eigen::Vector2d& place = look.place;
    if (!(place.x() >= 0.0 && place.y() >= 0.0 && place.x() <= readback_.width() &&
          place.y() <= readback_.height())) {
      return 0.0;
    }
    double sum = 0.0;
    ForEachPixelAround(readback_, place, [&](int px, int py, double weight) {
      sum += weight * RateAt(px, py, look);
    });
    return sum;
  }

  // The same by what one pixel beside the place shows.
  double RateAt(int px, int py, const Look& look) const {
    const State there = At(px, py);
    if (there == State::kBackground) return 0.0;
    const bool is_dark = look.state == State::kDark;
    const double d = AffineAt(px, py);
    if (IsOnSurface(px, py, d, look.plane)) {
      if (there == State::kAway) return is_dark ? kDarkAway * root_of_lit_share_ : 0.0;
      return there != look.state ? kOtherSide : 0.0;
    }
    const double d_of_plane = look.plane.gradient.d + look.plane.RiseTo(px, py);
    const bool orthographic = readback_.camera.orthographic;
    if (!orthographic && !(d_of_plane > 0.0)) return 0.0;  // beyond the plane's horizon
    const bool is_near = orthographic ? d < d_of_plane : d > d_of_plane;
    if (!is_near) {
      if (there == State::kAway) return is_dark ? kDarkAwayFar * root_of_lit_share_ : 0.0;
      return there != look.state && IsAdjacent(px, py, d, look) ? kFarAdjacent : 0.0;
    }
    if (is_dark) {
      if (there == State::kAway) return kDarkAway * root_of_lit_share_;
      return there == State::kLit ? kDarkLitNear : 0.0;
    }
    const bool is_adjacent = IsAdjacent(px, py, d, look);
    if (there == State::kLit) return is_adjacent ? kLitLitAdjacent : kLitLitJump;
    return is_adjacent ? kLitElseAdjacent : kLitElseJump;
  }

  // Whether what a pixel shows is off the plane, along the eye's ray, by less than the place is
  // away from the plane's own pixel.
  bool IsAdjacent(int px, int py, double d, const Look& look) const {
    // Centre of the plane's own pixel.
    const double x = look.plane.x + 0.5;
    const double y = look.plane.y + 0.5;
    const DepthGradient& gradient = look.plane.gradient;
    const auto on_plane = [&](double column, double row) {
      return World(
          column, row, gradient.d + (column - x) * gradient.d_x + (row - y) * gradient.d_y);
    };
    const Eigen::Vector3d off = World(px + 0.5, py + 0.5, d) - on_plane(px + 0.5, py + 0.5);
    const Eigen::Vector3d away = on_plane(look.place.x(), look.place.y()) - on_plane(x, y);
    return off.squaredNorm() < away.squaredNorm();
  }

  const Readback& readback_;
  const PixelFootprints& footprints_;
  const AffineDepth& affine_depth_;
  const Eigen::Matrix4d world_from_screen_;
  State needed_;  // what the border answers wrongly; kBackground: nothing
  ScratchVector<State> states_;
  double root_of_lit_share_, edge_on_;
};

}  // namespace

absl::StatusOr<double> ForetellByState(const Readback& readback,
                                       const Light& light,
                                       const PixelFootprints& footprints,
                                       std::optional<Border> border) {
  const StateForecast forecast(readback, light, footprints, border);
  const int stride = ForecastStride(readback);
  const int first = std::max(1, stride / 2);
  double sum = 0.0;
  int64_t num_looked_at = 0;
  for (int y = first; y + 1 < readback.height(); y += stride) {
    if (absl::Status status = CheckStop(light); !status.ok()) return status;
    sum += forecast.SumOfRow(y, first, stride);
    num_looked_at += std::max(0, (readback.width() - 2 - first) / stride + 1);
  }
  if (num_looked_at == 0) return 0.0;
  const double share = sum / static_cast<double>(num_looked_at) +
                       forecast.OutsideUnseen() / static_cast<double>(readback.depth.size());
  return std::clamp(share, 0.0, 1.0);
}

absl::Status ForetellImageByState(const Readback& readback,
                                  const Light& light,
                                  const PixelFootprints& footprints,
                                  std::optional<Border> border,
                                  absl::Span<float> image) {
  const StateForecast forecast(readback, light, footprints, border);
  for (int y = 1; y + 1 < readback.height(); ++y) {
    if (absl::Status status = CheckStop(light); !status.ok()) return status;
    for (int x = 1; x + 1 < readback.width(); ++x) {
      image[readback.Index(x, y)] = static_cast<float>(forecast.WrongOf(x, y));
    }
  }
  return absl::OkStatus();
}

}  // namespace lightfit
