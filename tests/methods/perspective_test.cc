#include "methods/perspective.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "methods/focused.h"
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

// The classical construction, step by step as in the paper: the camera's unit cube by a projection
// matrix with near and far planes, the light's image in it, and a perspective camera there that
// looks at the middle of the cube. Its image plane coordinates of a world point.
class PostPerspectiveView {
 public:
  PostPerspectiveView(const MethodInput& input, double near, double far, double pull_back)
      : input_(input), near_(near), far_(far), pull_back_(pull_back) {
    const Eigen::Vector4d world = input.light.HomogeneousPosition();
    const Eigen::Vector3d first = Clip(world.head<3>() * 1.0, world.w()).head<3>();
    const double w = Clip(world.head<3>(), world.w()).w();
    is_point_ = std::abs(w) > 1e-12;
    position_ = is_point_ ? Eigen::Vector3d(first / w) : first;
    look_ = -position_.normalized();
    right_ = look_.unitOrthogonal();
    up_ = right_.cross(look_);
  }

  Eigen::Vector2d Project(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d cube = Clip(point, 1.0).hnormalized();
    if (!is_point_) return {right_.dot(cube), up_.dot(cube)};
    const Eigen::Vector3d offset = cube - position_;
    return Eigen::Vector2d(right_.dot(offset), up_.dot(offset)) / look_.dot(offset);
  }

  // Whether the light's image sees the point before it and not at its back.
  bool Sees(const Eigen::Vector3d& point) const {
    return !is_point_ || look_.dot(Clip(point, 1.0).hnormalized() - position_) > 0.05;
  }

 private:
  Eigen::Vector4d Clip(const Eigen::Vector3d& point, double w) const {
    Eigen::Vector4d homogeneous;
    homogeneous << point, w;
    Eigen::Vector4d camera = input_.camera.camera_from_world * homogeneous;
    camera.z() += pull_back_ * w;
    const Eigen::Matrix3d& k = input_.camera.screen_from_camera;
    const double z = camera.z();
    return {(k(0, 0) * camera.x() + k(0, 2) * z) * 2.0 / input_.camera.width - z,
            (k(1, 1) * camera.y() + k(1, 2) * z) * 2.0 / input_.camera.height - z,
            ((far_ + near_) * z - 2.0 * far_ * near_ * camera.w()) / (far_ - near_),
            z};
  }

  const MethodInput& input_;
  double near_, far_, pull_back_;
  bool is_point_;
  Eigen::Vector3d position_, look_, right_, up_;
};

// Largest distance, in maps, between the map and the best rectangle of the other view's image
// plane: texels = (map size / rectangle) * rotation * image + offset.
double MissOfRectangle(const std::vector<Eigen::Vector2d>& image,
                       const std::vector<Eigen::Vector2d>& texels,
                       const MapSize& map,
                       double* skew) {
  Eigen::MatrixXd a(image.size(), 3);
  Eigen::MatrixXd b(image.size(), 2);
  for (size_t i = 0; i < image.size(); ++i) {
    a.row(i) << image[i].transpose(), 1.0;
    b.row(i) = texels[i].cwiseQuotient(Eigen::Vector2d(map.width, map.height)).transpose();
  }
  const Eigen::MatrixXd x = a.colPivHouseholderQr().solve(b);
  const Eigen::Vector2d u = x.col(0).head<2>(), v = x.col(1).head<2>();
  *skew = std::abs(u.normalized().dot(v.normalized()));
  return (a * x - b).cwiseAbs().maxCoeff();
}

TEST(PerspectiveMap, IsAUniformMapOfPostPerspectiveSpace) {
  Random random(41);
  int num_compared = 0, num_behind = 0, num_lamps_behind = 0;
  for (int i = 0; i < 300; ++i) {
    const MethodInput input = testing::RandomInput(random);
    const std::vector<Eigen::Vector3d> body = ViewBody(input.camera, input.receivers);
    PerspectiveOptions options;
    if (random.Coin()) options.pull_back = input.camera.near * random.LogUniform(0.1, 10.0);
    const absl::StatusOr<MethodMap> map = PerspectiveMap(input, options);
    if (body.empty() || !map.ok() || !map->note.empty()) continue;
    double pull_back = options.pull_back;
    bool behind = ViewDirection(input.camera).dot(input.light.direction) > 0.0;
    if (input.light.kind == Light::Kind::kPoint) {
      const double depth = CameraDepth(input.camera, input.light.position);
      behind = depth + pull_back < 0.0;
      num_lamps_behind += behind ? 1 : 0;
      pull_back = std::max(pull_back, -depth);
    }
    const ViewDepths depths = ViewDepthsOf(input.camera, body);
    const PostPerspectiveView view(
        input, depths.least + pull_back, depths.greatest + pull_back, pull_back);
    std::vector<Eigen::Vector2d> image, texels;
    bool sees_all = true;
    for (const Eigen::Vector3d& point : body) {
      sees_all &= view.Sees(point);
      image.push_back(view.Project(point));
      texels.push_back(Texel(*map, point));
    }
    if (!sees_all) continue;  // the published camera needs a field of view of 180 degrees
    double skew = 0.0;
    // Post-perspective depth of far points, and lights close to its infinity, cancel digits.
    EXPECT_LE(MissOfRectangle(image, texels, input.map, &skew), 1e-6) << i;
    EXPECT_LE(skew, 1e-5) << i;
    ++num_compared;
    num_behind += behind ? 1 : 0;
  }
  EXPECT_GT(num_compared, 100);
  EXPECT_GT(num_behind, 20);
  EXPECT_GT(num_lamps_behind, 5);
}

