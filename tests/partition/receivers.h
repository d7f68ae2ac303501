// tests/partition/receivers.h
//
// The receivers of a read-back, one by one, and what a plan does not do for them.
// In:   surfaces, a light, a plan.
// Out:  CountUnserved(): receivers that no map holds, or that are out of their map's depths.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cstdint>

#include "absl/types/span.h"
#include "geometry/light.h"
#include "optimizer/fit_options.h"
#include "optimizer/readback/needed_surfaces.h"
#include "optimizer/readback/surfaces.h"
#include "partition/plan.h"

namespace lightfit::testing {

// Calls visit(world point) for every receiver; where there are `words` for those alone whose `bit`
// is set in theirs.
template <typename Visitor>
void ForEachReceiver(const Surfaces& surfaces,
                     const absl::Span<const uint32_t>& words,
                     uint32_t bit,
                     const Visitor& visit) {
  const Readback& readback = surfaces.readback;
  for (int y = 0; y < readback.height(); ++y) {
    for (int x = 0; x < readback.width(); ++x) {
      const size_t pixel = readback.Index(x, y);
      if (!words.empty() && (words[pixel] & bit) == 0) continue;
      if (!surfaces.affine_depth.IsSurface(readback.depth[pixel])) continue;
      const double d = surfaces.affine_depth.At(x, y, readback.depth[pixel]);
      const Eigen::Vector4d world =
          surfaces.world_from_screen * Eigen::Vector4d(x + 0.5, y + 0.5, d, 1.0);
      visit(Eigen::Vector3d(world.hnormalized()));
    }
  }
}

// Positions found here from the screen and there from rays differ in the last digits of a double;
// MapDepths::Fits() is content with as much.
inline constexpr double kDepthRounding = 1e-9;
// The same in maps of hundreds of texels.
inline constexpr double kTexelRounding = 1e-6;

// Of receivers that must be held, as the border answers them wrongly or the cover is of all: how
// many there are, how many no map holds, and how many are nearer than the depths of the map that
// they ask. Of all receivers: how many ask a map and are further than its depths, where shadows
// would be lost.
struct Unserved {
  int num_needed = 0, outside = 0, in_front = 0, beyond = 0;

  int all() const { return outside + in_front + beyond; }
};

inline Unserved CountUnserved(const Surfaces& surfaces,
                              const Light& light,
                              const Plan& plan,
                              Cover cover = Cover::kShadowed,
                              double guard_texels = 0.0) {
  Unserved count;
  const auto look_up =
      PlanLookUp::Create(plan, light, std::max(0.0, guard_texels - kTexelRounding));
  EXPECT_TRUE(look_up.ok()) << look_up.status();
  if (!look_up.ok()) return count;
  const auto depth_in = [&](int map, const Eigen::Vector3d& world) -> double {
    const Eigen::Vector4d at = plan.maps[map].map_from_world * world.homogeneous();
    return at.z() / at.w();
  };
  const NeededSurfaces needed(surfaces, light, plan.border);
  const absl::Span<const uint32_t> all;
  ForEachReceiver(surfaces,
                  cover == Cover::kReceivers ? all : needed.words(),
                  uint32_t{1} << light.shadow_bit,
                  [&](const Eigen::Vector3d& world) {
                    ++count.num_needed;
                    const int map = look_up->At(world).map;
                    count.outside += map < 0 ? 1 : 0;
                    if (map < 0) return;
                    count.in_front += depth_in(map, world) < -kDepthRounding ? 1 : 0;
                  });
  ForEachReceiver(surfaces, all, 0, [&](const Eigen::Vector3d& world) {
    const int map = look_up->At(world).map;
    if (map < 0) return;
    count.beyond += depth_in(map, world) > 1.0 + kDepthRounding ? 1 : 0;
  });
  return count;
}

}  // namespace lightfit::testing
