#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "methods/method.h"
#include "methods/view_body.h"
#include "tests/methods/random_input.h"
#include "tests/testing/moved_scene.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::Move;
using testing::Random;
using testing::RandomInput;
using testing::RandomMove;

MethodInput Moved(const MethodInput& input, const Move& move) {
  MethodInput moved = input;
  moved.light = move.Of(input.light);
  moved.camera = move.Of(input.camera);
  moved.receivers = {move.scale * input.receivers.min() + move.offset,
                     move.scale * input.receivers.max() + move.offset};
  return moved;
}

// Texels per area of the receivers' world across the rays, at a point.
double DensityAt(const MethodMap& map, const Light& light, const Eigen::Vector3d& point) {
  const Eigen::Matrix4d& m = map.map_from_world;
  const Eigen::Vector4d at = m * point.homogeneous();
  Eigen::Matrix<double, 2, 3> per_world;
  for (int i = 0; i < 2; ++i) {
    per_world.row(i) = (m.row(i).head<3>() - at(i) / at.w() * m.row(3).head<3>()) / at.w();
  }
  const Eigen::Vector3d along =
      light.kind == Light::Kind::kPoint ? Eigen::Vector3d(point - light.position) : light.direction;
  return std::abs(along.normalized().dot(per_world.row(0).cross(per_world.row(1))));
}

TEST(FarOriginMethods, PublishedMapsAreTheSameInAnyUnitsAndAtAnyDistance) {
  Random random(144);
  int num_maps = 0;
  for (int i = 0; i < 300; ++i) {
    const MethodInput input = RandomInput(random);
    Move move = RandomMove(random);
    move.offset *= input.receivers.diagonal().norm();
    const MethodInput moved = Moved(input, move);
    const double distance = move.Distance() / input.receivers.diagonal().norm();
    for (const Method method : AllMethods()) {
      SCOPED_TRACE(::testing::PrintToString(i) + " " + MethodName(method));
      const auto here = SetUpMap(method, input), there = SetUpMap(method, moved);
      ASSERT_EQ(here.status().code(), there.status().code()) << there.status();
      if (!here.ok()) continue;
      ASSERT_EQ(here->note, there->note);
      // Rectangles of the same area may lie otherwise, so areas are compared. Warps of a hundred to
      // one lose two digits, twice.
      const double tolerance = 1e-8 + 1e-11 * distance;
      for (const Eigen::Vector3d& point : ViewBody(input.camera, input.receivers)) {
        const double first = DensityAt(*here, input.light, point);
        const double second = DensityAt(*there, moved.light, move.scale * point + move.offset) *
                              move.scale * move.scale;
        EXPECT_NEAR(second, first, tolerance * first);
      }
      ++num_maps;
    }
  }
  EXPECT_GE(num_maps, 1000);
}

}  // namespace
}  // namespace lightfit
