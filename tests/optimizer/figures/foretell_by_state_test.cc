// The forecast with the third state, against the one by bits where they must agree and against a
// second derivation with rays and planes in the world.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include "geometry/affine_depth.h"
#include "geometry/homography.h"
#include "optimizer/figures/foretell.h"
#include "optimizer/fit.h"
#include "optimizer/readback/surfaces.h"
#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using testing::IsOk;
using testing::PlaneReadback;
using testing::TestScene;

// The light's ray through a point of its map, as a point and a direction of travel.
struct WorldRay {
  Eigen::Vector3d point, direction;
};
WorldRay RayOf(const Light& light, const Eigen::Matrix3d& map_from_ray, const Eigen::Vector2d& at) {
  const Eigen::Vector3d X = map_from_ray.inverse() * at.homogeneous();
  const Eigen::Matrix3d axes = RayFromWorld(light).leftCols<3>();
  if (light.kind == Light::Kind::kPoint) return {light.position, axes.transpose() * X};
  const Eigen::Vector3d across = axes.topRows<2>().transpose() * X.hnormalized();
  return {across, light.direction.normalized()};
}

enum class State { kBackground, kAway, kLit, kDark };

// The forecast written down from its definition, in world space.
class Twin {
 public:
  Twin(const Readback& readback,
       const Light& light,
       const Eigen::Matrix4d& map_from_world,
       MapSize map)
      : readback_(readback),
        light_(light),
        map_from_world_(map_from_world),
        map_from_ray_(*MapFromRay(map_from_world, light)),
        map_(map),
        depth_(readback.camera, readback.depth_kind),
        world_from_screen_(readback.camera.WorldFromScreen()),
        screen_from_world_(readback.camera.ScreenFromWorld()),
        eye_(world_from_screen_.block<3, 1>(0, 2) / world_from_screen_(3, 2)) {
    double num_lit = 0.0, num_dark = 0.0;
    for (int y = 0; y < readback.height(); ++y) {
      for (int x = 0; x < readback.width(); ++x) {
        num_lit += StateOf(x, y) == State::kLit ? 1.0 : 0.0;
        num_dark += StateOf(x, y) == State::kDark ? 1.0 : 0.0;
      }
    }
    root_of_lit_ = std::sqrt(std::max(num_lit / std::max(num_lit + num_dark, 1.0), 0.01));
  }

  double Share(Border border) const {
    double sum = 0.0;
    const SampleOptions options;
    for (int y = 1; y + 1 < readback_.height(); ++y) {
      for (int x = 1; x + 1 < readback_.width(); ++x) sum += Wrong(x, y, border, options);
    }
    return sum / ((readback_.width() - 2) * (readback_.height() - 2)) +
           1.6 * Tips(border) / (static_cast<double>(readback_.width()) * readback_.height());
  }

 private:
  State StateOf(int x, int y) const {
    const size_t i = readback_.Index(x, y);
    if (!depth_.IsSurface(readback_.depth[i])) return State::kBackground;
    if (((readback_.facing_bits[i] >> light_.shadow_bit) & 1u) == 0) return State::kAway;
    return ((readback_.shadow_bits[i] >> light_.shadow_bit) & 1u) != 0 ? State::kDark : State::kLit;
  }
  double Affine(int x, int y) const {
    return depth_.At(x, y, readback_.depth[readback_.Index(x, y)]);
  }
  Eigen::Vector3d World(int x, int y) const {
    return (world_from_screen_ * Eigen::Vector4d(x + 0.5, y + 0.5, Affine(x, y), 1.0))
        .hnormalized();
  }
  static State Needed(Border border) {
    return border == Border::kDark ? State::kLit : State::kDark;
  }

  double Wrong(int x, int y, Border border, const SampleOptions& options) const {
    const State state = StateOf(x, y);
    if (state != State::kLit && state != State::kDark) return 0.0;
    const Eigen::Vector3d position = World(x, y);
    const Eigen::Vector4d map = map_from_world_ * position.homogeneous();
    const Eigen::Vector2d texel = map.head<2>() / map.w();
    if (map.w() <= 0.0 || texel.minCoeff() < 0.0 || texel.x() > map_.width ||
        texel.y() > map_.height) {
      return state == Needed(border) ? 1.0 : 0.0;
    }
    const double side = std::sqrt(1.0 * readback_.width() * readback_.height());
    const double edge_on =
        std::clamp(0.05 * side / 180.0, 0.05, 0.1) * (state == State::kDark ? root_of_lit_ : 1.0);
    DepthGradient gradient;
    if (!DepthGradientAt(readback_, depth_, options, x, y, &gradient)) return edge_on;
    const Eigen::Vector3d normal = SurfaceNormal(screen_from_world_, false, x, y, gradient);
    const Eigen::Vector3d to_light = light_.kind == Light::Kind::kPoint
                                         ? Eigen::Vector3d(light_.position - position)
                                         : Eigen::Vector3d(-light_.direction);
    if (normal.dot(to_light.normalized()) <= options.min_cos_light) return edge_on;
    double sum = 0.0;
    for (int i = 0; i < 9; ++i) {
      const Eigen::Vector2d centre = texel + Eigen::Vector2d(i % 3 - 1, i / 3 - 1) / 3.0;
      const WorldRay ray = RayOf(light_, map_from_ray_, centre);
      const double along = normal.dot(position - ray.point) / normal.dot(ray.direction);
      const Eigen::Vector3d place = ray.point + along * ray.direction;
      // A lamp's rays do not go backwards, nor is anything behind the eye seen.
      if (light_.kind == Light::Kind::kPoint && along <= 0.0) continue;
      if ((readback_.camera.camera_from_world * place.homogeneous()).z() <= 0.0) continue;
      sum += Seen(place, position, normal, x, y, state, gradient);
    }
    return sum / 9.0;
  }

