#include "partition/published/view_grid.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <set>

#include "methods/focused.h"
#include "methods/view_body.h"
#include "tests/methods/random_input.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::IsOk;
using testing::LevelView;
using testing::Random;
using testing::RandomInput;

std::vector<Eigen::Vector4d> PlanesOf(const MethodInput& input) {
  const std::array<Eigen::Vector4d, 6> view = FrustumPlanes(input.camera);
  std::vector<Eigen::Vector4d> planes(view.begin(), view.end());
  planes.insert(planes.end(), input.cuts.begin(), input.cuts.end());
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Vector4d plane;
    plane << Eigen::Vector3d::Unit(axis), -input.receivers.min()(axis);
    planes.push_back(plane);
    plane << -Eigen::Vector3d::Unit(axis), input.receivers.max()(axis);
    planes.push_back(plane);
  }
  for (Eigen::Vector4d& plane : planes) plane /= plane.head<3>().norm();
  return planes;
}

void MakeOrthographic(MethodInput* input) {
  const double size = input->receivers.sizes().norm();
  input->camera.orthographic = true;
  input->camera.screen_from_camera(0, 0) = input->camera.width / size;
  input->camera.screen_from_camera(1, 1) = input->camera.height / size;
}

TEST(ViewGrid, LiesInTheBodyOnAllRaysThatMeetIt) {
  Random random(1);
  int num_grids = 0, num_empty = 0;
  for (int i = 0; i < 100; ++i) {
    MethodInput input = RandomInput(random);
    if (random.Int(0, 3) == 0) MakeOrthographic(&input);
    const std::vector<Eigen::Vector3d> body = ViewBody(input.camera, input.receivers);
    if (!body.empty() && random.Coin()) {
      const Eigen::Vector3d normal = random.UnitVector();
      input.cuts.emplace_back(
          normal.x(), normal.y(), normal.z(), -normal.dot(testing::PointIn(random, body)));
    }
    const std::vector<ViewGridPoint> grid = ViewGrid(input);
    if (ViewBody(input.camera, input.receivers, input.cuts).empty()) {
      EXPECT_TRUE(grid.empty());
    }
    num_empty += grid.empty() ? 1 : 0;
    num_grids += grid.empty() ? 0 : 1;
    const double size = input.receivers.sizes().norm();
    const double tolerance = 1e-9 * (size + input.receivers.center().norm());
    std::set<std::pair<int, int>> cells;
    for (const ViewGridPoint& point : grid) {
      for (const Eigen::Vector4d& plane : PlanesOf(input)) {
        ASSERT_GE(plane.dot(point.position.homogeneous()), -tolerance);
      }
      const Eigen::Vector2d pixel =
          (PixelFromWorld(input.camera) * point.position.homogeneous()).hnormalized();
      cells.insert({static_cast<int>(24.0 * pixel.x() / input.camera.width),
                    static_cast<int>(24.0 * pixel.y() / input.camera.height)});
      EXPECT_GT(point.scale, 0.0);
    }
    EXPECT_EQ(grid.size(), 8 * cells.size());
  }
  EXPECT_GT(num_grids, 50);
  EXPECT_GT(num_empty, 5);
}

TEST(ViewGrid, FillsAViewThatIsWhollyInTheBox) {
  EXPECT_EQ(ViewGrid(LevelView({0.0, -1.0, 0.0})).size(), 24u * 24u * 8u);
}

