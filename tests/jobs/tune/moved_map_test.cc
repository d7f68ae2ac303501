#include "jobs/tune/moved_map.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "geometry/homography.h"
#include "tests/jobs/compare/compare_scene.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::IsOk;
using testing::StatusIs;

constexpr MapSize kMap = {300, 200};

// MapFromMap() is in double precision, on coordinates of some hundred texels.
constexpr double kTexelTolerance = 1e-9;

std::vector<double> RandomMoves(testing::Random& random, double reach) {
  std::vector<double> moves;
  for (int i = 0; i < kNumMoves; ++i) moves.push_back(random.Uniform(-reach, reach));
  return moves;
}

// Texel by texel: to the square, moved there, and back.
TEST(MapFromMap, MovesTheSquare) {
  testing::Random random(41);
  for (int i = 0; i < 200; ++i) {
    const std::vector<double> m = RandomMoves(random, 0.3);
    const double u = random.Uniform(0, kMap.width), v = random.Uniform(0, kMap.height);
    const double x = 2.0 * u / kMap.width - 1.0, y = 2.0 * v / kMap.height - 1.0;
    const double w = m[6] * x + m[7] * y + 1.0;
    const double moved_x = (x + m[0] * x + m[1] * y + m[2]) / w;
    const double moved_y = (y + m[3] * x + m[4] * y + m[5]) / w;
    const Eigen::Vector3d moved = MapFromMap(m, kMap) * Eigen::Vector3d(u, v, 1.0);
    EXPECT_NEAR(moved.x() / moved.z(), 0.5 * kMap.width * (moved_x + 1.0), kTexelTolerance);
    EXPECT_NEAR(moved.y() / moved.z(), 0.5 * kMap.height * (moved_y + 1.0), kTexelTolerance);
    EXPECT_NEAR(moved.z(), w, 1e-12);
  }
}

// A light of a small scene, and a map around everything in view.
class MovedMapTest : public ::testing::Test {
 protected:
  MovedMapTest()
      : caster_(*RayCaster::Build(BoxesOnFloor(), 2)),
        image_(*RenderSurfaces(caster_, BoxesCamera(80, 60))) {}

  void SetLight(const Light& light) {
    light_ = light;
    truth_ = TrueLighting(caster_, image_, light);
    // Downwards, where the surfaces are.
    const Eigen::Matrix<double, 3, 4> ray_from_world =
        RayFromWorld(light, -Eigen::Vector3d::UnitY());
    Eigen::AlignedBox2d box;
    for (size_t i = 0; i < truth_.size(); ++i) {
      if (truth_[i] != Lighting::kLit && truth_[i] != Lighting::kShadowed) continue;
      box.extend((ray_from_world * image_.pixels[i].position.homogeneous()).hnormalized());
    }
    const Eigen::Vector2d low = box.min(), extent = box.sizes();
    Eigen::Matrix3d map_from_ray;
    map_from_ray << kMap.width / extent.x(), 0, -low.x() * kMap.width / extent.x(),  //
        0, kMap.height / extent.y(), -low.y() * kMap.height / extent.y(),            //
        0, 0, 1;
    map_from_world_ = MapFromWorld(map_from_ray, ray_from_world, light, {1.0, 2.0}, 1.0);
    middle_ray_ = box.center().homogeneous();
    if (light.kind == Light::Kind::kPoint) {
      const Eigen::Vector3d direction = ray_from_world.leftCols<3>().inverse() * middle_ray_;
      middle_ray_ = RayFromWorld(light).leftCols<3>() * direction;
    }
  }

  absl::StatusOr<MovableMap> Make(Border border) const {
    absl::StatusOr<MovableMap> movable =
        MovableMap::Make(light_, map_from_world_, kMap, border, middle_ray_);
    if (movable.ok()) movable->SetReceivers(image_, truth_);
    return movable;
  }

  static std::vector<Light> Lights() {
    return {Light::Directional("sun", {-1, -1.3, 0.4}), Light::Point("lamp", {4, 30, 6})};
  }

