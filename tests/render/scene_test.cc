#include "render/scene.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/render/testing.h"

namespace lightfit {
namespace {

using testing::AddTriangle;

TEST(DropBadTriangles, DropsWhatHasNoAreaOrIsNotThere) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Scene scene;
  scene.vertices = {
      {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {kNan, 0, 0}, {0, kInfinity, 0}, {0, 0, 3e18F}};
  scene.triangles = {
      {0, 1, 2},   // good
      {0, 1, 1},   // repeats a vertex
      {0, 1, 3},   // on a line
      {0, 1, 4},   // not a number
      {0, 5, 1},   // infinite
      {0, 1, 6},   // too far to square
      {0, 1, 7},   // not there
      {-1, 1, 2},  // not there
      {1, 2, 3},   // good
  };
  EXPECT_EQ(DropBadTriangles(&scene), 7);
  ASSERT_EQ(scene.triangles.size(), 2u);
  EXPECT_EQ(scene.triangles[0], Eigen::Vector3i(0, 1, 2));
  EXPECT_EQ(scene.triangles[1], Eigen::Vector3i(1, 2, 3));
  EXPECT_EQ(DropBadTriangles(&scene), 0);
}

TEST(DropBadTriangles, KeepsTinyAndThinTriangles) {
  Scene scene;
  AddTriangle({0, 0, 0}, {1e-15, 0, 0}, {0, 1e-15, 0}, &scene);
  AddTriangle({0, 0, 0}, {1e6, 0, 0}, {5e5, 1e-6, 0}, &scene);
  EXPECT_EQ(DropBadTriangles(&scene), 0);
}

TEST(BoundsOf, LooksAtUsedVerticesOnly) {
  Scene scene;
  EXPECT_TRUE(BoundsOf(scene).isEmpty());
  scene.vertices.emplace_back(100, 100, 100);
  EXPECT_TRUE(BoundsOf(scene).isEmpty());
  AddTriangle({-1, 0, 2}, {1, 3, 2}, {0, 1, 5}, &scene);
  EXPECT_EQ(BoundsOf(scene).min(), Eigen::Vector3d(-1, 0, 2));
  EXPECT_EQ(BoundsOf(scene).max(), Eigen::Vector3d(1, 3, 5));
}

}  // namespace
}  // namespace lightfit