  double Seen(const Eigen::Vector3d& place,
              const Eigen::Vector3d& position,
              const Eigen::Vector3d& normal,
              int x,
              int y,
              State state,
              const DepthGradient& gradient) const {
    const Eigen::Vector4d screen = screen_from_world_ * place.homogeneous();
    const Eigen::Vector2d at = screen.head<2>() / screen.w();
    const int width = readback_.width(), height = readback_.height();
    if (at.minCoeff() < 0.0 || at.x() > width || at.y() > height) return 0.0;
    double sum = 0.0;
    // Bilinear: tents over the pixels' centres, the image's border continued.
    const double column = std::clamp(at.x() - 0.5, 0.0, width - 1.0);
    const double row = std::clamp(at.y() - 0.5, 0.0, height - 1.0);
    for (int py = std::max(0, FloorOf(row)); py <= std::min(height - 1, FloorOf(row) + 1); ++py) {
      for (int px = std::max(0, FloorOf(column)); px <= std::min(width - 1, FloorOf(column) + 1);
           ++px) {
        const double weight =
            std::max(0.0, 1.0 - std::abs(px - column)) * std::max(0.0, 1.0 - std::abs(py - row));
        if (weight > 0.0)
          sum += weight * Rate(px, py, place, position, normal, x, y, state, gradient);
      }
    }
    return sum;
  }
  static int FloorOf(double value) { return static_cast<int>(std::floor(value)); }

  double Rate(int px,
              int py,
              const Eigen::Vector3d& place,
              const Eigen::Vector3d& position,
              const Eigen::Vector3d& normal,
              int x,
              int y,
              State state,
              const DepthGradient& gradient) const {
    const State there = StateOf(px, py);
    if (there == State::kBackground) return 0.0;
    const bool dark = state == State::kDark;
    const double rise = Affine(px, py) - gradient.d;
    const double expected = (px - x) * gradient.d_x + (py - y) * gradient.d_y;
    const bool same_plane =
        std::abs(rise - expected) <=
        0.3 * std::max(std::abs(rise), std::abs(gradient.d_x) + std::abs(gradient.d_y)) +
            1e-3 * std::abs(gradient.d);
    if (same_plane) {
      if (there == State::kAway) return dark ? 0.4 * root_of_lit_ : 0.0;
      return there == state ? 0.0 : 0.9;
    }
    // Where the eye's ray through that pixel meets the plane.
    const Eigen::Vector3d seen = World(px, py);
    const Eigen::Vector3d way = seen - eye_;
    const double share = normal.dot(position - eye_) / normal.dot(way);
    if (share <= 0.0) return 0.0;
    const bool near = share > 1.0;
    const bool adjacent =
        (share - 1.0) * (share - 1.0) * way.squaredNorm() < (place - position).squaredNorm();
    switch (there) {
      case State::kAway:
        if (dark) return (near ? 0.4 : 0.06) * root_of_lit_;
        return near ? (adjacent ? 0.5 : 0.08) : 0.0;
      case State::kLit:
        if (dark) return near ? 0.12 : adjacent ? 0.5 : 0.0;
        return near ? (adjacent ? 0.35 : 0.16) : 0.0;
      case State::kDark:
        if (dark) return 0.0;
        return near ? (adjacent ? 0.5 : 0.08) : adjacent ? 0.5 : 0.0;
      case State::kBackground:
        break;
    }
    return 0.0;
  }

  // The clamped gaps of the four sides.
  double Tips(Border border) const {
    std::vector<std::vector<double>> distances(4);
    for (int y = 0; y < readback_.height(); ++y) {
      for (int x = 0; x < readback_.width(); ++x) {
        if (StateOf(x, y) != Needed(border)) continue;
        const Eigen::Vector4d map = map_from_world_ * World(x, y).homogeneous();
        if (map.w() <= 0.0) continue;
        const Eigen::Vector2d t = map.head<2>() / map.w();
        if (t.minCoeff() < 0.0 || t.x() > map_.width || t.y() > map_.height) continue;
        distances[0].push_back(t.x());
        distances[1].push_back(map_.width - t.x());
        distances[2].push_back(t.y());
        distances[3].push_back(map_.height - t.y());
      }
    }
    double sum = 0.0;
    for (std::vector<double>& side : distances) {
      if (side.size() < 2) continue;
      std::sort(side.begin(), side.end());
      if (side[0] < 6.0) {
        sum += std::clamp((side[1] - side[0]) / std::max(side[0], 1e-9), 0.0, 1.0);
      }
    }
    return sum;
  }

