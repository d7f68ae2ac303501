#include "cli/flags/scene_flags.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "render/random_suns.h"
#include "render/sight.h"
#include "tests/testing/matchers.h"

namespace lightfit::cli {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

TEST(ParseView, ReadsEyeTargetAndFieldOfView) {
  const auto view = ParseView("1,-2,3.5:0,0,-1e2:45");
  ASSERT_THAT(view, IsOk());
  EXPECT_EQ(view->eye, Eigen::Vector3d(1, -2, 3.5));
  EXPECT_EQ(view->target, Eigen::Vector3d(0, 0, -100));
  EXPECT_EQ(view->fov_deg, 45.0);
  EXPECT_EQ(ParseView("1,2,3:4,5,6")->fov_deg, 60.0);
  for (const char* bad : {"1,2,3",
                          "1,2:3,4,5",
                          "1,2,3:4,5,6:7:8",
                          "1,2,3:4,5,6:0",
                          "1,2,3:4,5,6:180",
                          "1,2,nan:4,5,6",
                          "1,2,3:4,5,x",
                          "1,2,3:4,5,6:wide"}) {
    EXPECT_THAT(ParseView(bad), StatusIs(kInvalid, HasSubstr(bad)));
  }
}

TEST(ParseGenerator, ReadsSettingsInAnyOrder) {
  EXPECT_EQ(ParseGenerator("generate")->num_triangles, 1'100'000);
  const auto options = ParseGenerator("generate:floor=5,triangles=2000,seed=18446744073709551615");
  ASSERT_THAT(options, IsOk());
  EXPECT_EQ(options->floor_half_size, 5.0);
  EXPECT_EQ(options->num_triangles, 2000);
  EXPECT_EQ(options->seed, 18446744073709551615ULL);
  EXPECT_EQ(options->num_objects, 40);
  const auto room = ParseGenerator("generate:kind=room,seed=5,triangles=30000");
  ASSERT_THAT(room, IsOk());
  EXPECT_EQ(room->kind, SceneKind::kRoom);
  EXPECT_EQ(room->num_triangles, 30000);
  EXPECT_EQ(options->kind, SceneKind::kFloor);
  EXPECT_THAT(ParseGenerator("generate:kind=attic"), StatusIs(kInvalid, HasSubstr("attic")));
  EXPECT_THAT(ParseGenerator("generate:floor=5,kind=room"),
              StatusIs(kInvalid, HasSubstr("no setting \"floor\"")));
  EXPECT_THAT(ParseGenerator("generate:triangels=5"),
              StatusIs(kInvalid, HasSubstr("did you mean \"triangles\"")));
  EXPECT_THAT(ParseGenerator("generate:objects=many"), StatusIs(kInvalid, HasSubstr("many")));
  EXPECT_THAT(ParseGenerator("generate:"), StatusIs(kInvalid, HasSubstr("no setting")));
}

TEST(ParsePixelSize, TakesSizesThatFitIntoMemory) {
  EXPECT_EQ(ParsePixelSize("320x200")->width, 320);
  EXPECT_EQ(ParsePixelSize("320x200")->height, 200);
  for (const char* bad : {"320", "320x", "0x5", "-1x5", "axb", "320x200x1", "65536x65536"}) {
    EXPECT_THAT(ParsePixelSize(bad), StatusIs(kInvalid, HasSubstr(bad)));
  }
}

TEST(RandomSuns, AreUniformOnTheHemisphere) {
  const Eigen::Vector3d up = Eigen::Vector3d(1, 2, -0.5).normalized();
  const std::vector<Light> suns = RandomSuns(20000, 5, up);
  ASSERT_EQ(suns.size(), 20000u);
  double sum = 0.0, squares = 0.0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Light& sun : suns) {
    EXPECT_NEAR(sun.direction.norm(), 1.0, 1e-12);
    const double height = -sun.direction.dot(up);
    ASSERT_GT(height, 0.0);
    sum += height;
    squares += height * height;
    mean -= sun.direction / 20000.0;
  }
  // Heights on a sphere are uniform: mean 1/2, mean square 1/3. Four standard deviations.
  EXPECT_NEAR(sum / 20000, 0.5, 4.0 * 0.289 / 141.0);
  EXPECT_NEAR(squares / 20000, 1.0 / 3.0, 4.0 * 0.298 / 141.0);
  EXPECT_LE((mean - 0.5 * up).norm(), 0.03);
}

TEST(RandomSuns, TheFirstAreTheSameWhateverTheCount) {
  const std::vector<Light> few = RandomSuns(3, 9, Eigen::Vector3d::UnitY());
  const std::vector<Light> many = RandomSuns(1200, 9, Eigen::Vector3d::UnitY());
  EXPECT_EQ(few[0].name, "sun001");
  EXPECT_EQ(many[1199].name, "sun1200");
  for (int i = 0; i < 3; ++i) EXPECT_EQ(few[i].direction, many[i].direction);
  EXPECT_NE(RandomSuns(1, 10, Eigen::Vector3d::UnitY())[0].direction, few[0].direction);
}

Scene Room() {
  Scene scene;
  for (const float y : {0.0F, 3.0F}) {
    const auto first = static_cast<int>(scene.vertices.size());
    for (const auto& [x, z] : {std::pair{-5.0F, -5.0F}, {5.0F, -5.0F}, {0.0F, 5.0F}}) {
      scene.vertices.emplace_back(x, y, z);
    }
    scene.triangles.emplace_back(first, first + 1, first + 2);
  }
  return scene;
}

TEST(CheckSight, RefusesEyesThatSeeNothingOrTouchASurface) {
  const auto caster = RayCaster::Build(Room());
  ASSERT_THAT(caster, IsOk());
  const auto sight = [&](const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
    const auto image =
        RenderSurfaces(*caster, *LookAtCamera(eye, target, Eigen::Vector3d::UnitZ(), 0.5, 16, 16));
    return CheckSight(*caster, *image);
  };
  const auto good = sight({0, 1, 0}, {0, 0, 0.1});
  ASSERT_THAT(good, IsOk());
  EXPECT_EQ(*good, "");
  EXPECT_THAT(sight({0, 9, 0}, {0, 19, 0}),
              StatusIs(kInvalid, HasSubstr("reaches from (-5, 0, -5) to (5, 3, 5)")));
  EXPECT_THAT(sight({0, 1e-7, 0}, {0, 3, 0}), StatusIs(kInvalid, HasSubstr("touches a surface")));
  const auto close = sight({0, 0.01, 0}, {0, 0, 0});
  ASSERT_THAT(close, IsOk());
  EXPECT_THAT(*close, HasSubstr("is it inside an object"));
}

}  // namespace
}  // namespace lightfit::cli