  RayCaster caster_;
  SurfaceImage image_;
  Light light_;
  std::vector<Lighting> truth_;
  Eigen::Matrix4d map_from_world_;
  Eigen::Vector3d middle_ray_;
};

TEST_F(MovedMapTest, NoMovesLeaveTheMap) {
  for (const Light& light : Lights()) {
    SetLight(light);
    const auto movable = Make(Border::kLit);
    ASSERT_THAT(movable, IsOk());
    const auto moved = movable->Moved(std::vector<double>(kNumMoves, 0.0));
    ASSERT_THAT(moved, IsOk());
    for (const int row : {0, 1, 3}) {
      EXPECT_LT((moved->row(row) - map_from_world_.row(row)).norm(),
                1e-12 * map_from_world_.row(row).norm())
          << light.name << ", row " << row;
    }
  }
}

TEST_F(MovedMapTest, HasTheMoveAndADepthRowOverTheReceivers) {
  testing::Random random(42);
  for (const Light& light : Lights()) {
    SCOPED_TRACE(light.name);
    SetLight(light);
    const auto movable = Make(Border::kLit);
    ASSERT_THAT(movable, IsOk());
    for (int i = 0; i < 50; ++i) {
      const std::vector<double> moves = RandomMoves(random, 0.2);
      const auto moved = movable->Moved(moves);
      ASSERT_THAT(moved, IsOk());
      EXPECT_TRUE(moved->allFinite());
      const Eigen::Matrix3d map_from_map = MapFromMap(moves, kMap);
      double nearest = 1.0, furthest = 0.0;
      for (size_t k = 0; k < truth_.size(); ++k) {
        if (truth_[k] != Lighting::kShadowed) continue;
        const Eigen::Vector4d position = image_.pixels[k].position.homogeneous();
        const Eigen::Vector4d before = map_from_world_ * position, after = *moved * position;
        EXPECT_GT(after.w(), 0.0);
        const Eigen::Vector3d wanted =
            map_from_map * Eigen::Vector3d(before.x(), before.y(), before.w());
        EXPECT_LT((wanted.hnormalized() - after.head<2>() / after.w()).norm(), 1e-6);
        const double z = after.z() / after.w();
        nearest = std::min(nearest, z);
        furthest = std::max(furthest, z);
      }
      EXPECT_GE(nearest, 0.0);
      EXPECT_LE(furthest, 1.0);
      EXPECT_GT(furthest - nearest, 0.01);
      // In the middle w keeps its size.
      const Eigen::Matrix3d map_from_ray = *MapFromRay(*moved, light);
      EXPECT_NEAR(map_from_ray.row(2).dot(middle_ray_), 1.0, 1e-9);
    }
  }
}

TEST_F(MovedMapTest, RefusesAFoldedMapAndOneThatLeavesReceiversBehind) {
  constexpr auto kFailed = absl::StatusCode::kFailedPrecondition;
  for (const Light& light : Lights()) {
    SetLight(light);
    // Shadows lie in a part of the map, lit surfaces all over it.
    const auto movable = Make(Border::kDark);
    ASSERT_THAT(movable, IsOk());
    std::vector<double> moves(kNumMoves, 0.0);
    moves[0] = -1.0;
    EXPECT_THAT(movable->Moved(moves), StatusIs(kFailed, ::testing::HasSubstr("no area")));
    moves[0] = -1.5;
    EXPECT_THAT(movable->Moved(moves), StatusIs(kFailed, ::testing::HasSubstr("no area")));
    moves = std::vector<double>(kNumMoves, 0.0);
    moves[6] = 1.2;
    EXPECT_THAT(movable->Moved(moves), StatusIs(kFailed, ::testing::HasSubstr("w <= 0")));
  }
}

TEST_F(MovedMapTest, RefusesAMatrixOfAnotherLight) {
  SetLight(Lights()[0]);
  light_ = Lights()[1];
  EXPECT_THAT(Make(Border::kLit),
              StatusIs(absl::StatusCode::kInvalidArgument, ::testing::HasSubstr("lamp")));
}

}  // namespace
}  // namespace lightfit
