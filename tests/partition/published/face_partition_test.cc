#include "partition/published/face_partition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "methods/view_body.h"
#include "partition/published/storage_factor.h"
#include "partition/published/z_partition.h"
#include "tests/methods/random_input.h"
#include "tests/partition/published/degenerate_input.h"
#include "tests/partition/published/lloyd_view.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::InputOf;
using testing::IsOk;
using testing::kBehind;
using testing::kFourDigits;
using testing::kOverhead;
using testing::Random;
using testing::StatusIs;

double StorageOf(const MethodInput& input, const FacePartitionOptions& options) {
  const absl::StatusOr<Plan> plan = FacePartition(input, options);
  EXPECT_THAT(plan, IsOk());
  const absl::StatusOr<double> storage = StorageFactor(*plan, input);
  EXPECT_THAT(storage, IsOk());
  return storage.ok() ? *storage : 0.0;
}

// (19), (21), by fitting warps to the faces' corners.
TEST(FacePartition, NeedsTheTexelsThatLloydFinds) {
  for (const double alpha : {20.0, 1000.0}) {
    for (const double half_angle : {M_PI / 6.0, 0.9}) {
      const LloydView view = {1.0, alpha, half_angle};
      for (const int num_parts : {1, 2, 3, 5}) {
        FacePartitionOptions options;
        options.num_parts = num_parts;
        options.has_near_face = true;
        const double behind = StorageOf(InputOf(view, kBehind), options);
        EXPECT_NEAR(behind / BehindFaceWarpStorage(view, num_parts), 1.0, kFourDigits);
        options.has_near_face = false;
        const double overhead = StorageOf(InputOf(view, kOverhead), options);
        EXPECT_NEAR(overhead / OverheadWarpStorage(view, num_parts), 1.0, kFourDigits);
      }
    }
  }
}

// 5.2: "the near plane can be covered with only a slight increase in error", in deep views.
TEST(FacePartition, IsStretchedOverTheNearPlaneAtLittleCost) {
  for (const double alpha : {1e3, 1e4}) {
    const LloydView view = {1.0, alpha, M_PI / 6.0};
    const double stretched = StorageOf(InputOf(view, kBehind), {});
    EXPECT_GT(stretched / BehindFaceWarpStorage(view, 1), 1.0);
    EXPECT_LT(stretched / BehindFaceWarpStorage(view, 1), 1.05);
  }
}

// 5.3: from no light more than two to three times as many as from behind, down to the light that
// sees a face nearly edge-on.
TEST(FacePartition, NeedsThreeTimesTheTexelsOfALightBehindAtMost) {
  Random random(1);
  for (const double alpha : {20.0, 1000.0}) {
    for (const int num_parts : {1, 2, 4}) {
      const LloydView view = {1.0, alpha, M_PI / 6.0};
      FacePartitionOptions options;
      options.num_parts = num_parts;
      std::vector<Eigen::Vector3d> suns = testing::SunsAbove(6);
      for (int i = 0; i < 60; ++i) {
        // Near the plane of a side face.
        const double tilt = random.Coin() ? 0.0 : random.LogUniform(1e-4, 0.1);
        const double around = random.Uniform(-2.0, 2.0);
        suns.emplace_back(around * std::tan(M_PI / 6.0), -std::tan(M_PI / 6.0 + tilt), -1.0);
      }
      double largest = 0.0;
      for (const Eigen::Vector3d& sun : suns) {
        largest = std::max(largest, StorageOf(InputOf(view, sun), options));
      }
      const double ratio = largest / BehindFaceWarpStorage(view, num_parts);
      EXPECT_LT(ratio, 3.0) << alpha << " " << num_parts;
      EXPECT_GT(ratio, 1.3) << alpha << " " << num_parts;
    }
  }
}

