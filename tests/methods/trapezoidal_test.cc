#include "methods/trapezoidal.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>

#include "tests/methods/random_input.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::LevelView;
using testing::Random;
using testing::StatusIs;
using testing::Texel;

// How far down the map a point lies, from the viewer's side. v may run either way.
double ShareDown(const MethodInput& input, const MethodMap& map, const Eigen::Vector3d& point) {
  const std::array<Eigen::Vector3d, 8> corners = FrustumCorners(input.camera);
  const auto middle_v = [&](int first) {
    double sum = 0.0;
    for (int i = 0; i < 4; ++i) sum += Texel(map, corners[first + i]).y();
    return sum;
  };
  const double share = Texel(map, point).y() / input.map.height;
  return middle_v(0) < middle_v(4) ? share : 1.0 - share;
}

TEST(TrapezoidalMap, FocusLiesOnTheEightyPercentLine) {
  for (const Eigen::Vector3d& sun : {Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(-0.6, -1, -0.2)}) {
    const MethodInput input = LevelView(sun);
    for (const double depth : {1.5, 2.0, 4.0, 8.0}) {
      for (const double line : {0.5, 0.8}) {
        TrapezoidalOptions options;
        options.focus_depth = depth;
        options.focus_line = line;
        const absl::StatusOr<MethodMap> map = TrapezoidalMap(input, options);
        ASSERT_THAT(map, IsOk());
        EXPECT_EQ(map->note, "");
        const double share = ShareDown(input, *map, Eigen::Vector3d(0.0, 0.0, -depth));
        EXPECT_NEAR(share, line, 1e-9) << depth;
      }
    }
  }
}

TEST(TrapezoidalMap, FocusDeepInTheMapNeedsNoWarp) {
  const MethodInput input = LevelView({0.0, -1.0, 0.0});
  TrapezoidalOptions options;
  options.focus_depth = 19.0;  // 95 % down without a warp
  const absl::StatusOr<MethodMap> map = TrapezoidalMap(input, options);
  ASSERT_THAT(map, IsOk());
  EXPECT_NEAR(ShareDown(input, *map, Eigen::Vector3d(0.0, 0.0, -19.0)), 18.0 / 19.0, 1e-9);
  EXPECT_LE(map->map_from_world.row(3).head<3>().norm(), 1e-12);
}

TEST(TrapezoidalMap, DefaultFocusDividesDepthsInEqualRatios) {
  const MethodInput input = LevelView({0.0, -1.0, 0.0});
  TrapezoidalOptions options;
  options.focus_depth = std::sqrt(1.0 * 20.0);
  EXPECT_LE(testing::HomogeneousError(TrapezoidalMap(input)->map_from_world,
                                      TrapezoidalMap(input, options)->map_from_world),
            1e-12);
}

// The sides of the trapezoid are straight lines of constant u through its corners: from above, the
// frustum's own.
TEST(TrapezoidalMap, SidesMeetOnTheCentreLine) {
  const MethodInput input = LevelView({0.0, -1.0, 0.0});
  const absl::StatusOr<MethodMap> map = TrapezoidalMap(input);
  ASSERT_THAT(map, IsOk());
  for (const double x : {-0.9, 0.4, 0.9}) {
    EXPECT_NEAR(Texel(*map, {-x, 0, -3}).x() + Texel(*map, {x, 0, -3}).x(), 512.0, 1e-9);
  }
  EXPECT_NEAR(Texel(*map, {0, 0, -2}).x(), Texel(*map, {0, 0, -19}).x(), 1e-9);
}

TEST(TrapezoidalMap, DuellingFrustaFallBack) {
  for (const double sign : {1.0, -1.0}) {
    const absl::StatusOr<MethodMap> map =
        TrapezoidalMap(LevelView(sign * Eigen::Vector3d(0.05, -0.1, -1.0)));
    ASSERT_THAT(map, IsOk());
    EXPECT_THAT(map->note, HasSubstr("focused: the light sees the view's near and far face"));
  }
  MethodInput input = LevelView({0.05, -0.1, -1.0});
  input.light = Light::Point("lamp", Eigen::Vector3d(0.5, 1.0, 10.0));
  EXPECT_THAT(TrapezoidalMap(input)->note, HasSubstr("one in the other"));
}

TEST(TrapezoidalMap, FarLampsAreSuns) {
  Random random(31);
  for (int i = 0; i < 100; ++i) {
    MethodInput input = testing::RandomInput(random);
    const Eigen::Vector3d travel = random.UnitVector();
    const std::vector<Eigen::Vector3d> body = ViewBody(input.camera, input.receivers);
    if (body.empty()) continue;
    input.light = Light::Directional("sun", travel);
    const absl::StatusOr<MethodMap> sun = TrapezoidalMap(input);
    const double distance = 1e7 * input.receivers.sizes().norm();
    input.light = Light::Point("lamp", input.receivers.center() - distance * travel);
    const absl::StatusOr<MethodMap> lamp = TrapezoidalMap(input);
    ASSERT_THAT(sun, IsOk());
    ASSERT_THAT(lamp, IsOk());
    ASSERT_EQ(sun->note, lamp->note);
    if (!sun->note.empty()) continue;  // the rectangle of least area may begin at another edge
    const Eigen::Vector2d size(input.map.width, input.map.height);
    for (const Eigen::Vector3d& point : body) {
      const Eigen::Vector2d difference = Texel(*sun, point) - Texel(*lamp, point);
      const Eigen::Vector2d turned = size - Texel(*sun, point) - Texel(*lamp, point);
      EXPECT_LE(std::min(difference.cwiseQuotient(size).norm(), turned.cwiseQuotient(size).norm()),
                1e-4);
    }
  }
}

TEST(TrapezoidalMap, NamesAWrongOption) {
  const MethodInput input = LevelView({0.0, -1.0, 0.0});
  TrapezoidalOptions options;
  options.focus_depth = -1.0;
  EXPECT_THAT(TrapezoidalMap(input, options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("focus_depth = -1")));
  options = {};
  options.focus_line = 1.0;
  EXPECT_THAT(TrapezoidalMap(input, options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("focus_line = 1")));
}

}  // namespace
}  // namespace lightfit
