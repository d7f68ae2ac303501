#include "partition/published/face_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "methods/view_body.h"
#include "partition/published/z_partition.h"
#include "tests/methods/random_input.h"
#include "tests/partition/published/lloyd_view.h"

namespace lightfit {
namespace {

using testing::InputOf;
using testing::kBehind;
using testing::kOverhead;
using testing::Random;

// Where a beam of light that goes through a point of the view first meets a face, going from the
// point towards the light (forwards: away from it).
struct FaceHit {
  int side = -1;  // as FaceCell::side; -1: the near or the far face
  bool is_far = false;
  double depth = 0.0;
};

FaceHit HitOf(const MethodInput& input,
              const Eigen::Vector3d& point,
              bool forwards,
              bool with_near_and_far) {
  // FrustumPlanes() has near, far, left, right, top, bottom; sides run around from the top.
  constexpr int kSideOfPlane[6] = {-1, -1, 3, 1, 0, 2};
  const std::array<Eigen::Vector4d, 6> planes = FrustumPlanes(input.camera);
  Eigen::Vector3d step = input.light.kind == Light::Kind::kPoint
                             ? Eigen::Vector3d(point - input.light.position)
                             : input.light.direction;
  if (!forwards) step = -step;
  FaceHit hit;
  double nearest = std::numeric_limits<double>::infinity();
  for (int i = with_near_and_far ? 0 : 2; i < 6; ++i) {
    const double height = planes[i].dot(point.homogeneous());
    const double fall = -planes[i].head<3>().dot(step);
    if (!(fall > 0.0) || height / fall >= nearest) continue;
    nearest = height / fall;
    hit = {kSideOfPlane[i], i == 1, CameraDepth(input.camera, point + nearest * step)};
  }
  return hit;
}

bool IsInside(const FaceCell& cell, const Eigen::Vector3d& point, double slack) {
  return std::all_of(cell.half_spaces.begin(), cell.half_spaces.end(), [&](const auto& plane) {
    return plane.dot(point.homogeneous()) >= -slack;
  });
}

// The one cell that holds a point which is well away from cells' borders.
std::optional<size_t> CellOf(const std::vector<FaceCell>& cells,
                             const Eigen::Vector3d& point,
                             double border) {
  std::optional<size_t> found;
  int num_near = 0;
  for (size_t i = 0; i < cells.size(); ++i) {
    if (!IsInside(cells[i], point, border)) continue;
    ++num_near;
    if (IsInside(cells[i], point, -border)) found = i;
  }
  EXPECT_GE(num_near, 1);
  return num_near == 1 ? found : std::nullopt;
}

Eigen::Vector3d PointInView(const Camera& camera, Random& random) {
  const double z = random.LogUniform(camera.near, camera.far);
  return (camera.WorldFromScreen() *
          Eigen::Vector4d(
              random.Uniform(0.0, camera.width), random.Uniform(0.0, camera.height), 1.0 / z, 1.0))
      .hnormalized();
}

bool IsInView(const Camera& camera, const Eigen::Vector3d& point) {
  const auto planes = FrustumPlanes(camera);
  return std::all_of(planes.begin(), planes.end(), [&](const Eigen::Vector4d& plane) {
    return plane.dot(point.homogeneous()) > 0.0;
  });
}

// Every point belongs to the cell of the face, and of the depth on it, where its beam of light
// enters the view (leaves it, when light travels against the view).
TEST(FaceCells, AreOfTheFacesThatBeamsPass) {
  Random random(1);
  std::set<int> num_sides;
  int num_checked = 0, num_within = 0;
  for (int i = 0; i < 600; ++i) {
    MethodInput input = testing::RandomInput(random);
    if (random.Int(0, 5) == 0) {
      input.light = Light::Point("lamp", PointInView(input.camera, random));
    }
    const Light& light = input.light;
    const bool is_lamp = light.kind == Light::Kind::kPoint;
    const bool is_within = is_lamp && IsInView(input.camera, light.position);
    const bool has_near = random.Coin();
    const int num_parts = random.Int(1, 4);
    const std::vector<FaceCell> cells = FaceCells(light, input.camera, num_parts, has_near);
    ASSERT_FALSE(cells.empty());
    if (cells.size() == 1 && cells[0].side < 0) {
      EXPECT_TRUE(cells[0].half_spaces.empty());
      continue;
    }
    const bool enters =
        is_lamp ? CameraDepth(input.camera, light.position) <= input.camera.far && !is_within
                : light.direction.dot(ViewDirection(input.camera)) >= 0.0;
    const std::vector<double> depths =
        DepthSplits(input.camera.near, input.camera.far, num_parts, 1.0);
    std::set<int> sides;
    for (const FaceCell& cell : cells) sides.insert(cell.side);
    sides.erase(-1);
    num_sides.insert(static_cast<int>(sides.size()));
    num_within += is_within ? 1 : 0;
    for (int k = 0; k < 50; ++k) {
      const Eigen::Vector3d point = PointInView(input.camera, random);
      const double scale = input.camera.far + point.norm();
      const std::optional<size_t> cell = CellOf(cells, point, 1e-9 * scale);
      if (!cell.has_value()) continue;
      ++num_checked;
      const FaceHit hit = HitOf(input, point, !enters, has_near || is_within);
      const FaceCell& found = cells[*cell];
      EXPECT_EQ(found.side, hit.side) << i;
      if (hit.side < 0) {
        EXPECT_EQ(hit.is_far, is_within && *cell + 1 == cells.size()) << i;
        continue;
      }
      const double low = depths[found.part], high = depths[found.part + 1];
      if (found.part > 0) {
        EXPECT_GE(hit.depth, low * (1.0 - 1e-6)) << i;
      }
      if (found.part + 1 < num_parts) {
        EXPECT_LE(hit.depth, high * (1.0 + 1e-6)) << i;
      }
    }
  }
  EXPECT_EQ(num_sides, (std::set<int>{1, 2, 3, 4}));
  EXPECT_GT(num_checked, 20000);
  EXPECT_GT(num_within, 50);
}

TEST(FaceCells, AreFourFromBehindAndInFrontAndOneFromAbove) {
  const LloydView view = {1.0, 100.0, 0.5};
  const auto count = [&](const Eigen::Vector3d& sun, bool has_near) {
    const MethodInput input = InputOf(view, sun);
    return FaceCells(input.light, input.camera, 3, has_near).size();
  };
  EXPECT_EQ(count(kBehind, false), 12);
  EXPECT_EQ(count(kBehind, true), 13);
  EXPECT_EQ(count(-kBehind, false), 12);
  EXPECT_EQ(count(kOverhead, false), 3);
  // A little from behind the sides show as well, and from a corner two of them.
  EXPECT_EQ(count(kOverhead + 0.1 * kBehind, false), 9);
  EXPECT_EQ(count({0.8, -0.9, -0.1}, false), 6);
}

// A lamp that sees the near face alone.
TEST(FaceCells, AreTheWholeViewWhenNoSideIsSeen) {
  MethodInput input = InputOf({1.0, 100.0, 0.5}, kBehind);
  input.light = Light::Point("lamp", {0.01, 0.0, -0.5});
  const std::vector<FaceCell> cells = FaceCells(input.light, input.camera, 2, true);
  ASSERT_EQ(cells.size(), 1);
  EXPECT_EQ(cells[0].side, -1);
  EXPECT_TRUE(cells[0].half_spaces.empty());
  input.light = Light::Point("lamp", Eigen::Vector3d::Zero());  // at the eye
  EXPECT_EQ(FaceCells(input.light, input.camera, 2, true).size(), 1);
}

// Along an edge of the view two faces are seen edge-on.
TEST(FaceCells, AreFiniteForLightsAlongEdges) {
  const LloydView view = {1.0, 100.0, 0.5};
  const double side = std::tan(0.5);
  for (const double sign : {1.0, -1.0}) {
    for (const double tilt : {0.0, 1e-12, 1e-7}) {
      const MethodInput input =
          InputOf(view, sign * Eigen::Vector3d(side, side * (1.0 + tilt), -1.0));
      const std::vector<FaceCell> cells = FaceCells(input.light, input.camera, 2, false);
      EXPECT_EQ(cells.size(), 4);
      for (const FaceCell& cell : cells) {
        for (const Eigen::Vector4d& plane : cell.half_spaces) {
          EXPECT_TRUE(plane.allFinite());
          EXPECT_NEAR(plane.head<3>().norm(), 1.0, 1e-9);
        }
      }
    }
  }
}

}  // namespace
}  // namespace lightfit