  const Readback& readback_;
  const Light& light_;
  Eigen::Matrix4d map_from_world_;
  Eigen::Matrix3d map_from_ray_;
  MapSize map_;
  AffineDepth depth_;
  Eigen::Matrix4d world_from_screen_, screen_from_world_;
  Eigen::Vector3d eye_;
  double root_of_lit_ = 0.0;
};

TEST(ForetellByState, IsWhatRaysAndPlanesInTheWorldSay) {
  constexpr MapSize kMap = {120, 90};
  int num_compared = 0;
  for (uint64_t seed = 41; seed <= 46; ++seed) {
    const TestScene scene(seed, 6, 120, 90);
    const Readback readback = scene.readback.ViewWithFacing();
    for (const Light& light : scene.lights) {
      for (const BorderChoice border : {BorderChoice::kLit, BorderChoice::kDark}) {
        SCOPED_TRACE(light.name + ", seed " + std::to_string(seed));
        FitOptions options;
        options.border = border;
        const auto fit = FitLight(readback, light, kMap, options);
        if (!fit.ok()) continue;
        const auto share = ForetellWrongShare(
            readback, light, fit->map_from_world, kMap, options.samples, fit->border);
        ASSERT_THAT(share, IsOk());
        const double twin = Twin(readback, light, fit->map_from_world, kMap).Share(fit->border);
        EXPECT_NEAR(*share, twin, 1e-3 * twin + 1e-7);
        ++num_compared;
      }
    }
  }
  EXPECT_GE(num_compared, 60);
}

// On one plane, seen face to face, under a map without a warp: the same places, the same weights,
// and nine of ten look-ups wrong that find the other state.
TEST(ForetellByState, OnAWallIsNineTenthsOfTheForecastByBits) {
  Camera camera;
  camera.width = 120;
  camera.height = 100;
  camera.screen_from_camera << 120, 0, 60, 0, 120, 50, 0, 0, 1;
  PlaneReadback wall(camera, DepthKind::kCameraZ, Eigen::Vector3d::UnitZ(), 4.0);
  wall.Cast(4, [](int x, int y) { return std::hypot(x - 60.2, y - 49.7) < 15.0; });
  const Light sun = Light::Directional("sun", {0.0, 0.0, 1.0}, 4);
  const std::vector<uint32_t> facing(wall.depth.size(), 1u << 4);
  constexpr MapSize kMap = {4096, 4096};
  for (const double texel : {0.7, 2.0, 5.0}) {
    Eigen::Matrix4d map_from_world = Eigen::Matrix4d::Identity();
    map_from_world.topLeftCorner<2, 2>() << 29.0 / texel, 4.0, -2.0, 25.0 / texel;
    map_from_world(0, 3) = map_from_world(1, 3) = 2048.0;
    Readback view = wall.View();
    const auto by_bits = ForetellWrongShare(view, sun, map_from_world, kMap);
    view.facing_bits = facing;
    const auto by_state = ForetellWrongShare(view, sun, map_from_world, kMap);
    ASSERT_THAT(by_bits, IsOk());
    ASSERT_THAT(by_state, IsOk());
    EXPECT_GT(*by_bits, 0.0);
    EXPECT_NEAR(*by_state * 118 * 98, 0.9 * *by_bits * 120 * 100, 1e-9 * 120 * 100);
  }
}

TEST(MeasuredWrongShare, CountsWhereTheDrawnMapSaysOtherThanTheTruth) {
  const TestScene scene(42, 3, 96, 64);
  Readback view = scene.readback.ViewWithFacing();
  EXPECT_FALSE(MeasuredWrongShare(view, scene.lights[1]).has_value());
  std::vector<uint32_t> mapped = scene.readback.shadow_bits;
  view.mapped_bits = mapped;
  EXPECT_EQ(MeasuredWrongShare(view, scene.lights[1]), 0.0);
  int num_flipped = 0;
  for (size_t i = 0; i < mapped.size(); i += 7) {
    mapped[i] ^= 2u;
    num_flipped += (scene.readback.facing_bits[i] & 2u) != 0 ? 1 : 0;
  }
  EXPECT_DOUBLE_EQ(*MeasuredWrongShare(view, scene.lights[1]),
                   num_flipped / static_cast<double>(mapped.size()));
  EXPECT_EQ(MeasuredWrongShare(view, scene.lights[0]), 0.0);
  view.mapped_lights = 1u;
  EXPECT_FALSE(MeasuredWrongShare(view, scene.lights[1]).has_value());
}

}  // namespace
}  // namespace lightfit
