#include "scenes/scene.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/render/testing.h"

namespace lightfit {
namespace {

using testing::AddTriangle;

TEST(MakeScene, KeepsPositionsNearZeroAsTheyAre) {
  const std::vector<Eigen::Vector3d> vertices = {{0.1, 2, 3}, {4, 5, 6}, {7, 8, 10}};
  const Scene scene = MakeScene(vertices, {{0, 1, 2}});
  EXPECT_EQ(scene.origin, Eigen::Vector3d::Zero());
  for (int i = 0; i < 3; ++i) EXPECT_EQ(scene.vertices[i], vertices[i].cast<float>());
}

TEST(MakeScene, KeepsTheDigitsOfPositionsFarOut) {
  for (const double far : {1e4, 1e6, 1e7, 1e9}) {
    const Eigen::Vector3d offset(far, -2.0 * far, 0.0);
    const std::vector<Eigen::Vector3d> vertices = {offset + Eigen::Vector3d(0.125, 2.25, 3.5),
                                                   offset + Eigen::Vector3d(4.5, -5.75, 6),
                                                   offset + Eigen::Vector3d(7, 8.0625, -10)};
    const Scene scene = MakeScene(vertices, {{0, 1, 2}});
    EXPECT_NE(scene.origin.x(), 0.0);
    EXPECT_NE(scene.origin.y(), 0.0);
    EXPECT_EQ(scene.origin.z(), 0.0);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(scene.WorldOf(i), vertices[i]);
    const Eigen::AlignedBox3d bounds = BoundsOf(scene);
    EXPECT_EQ(bounds.max(), offset + Eigen::Vector3d(7, 8.0625, 6));
  }
}

// What a file of floats holds comes out exactly, wherever it is.
TEST(MakeScene, IsExactForFloats) {
  constexpr uint64_t kSeed = 1405;
  testing::Random random(kSeed);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d middle = random.InCube(random.LogUniform(1e-3, 1e9));
    const double size = random.LogUniform(1e-3, 1e6);
    std::vector<Eigen::Vector3d> vertices;
    for (int k = 0; k < 6; ++k) {
      vertices.push_back((middle + random.InCube(size)).cast<float>().cast<double>());
    }
    const Scene scene = MakeScene(vertices, {{0, 1, 2}, {3, 4, 5}});
    for (int k = 0; k < 6; ++k)
      ASSERT_EQ(scene.WorldOf(k), vertices[k]) << scene.origin.transpose();
  }
}

TEST(MakeScene, IsNotMovedByVerticesThatAreBad) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Scene scene = MakeScene({{1, 0, 0}, {2, 2, 3}, {1, 3, 0}, {nan, 0, 0}, {1e30, 0, 0}},
                                {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {0, 1, 9}, {0, -1, 2}});
  EXPECT_EQ(scene.origin, Eigen::Vector3d::Zero());
  EXPECT_EQ(scene.triangles.size(), 5u);
  EXPECT_TRUE(MakeScene({}, {}).vertices.empty());
}

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