// Pixels of a texel on the plane through the point whose normal bisects the directions to the light
// and to the eye, by central differences of pixel and texel.
double TexelPixels(const MethodInput& input,
                   const Eigen::Matrix4d& map_from_world,
                   const Eigen::Vector3d& world) {
  const bool is_lamp = input.light.kind == Light::Kind::kPoint;
  const Eigen::Vector3d to_light = (is_lamp ? Eigen::Vector3d(input.light.position - world)
                                            : Eigen::Vector3d(-input.light.direction))
                                       .normalized();
  const Eigen::Vector3d to_eye =
      (input.camera.orthographic ? Eigen::Vector3d(-ViewDirection(input.camera))
                                 : Eigen::Vector3d(EyePosition(input.camera) - world))
          .normalized();
  const Eigen::Matrix3d axes = FrameAlong(to_light + to_eye);
  const double step = 1e-5 * input.receivers.sizes().norm();
  const auto project = [&](const Eigen::Vector3d& at) {
    const Eigen::Vector4d h = map_from_world * at.homogeneous();
    Eigen::Vector4d both;
    both << h.head<2>() / h.w(), (PixelFromWorld(input.camera) * at.homogeneous()).hnormalized();
    return both;
  };
  Eigen::Matrix<double, 4, 2> difference;
  for (int k = 0; k < 2; ++k) {
    const Eigen::Vector3d side = step * axes.row(k).transpose();
    difference.col(k) = project(world + side) - project(world - side);
  }
  return std::abs(difference.bottomRows<2>().determinant() / difference.topRows<2>().determinant());
}

TEST(ViewGrid, ScaleTurnsCoarsenessIntoPixelsOfATexel) {
  constexpr double kDifferences = 1e-3;  // relative; near the eye a step is a share of the distance
  Random random(2);
  int num_compared = 0;
  for (int i = 0; i < 60; ++i) {
    MethodInput input = RandomInput(random);
    if (random.Int(0, 3) == 0) MakeOrthographic(&input);
    input.camera.near = std::max(input.camera.near, 0.05 * input.receivers.sizes().norm());
    input.camera.far = std::max(input.camera.far, 2.0 * input.camera.near);
    const auto map = FocusedMap(input);
    if (!map.ok()) continue;
    Plan plan;
    plan.maps.emplace_back();
    plan.maps[0].map_from_world = map->map_from_world;
    plan.maps[0].size = input.map;
    const auto look_up = PlanLookUp::Create(plan, input.light);
    ASSERT_THAT(look_up, IsOk());
    const std::vector<ViewGridPoint> grid = ViewGrid(input);
    for (size_t k = 0; k < grid.size(); k += 97) {
      const double q = look_up->CoarsenessOf(0, grid[k].position);
      const double pixels = TexelPixels(input, map->map_from_world, grid[k].position);
      EXPECT_LT(testing::RelativeError(grid[k].scale * q * q * q, pixels), kDifferences);
      ++num_compared;
    }
  }
  EXPECT_GT(num_compared, 500);
}

TEST(MeanTexelSide, IsThatOfTheMapAskedAndInfiniteWhereThereIsNone) {
  const MethodInput input = LevelView({0.2, -1.0, 0.1});
  const std::vector<ViewGridPoint> grid = ViewGrid(input);
  Plan plan;
  plan.maps.emplace_back();
  plan.maps[0].map_from_world = FocusedMap(input)->map_from_world;
  plan.maps[0].size = input.map;
  const auto look_up = PlanLookUp::Create(plan, input.light);
  ASSERT_THAT(look_up, IsOk());
  double sum = 0.0;
  for (const ViewGridPoint& point : grid) {
    sum += std::sqrt(TexelPixels(input, plan.maps[0].map_from_world, point.position));
  }
  const double mean = sum / static_cast<double>(grid.size());
  EXPECT_NEAR(MeanTexelSide(*look_up, grid) / mean, 1.0, 1e-3);
  EXPECT_EQ(MeanTexelSide(*look_up, {}), 0.0);

  // Half of the view may ask nobody.
  plan.maps[0].half_spaces = {Eigen::RowVector4d(1.0, 0.0, 0.0, 0.0)};
  const auto half = PlanLookUp::Create(plan, input.light);
  ASSERT_THAT(half, IsOk());
  EXPECT_EQ(MeanTexelSide(*half, grid), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace lightfit