// Figure 7 on a coarse grid of suns: where they are counted changes the means by a few per cent.
TEST(LloydFigure7, MeansOverTheHemisphere) {
  constexpr double kGrid = 0.1;
  for (const testing::LloydFigures::Mean& mean : testing::LloydFigures::kMeans) {
    const LloydView view = {1.0, mean.alpha, M_PI / 6.0};
    double log_unwarped = 0.0, log_warped = 0.0, log_faces = 0.0;
    const std::vector<Eigen::Vector3d> suns = testing::SunsAbove(8);
    for (const Eigen::Vector3d& sun : suns) {
      const MethodInput input = InputOf(view, sun);
      const auto storage = [&](const absl::StatusOr<Plan>& plan) {
        EXPECT_THAT(plan, IsOk());
        return std::log(*StorageFactor(*plan, input));
      };
      ZPartitionOptions z;
      z.num_maps = mean.parts;
      log_warped += storage(ZPartition(input, z));
      z.method = Method::kFocused;
      log_unwarped += storage(ZPartition(input, z));
      FacePartitionOptions faces;
      faces.num_parts = mean.parts;
      faces.has_near_face = true;
      log_faces += storage(FacePartition(input, faces));
    }
    const double count = static_cast<double>(suns.size());
    EXPECT_NEAR(std::exp(log_warped / count) / mean.warped, 1.0, kGrid);
    EXPECT_NEAR(std::exp(log_faces / count) / mean.faces, 1.0, kGrid);
    // Our focused map is the rectangle of least area, theirs lies along the view.
    EXPECT_LT(std::exp(log_unwarped / count), mean.unwarped);
    EXPECT_GT(std::exp(log_unwarped / count), 0.8 * mean.unwarped);
  }
}

// The warp of a trapezoid on which depth rises from z0 to z1 has n' = L / (sqrt(z1/z0) - 1), so
// that w at its ends is as 1 to sqrt(z1/z0).
TEST(FacePartition, WarpsATrapezoidAsLightSpacePerspectiveMaps) {
  for (const double alpha : {2.0, 20.0, 1000.0}) {
    const MethodInput input = InputOf({1.0, alpha, 0.6}, kBehind);
    FacePartitionOptions options;
    options.has_near_face = true;
    const absl::StatusOr<Plan> plan = FacePartition(input, options);
    ASSERT_THAT(plan, IsOk());
    ASSERT_EQ(plan->maps.size(), 5);
    for (size_t k = 0; k < 4; ++k) {
      const PlanMap& map = plan->maps[k];
      std::vector<Eigen::Vector4d> cuts;
      for (const auto& half_space : map.half_spaces) cuts.emplace_back(half_space.transpose());
      double least = 1e300, greatest = 0.0;
      for (const Eigen::Vector3d& corner : ViewBody(input.camera, input.receivers, cuts)) {
        const double w = map.map_from_world.row(3) * corner.homogeneous();
        least = std::min(least, w);
        greatest = std::max(greatest, w);
      }
      // The minimum is found to half of the digits.
      EXPECT_NEAR(greatest / least / std::sqrt(alpha), 1.0, 1e-6);
    }
    // The near face is not warped.
    EXPECT_LE(plan->maps[4].map_from_world.row(3).head<3>().norm(), 1e-12);
  }
}

// M_v of a cell's map when v is warped once more: v' = (1 + m) v / (1 + m v).
double ErrorWarpedBy(const MethodInput& input,
                     const PlanMap& map,
                     const std::vector<Eigen::Vector3d>& corners,
                     double more) {
  double largest = 0.0;
  for (const Eigen::Vector3d& corner : corners) {
    const auto errors = MaxBeamErrors(map.map_from_world, input.light, input.camera, {&corner, 1});
    EXPECT_THAT(errors, IsOk());
    const double v = (map.map_from_world * corner.homogeneous()).hnormalized().y();
    const double stretch = 1.0 + more * v / map.size.height;
    largest = std::max(largest, errors->v * stretch * stretch / (1.0 + more));
  }
  return largest;
}