// n' = n: from straight above w is the camera's depth.
TEST(PerspectiveMap, OverheadSunWarpsAboutTheEye) {
  const MethodInput input = LevelView({0.0, -2.0, 0.0});
  const absl::StatusOr<MethodMap> map = PerspectiveMap(input);
  ASSERT_THAT(map, IsOk());
  const Eigen::RowVector4d w = map->map_from_world.row(3);
  const Eigen::RowVector4d depth = input.camera.camera_from_world.row(2);
  EXPECT_LE(testing::HomogeneousError(w, depth), 1e-12);
}

TEST(PerspectiveMap, SunAlongTheViewIsNotWarped) {
  for (const double sign : {1.0, -1.0}) {
    const absl::StatusOr<MethodMap> map = PerspectiveMap(LevelView({0.0, 0.0, sign}));
    ASSERT_THAT(map, IsOk());
    EXPECT_LE(map->map_from_world.row(3).head<3>().norm(), 1e-9);
  }
}

// From in front of the viewer to behind, over the camera plane where the light's image passes
// through infinity, the map moves by little.
TEST(PerspectiveMap, HasNoBreakWhereTheLightPassesBehind) {
  MethodInput ahead = LevelView({0.1, -1.0, 1e-7}), behind = LevelView({0.1, -1.0, -1e-7});
  for (const bool lamp : {false, true}) {
    if (lamp) {
      ahead.light = Light::Point("lamp", Eigen::Vector3d(1.0, 25.0, -1e-6));
      behind.light = Light::Point("lamp", Eigen::Vector3d(1.0, 25.0, 1e-6));
    }
    const absl::StatusOr<MethodMap> a = PerspectiveMap(ahead), b = PerspectiveMap(behind);
    ASSERT_THAT(a, IsOk());
    ASSERT_THAT(b, IsOk());
    for (const Eigen::Vector3d& point : ViewBody(ahead.camera, ahead.receivers)) {
      const Eigen::Vector2d difference = Texel(*a, point) - Texel(*b, point);
      const Eigen::Vector2d turned =
          Eigen::Vector2d::Constant(512.0) - Texel(*a, point) - Texel(*b, point);
      EXPECT_LE(std::min(difference.norm(), turned.norm()), 1e-2);
    }
  }
}

TEST(PerspectiveMap, PullBackFadesTheWarp) {
  const MethodInput input = LevelView({0.3, -1.0, 0.2});
  double before = 0.0;
  for (const double pull_back : {0.0, 1.0, 10.0, 1e7}) {
    const absl::StatusOr<MethodMap> map = PerspectiveMap(input, {pull_back});
    ASSERT_THAT(map, IsOk());
    double least = 1e300, greatest = 0.0;
    for (const Eigen::Vector3d& point : ViewBody(input.camera, input.receivers)) {
      const double w = map->map_from_world.row(3).dot(point.homogeneous());
      least = std::min(least, w);
      greatest = std::max(greatest, w);
    }
    EXPECT_GT(least / greatest, before) << pull_back;
    before = least / greatest;
  }
  EXPECT_NEAR(before, 1.0, 1e-4);
}

TEST(PerspectiveMap, LampAtTheEyeIsFocused) {
  MethodInput input = LevelView({0.0, -1.0, 0.0});
  input.light = Light::Point("head", Eigen::Vector3d::Zero());
  const absl::StatusOr<MethodMap> map = PerspectiveMap(input);
  ASSERT_THAT(map, IsOk());
  for (const Eigen::Vector3d& point : ViewBody(input.camera, input.receivers)) {
    EXPECT_GT(map->map_from_world.row(3).dot(point.homogeneous()), 0.0);
  }
}

TEST(PerspectiveMap, LampInsideTheViewFailsWithTheReason) {
  MethodInput input = LevelView({0.0, -1.0, 0.0});
  input.light = Light::Point("lamp", Eigen::Vector3d(0.0, 0.0, -10.0));
  EXPECT_THAT(PerspectiveMap(input),
              StatusIs(absl::StatusCode::kFailedPrecondition,
                       HasSubstr("light \"lamp\": at (0, 0, -10) it hangs among its receivers")));
}

TEST(PerspectiveMap, NamesAWrongPullBack) {
  EXPECT_THAT(PerspectiveMap(LevelView({0.0, -1.0, 0.0}), {-1.0}),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("pull_back = -1")));
}

}  // namespace
}  // namespace lightfit
