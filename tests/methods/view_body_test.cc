#include "methods/view_body.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "tests/methods/random_input.h"

namespace lightfit {
namespace {

using testing::Random;

std::vector<Eigen::Vector4d> AllPlanes(const MethodInput& input) {
  const std::array<Eigen::Vector4d, 6> view = FrustumPlanes(input.camera);
  std::vector<Eigen::Vector4d> planes(view.begin(), view.end());
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

// Every point where three of the planes meet and that no plane cuts off.
std::vector<Eigen::Vector3d> BruteForceCorners(const std::vector<Eigen::Vector4d>& planes,
                                               double tolerance) {
  std::vector<Eigen::Vector3d> corners;
  for (size_t i = 0; i < planes.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      for (size_t k = 0; k < j; ++k) {
        Eigen::Matrix3d normals;
        normals << planes[i].head<3>().transpose(), planes[j].head<3>().transpose(),
            planes[k].head<3>().transpose();
        if (std::abs(normals.determinant()) < 1e-9) continue;
        const Eigen::Vector3d corner =
            -normals.inverse() * Eigen::Vector3d(planes[i].w(), planes[j].w(), planes[k].w());
        bool inside = true;
        for (const Eigen::Vector4d& plane : planes) {
          inside &= plane.dot(corner.homogeneous()) >= -tolerance;
        }
        if (inside) corners.push_back(corner);
      }
    }
  }
  return corners;
}

double Reach(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& direction) {
  double reach = -std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& point : points) reach = std::max(reach, direction.dot(point));
  return reach;
}

// Two convex bodies are the same if they reach equally far in every direction.
TEST(ViewBody, IsTheIntersectionOfFrustumAndBox) {
  Random random(11);
  int num_bodies = 0;
  for (int i = 0; i < 300; ++i) {
    MethodInput input = testing::RandomInput(random);
    const double size = input.receivers.sizes().norm();
    if (random.Int(0, 3) == 0) {
      input.camera.orthographic = true;
      input.camera.screen_from_camera(0, 0) = input.camera.width / size;
      input.camera.screen_from_camera(1, 1) = input.camera.height / size;
    }
    const double tolerance = 1e-9 * (size + input.receivers.center().norm());
    const std::vector<Eigen::Vector4d> planes = AllPlanes(input);
    const std::vector<Eigen::Vector3d> body = ViewBody(input.camera, input.receivers);
    for (const Eigen::Vector3d& corner : body) {
      for (const Eigen::Vector4d& plane : planes) {
        ASSERT_GE(plane.dot(corner.homogeneous()), -tolerance);
      }
    }
    const std::vector<Eigen::Vector3d> expected = BruteForceCorners(planes, tolerance);
    ASSERT_EQ(body.empty(), expected.empty());
    if (body.empty()) continue;
    ++num_bodies;
    for (int k = 0; k < 30; ++k) {
      const Eigen::Vector3d direction = random.UnitVector();
      // Corners between planes that are nearly parallel are known less well.
      EXPECT_NEAR(Reach(body, direction), Reach(expected, direction), 1e3 * tolerance);
    }
  }
  EXPECT_GT(num_bodies, 150);
}

TEST(ViewBody, WithCutsIsTheIntersectionWithTheirHalfSpaces) {
  Random random(13);
  int num_bodies = 0, num_empty = 0;
  for (int i = 0; i < 300; ++i) {
    const MethodInput input = testing::RandomInput(random);
    const std::vector<Eigen::Vector3d> whole = ViewBody(input.camera, input.receivers);
    if (whole.empty()) continue;
    const double size = input.receivers.sizes().norm();
    const double tolerance = 1e-9 * (size + input.receivers.center().norm());
    std::vector<Eigen::Vector4d> planes = AllPlanes(input), cuts;
    for (int k = random.Int(1, 2); k > 0; --k) {
      const Eigen::Vector3d normal = random.UnitVector();
      Eigen::Vector4d cut;
      cut << normal, -normal.dot(testing::PointIn(random, whole));
      if (random.Int(0, 9) == 0) cut.w() -= 2.0 * size;  // beyond the body
      cuts.push_back(cut);
      planes.push_back(cut);
    }
    const std::vector<Eigen::Vector3d> body = ViewBody(input.camera, input.receivers, cuts);
    const std::vector<Eigen::Vector3d> expected = BruteForceCorners(planes, tolerance);
    ASSERT_EQ(body.empty(), expected.empty());
    num_empty += body.empty() ? 1 : 0;
    if (body.empty()) continue;
    ++num_bodies;
    for (int k = 0; k < 30; ++k) {
      const Eigen::Vector3d direction = random.UnitVector();
      EXPECT_NEAR(Reach(body, direction), Reach(expected, direction), 1e3 * tolerance);
    }
  }
  EXPECT_GT(num_bodies, 100);
  EXPECT_GT(num_empty, 5);
}

TEST(FrustumCorners, ProjectToTheCornersOfTheImage) {
  Random random(12);
  for (int i = 0; i < 50; ++i) {
    const MethodInput input = testing::RandomInput(random);
    const std::array<Eigen::Vector3d, 8> corners = FrustumCorners(input.camera);
    const double width = input.camera.width, height = input.camera.height;
    for (int k = 0; k < 8; ++k) {
      const Eigen::Vector2d pixel =
          (PixelFromWorld(input.camera) * corners[k].homogeneous()).hnormalized();
      EXPECT_NEAR(pixel.x(), k % 4 == 1 || k % 4 == 2 ? width : 0.0, 1e-6 * width);
      EXPECT_NEAR(pixel.y(), k % 4 >= 2 ? height : 0.0, 1e-6 * height);
      const double depth = k < 4 ? input.camera.near : input.camera.far;
      EXPECT_NEAR(CameraDepth(input.camera, corners[k]), depth, 1e-7 * input.camera.far);
    }
  }
}

}  // namespace
}  // namespace lightfit