// No other warp along a face has less error, under suns from anywhere.
TEST(FacePartition, WarpsEachCellByLeastError) {
  // Whatever lies within the millionth around a map.
  constexpr double kMargin = 1e-4;
  Random random(2);
  int num_maps = 0;
  for (int i = 0; i < 60; ++i) {
    MethodInput input = testing::RandomInput(random);
    input.light = Light::Directional("sun", random.UnitVector());
    input.map = {4000, 4000};
    FacePartitionOptions options;
    options.num_parts = random.Int(1, 2);
    const absl::StatusOr<Plan> plan = FacePartition(input, options);
    ASSERT_THAT(plan, IsOk());
    for (const PlanMap& map : plan->maps) {
      std::vector<Eigen::Vector4d> cuts;
      for (const auto& half_space : map.half_spaces) cuts.emplace_back(half_space.transpose());
      const auto corners = ViewBody(input.camera, input.receivers, cuts);
      if (corners.empty()) continue;
      // v grows outwards or, where the map is turned over, inwards; w along it.
      double w_first = 0.0, w_last = 0.0, v_first = 1e300, v_last = -1e300;
      for (const Eigen::Vector3d& corner : corners) {
        const Eigen::Vector4d at = map.map_from_world * corner.homogeneous();
        const double v = at.y() / at.w();
        if (v < v_first) v_first = v, w_first = at.w();
        if (v > v_last) v_last = v, w_last = at.w();
      }
      const double ratio = w_last / w_first;
      const double least = ErrorWarpedBy(input, map, corners, 0.0);
      for (int k = 0; k < 30; ++k) {
        // The warp in all, which a focused map may lack, but does not turn around.
        const double more = random.LogUniform(0.02, 50.0) - 1.0;
        const bool turns = ratio >= 1.0 - 1e-6 && (1.0 + more) * ratio >= 1.0;
        const bool turns_over = ratio <= 1.0 + 1e-6 && (1.0 + more) * ratio <= 1.0;
        if (!turns && !turns_over) continue;
        if (std::abs(ratio - 1.0) < 1e-6) continue;  // a fallback, or no side is known
        EXPECT_GE(ErrorWarpedBy(input, map, corners, more), least * (1.0 - kMargin)) << i;
        ++num_maps;
      }
    }
  }
  EXPECT_GT(num_maps, 1000);
}

TEST(FacePartition, ServesEveryPointInView) {
  Random random(3);
  int num_plans = 0, num_lamps = 0;
  size_t most_maps = 0;
  for (int i = 0; i < 300; ++i) {
    MethodInput input = testing::RandomInput(random);
    input.map = {random.Int(200, 2000), random.Int(200, 2000)};
    FacePartitionOptions options;
    options.num_parts = random.Int(1, 4);
    options.warp = random.Coin();
    options.has_near_face = random.Coin();
    options.shapes = PlanShapes{random.Int(0, 2)};
    options.margin_texels = random.Coin() ? 0.0 : 2.0;
    const absl::StatusOr<Plan> plan = FacePartition(input, options);
    if (!plan.ok()) {
      EXPECT_THAT(plan, StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("\"lamp\"")));
      continue;
    }
    ++num_plans;
    num_lamps += input.light.kind == Light::Kind::kPoint ? 1 : 0;
    most_maps = std::max(most_maps, plan->maps.size());
    EXPECT_LE(NumTexels(*plan), int64_t{input.map.width} * input.map.height);
    const auto look_up = PlanLookUp::Create(*plan, input.light, options.margin_texels);
    ASSERT_THAT(look_up, IsOk());
    const std::vector<Eigen::Vector3d> body = ViewBody(input.camera, input.receivers);
    for (size_t k = 0; k < (body.empty() ? 0 : body.size() + 50); ++k) {
      const bool is_corner = k < body.size();
      const Eigen::Vector3d point = is_corner ? body[k] : testing::PointIn(random, body);
      int num_serving = 0;
      for (const PlanMap& map : plan->maps) {
        const auto holds = [&](const auto& plane) { return plane * point.homogeneous() >= 0.0; };
        num_serving += std::all_of(map.half_spaces.begin(), map.half_spaces.end(), holds) ? 1 : 0;
      }
      // Corners may lie between cells, and so be in several.
      if (is_corner) {
        EXPECT_GE(num_serving, 1) << i;
      } else {
        EXPECT_EQ(num_serving, 1) << i;
      }
      EXPECT_GE(look_up->At(point).map, 0) << i;
    }
  }
  EXPECT_GT(num_plans, 200);
  EXPECT_GT(num_lamps, 60);
  EXPECT_GT(most_maps, 9);
}

// Faces far from alike get texels by what they need.
TEST(FacePartition, HasTheSameErrorInAllCells) {
  const MethodInput input = InputOf({1.0, 100.0, 0.5}, {0.3, -1.0, -0.4});
  const absl::StatusOr<Plan> plan = FacePartition(input);
  ASSERT_THAT(plan, IsOk());
  ASSERT_GE(plan->maps.size(), 2);
  std::vector<double> errors;
  for (const PlanMap& map : plan->maps) {
    Plan alone;
    alone.maps.push_back(map);
    errors.push_back(*StorageFactor(alone, input) / NumTexels(alone));
  }
  const auto [least, greatest] = std::minmax_element(errors.begin(), errors.end());
  EXPECT_NEAR(*greatest / *least, 1.0, 1e-2);
}

TEST(FacePartition, HasOneFocusedMapWithoutPerspective) {
  MethodInput input = testing::LevelView(kOverhead);
  input.camera.orthographic = true;
  input.camera.screen_from_camera.topLeftCorner<2, 2>() *= 0.1;
  const absl::StatusOr<Plan> orthographic = FacePartition(input);
  ASSERT_THAT(orthographic, IsOk());
  EXPECT_EQ(orthographic->maps.size(), 1);
  input = testing::LevelView(kOverhead);
  input.receivers = {Eigen::Vector3d(-1.0, -1.0, 5.0), Eigen::Vector3d(1.0, 1.0, 9.0)};
  const absl::StatusOr<Plan> empty = FacePartition(input);
  ASSERT_THAT(empty, IsOk());
  ASSERT_EQ(empty->maps.size(), 1);
  const auto look_up = PlanLookUp::Create(*empty, input.light);
  ASSERT_THAT(look_up, IsOk());
  EXPECT_EQ(look_up->At({0.5, 0.5, 7.0}).map, 0);
}

TEST(FacePartition, OfDegenerateInputIsFiniteOrSaysWhy) {
  Random random(7);
  int num_plans = 0;
  for (int i = 0; i < 400; ++i) {
    const MethodInput input = testing::DegenerateInput(random);
    FacePartitionOptions options;
    options.num_parts = random.Int(1, 3);
    options.has_near_face = random.Coin();
    options.shapes = PlanShapes{random.Int(0, 2)};
    const absl::StatusOr<Plan> plan = FacePartition(input, options);
    if (!plan.ok()) {
      EXPECT_EQ(plan.status().code(), absl::StatusCode::kFailedPrecondition) << plan.status();
      continue;
    }
    ++num_plans;
    testing::ExpectFinite(*plan, input);
  }
  EXPECT_GT(num_plans, 150);
}

TEST(FacePartition, NamesAWrongOption) {
  const MethodInput input = InputOf({1.0, 20.0, 0.5}, kBehind);
  FacePartitionOptions options;
  options.num_parts = 0;
  EXPECT_THAT(FacePartition(input, options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("num_parts = 0")));
  options.num_parts = 9;
  EXPECT_THAT(FacePartition(input, options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("a plan of 36 maps")));
  options = {};
  options.margin_texels = std::nan("");
  EXPECT_THAT(FacePartition(input, options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("margin_texels = nan")));
}

}  // namespace
}  // namespace lightfit
