#include "partition/published/z_partition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "methods/view_body.h"
#include "partition/published/storage_factor.h"
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

TEST(DepthSplits, AreAtEqualRatiosOrDistances) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const double near = random.LogUniform(1e-3, 10.0), far = near * random.LogUniform(1.01, 1e5);
    const int num_parts = random.Int(1, 12);
    const double mixed_share = random.Uniform(0.0, 1.0);
    const std::vector<double> ratios = DepthSplits(near, far, num_parts, 1.0);
    const std::vector<double> distances = DepthSplits(near, far, num_parts, 0.0);
    const std::vector<double> mixed = DepthSplits(near, far, num_parts, mixed_share);
    ASSERT_EQ(ratios.size(), num_parts + 1);
    EXPECT_EQ(mixed.front(), near);
    EXPECT_EQ(mixed.back(), far);
    for (int k = 1; k <= num_parts; ++k) {
      EXPECT_NEAR(ratios[k] / ratios[k - 1] / (ratios[1] / ratios[0]), 1.0, 1e-9);
      EXPECT_NEAR((distances[k] - distances[k - 1]) / (far - near) * num_parts, 1.0, 1e-9);
      EXPECT_GT(mixed[k], mixed[k - 1]);
      // Zhang 2006.
      const double expected = mixed_share * ratios[k] + (1.0 - mixed_share) * distances[k];
      EXPECT_NEAR(mixed[k] / expected, 1.0, 1e-12);
    }
  }
}

// (15), (16): of parts of ratio r the storage is in proportion to r - 1 with a warp and to r (r -
// 1) without.
struct Needs {
  double largest = 0.0, sum = 0.0;
};
Needs NeedsOf(const std::vector<double>& splits, bool warped) {
  Needs needs;
  for (size_t k = 1; k < splits.size(); ++k) {
    const double ratio = splits[k] / splits[k - 1];
    const double of_part = (warped ? 1.0 : ratio) * (ratio - 1.0);
    needs.largest = std::max(needs.largest, of_part);
    needs.sum += of_part;
  }
  return needs;
}

// No other splits have a smaller largest or sum of either.
TEST(DepthSplits, AtEqualRatiosNeedTheFewestTexels) {
  constexpr double kRounding = 1e-12;
  Random random(2);
  for (int i = 0; i < 2000; ++i) {
    const double alpha = random.LogUniform(2.0, 1e4);
    const int num_parts = random.Int(2, 8);
    std::vector<double> splits = {1.0, alpha};
    for (int k = 1; k < num_parts; ++k) splits.push_back(random.LogUniform(1.0, alpha));
    std::sort(splits.begin(), splits.end());
    const std::vector<double> equal = DepthSplits(1.0, alpha, num_parts, 1.0);
    for (const bool warped : {false, true}) {
      const Needs others = NeedsOf(splits, warped), ours = NeedsOf(equal, warped);
      EXPECT_GE(others.largest, ours.largest * (1.0 - kRounding));
      EXPECT_GE(others.sum, ours.sum * (1.0 - kRounding));
    }
  }
}

// (17), (18), (20), and (12) of one map: measured by fitting rectangles and warps to corners.
TEST(ZPartition, NeedsTheTexelsThatLloydFinds) {
  for (const double alpha : {20.0, 1000.0}) {
    const LloydView view = {1.0, alpha, M_PI / 6.0};
    for (const int num_maps : {1, 2, 4, 8, 16}) {
      ZPartitionOptions focused, warped;
      focused.num_maps = warped.num_maps = num_maps;
      focused.method = Method::kFocused;
      MethodInput input = InputOf(view, kOverhead);
      const auto storage = [&](const ZPartitionOptions& options) {
        const absl::StatusOr<Plan> plan = ZPartition(input, options);
        EXPECT_THAT(plan, IsOk());
        return *StorageFactor(*plan, input);
      };
      EXPECT_NEAR(storage(focused) / OverheadStorage(view, num_maps), 1.0, kFourDigits);
      EXPECT_NEAR(storage(warped) / OverheadWarpStorage(view, num_maps), 1.0, kFourDigits);
      input = InputOf(view, kBehind);
      EXPECT_NEAR(storage(focused) / BehindStorage(view, num_maps), 1.0, kFourDigits);
      EXPECT_NEAR(storage(warped) / BehindStorage(view, num_maps), 1.0, kFourDigits);
    }
  }
}

// 5.3: from no light more than two to three times as many as from behind.
TEST(ZPartition, NeedsTwiceTheTexelsOfALightBehindAtMost) {
  for (const double alpha : {20.0, 1000.0}) {
    for (const int num_maps : {1, 4}) {
      const LloydView view = {1.0, alpha, M_PI / 6.0};
      ZPartitionOptions options;
      options.num_maps = num_maps;
      double largest = 0.0;
      for (const Eigen::Vector3d& sun : testing::SunsAbove(6)) {
        const MethodInput input = InputOf(view, sun);
        const absl::StatusOr<Plan> plan = ZPartition(input, options);
        ASSERT_THAT(plan, IsOk());
        largest = std::max(largest, *StorageFactor(*plan, input));
      }
      EXPECT_LT(largest / BehindStorage(view, num_maps), 2.3) << alpha << " " << num_maps;
      EXPECT_GT(largest / BehindStorage(view, num_maps), 1.5) << alpha << " " << num_maps;
    }
  }
}

int NumServing(const Plan& plan, const Eigen::Vector3d& point) {
  int count = 0;
  for (const PlanMap& map : plan.maps) {
    const auto is_inside = [&](const Eigen::RowVector4d& half_space) {
      return half_space * point.homogeneous() >= 0.0;
    };
    count += std::all_of(map.half_spaces.begin(), map.half_spaces.end(), is_inside) ? 1 : 0;
  }
  return count;
}

// Every point of what is in view: in one slice, on its map, outside of the guard.
void ExpectServesTheView(const MethodInput& input,
                         const Plan& plan,
                         double guard_texels,
                         Random& random) {
  EXPECT_LE(NumTexels(plan), int64_t{input.map.width} * input.map.height);
  const auto look_up = PlanLookUp::Create(plan, input.light, guard_texels);
  ASSERT_THAT(look_up, IsOk());
  const std::vector<Eigen::Vector3d> body = ViewBody(input.camera, input.receivers);
  for (size_t k = 0; k < (body.empty() ? 0 : body.size() + 50); ++k) {
    const bool is_corner = k < body.size();
    const Eigen::Vector3d point = is_corner ? body[k] : testing::PointIn(random, body);
    // Points between two slices, which corners may be, are in both.
    if (!is_corner) {
      EXPECT_EQ(NumServing(plan, point), 1);
    }
    EXPECT_GE(NumServing(plan, point), 1);
    EXPECT_GE(look_up->At(point).map, 0);
  }
}

ZPartitionOptions RandomOptions(Random& random) {
  ZPartitionOptions options;
  options.num_maps = random.Int(1, 8);
  options.log_share = random.Coin() ? 1.0 : random.Uniform(0.0, 1.0);
  options.method = random.Coin() ? Method::kLispsm : Method::kFocused;
  options.shapes = PlanShapes{random.Int(0, 2)};
  options.margin_texels = random.Coin() ? 0.0 : 2.0;
  return options;
}

TEST(ZPartition, ServesEveryPointInView) {
  Random random(3);
  int num_plans = 0, num_lamps = 0, num_left_out = 0;
  for (int i = 0; i < 300; ++i) {
    MethodInput input = testing::RandomInput(random);
    input.map = {random.Int(100, 2000), random.Int(100, 2000)};
    const ZPartitionOptions options = RandomOptions(random);
    const absl::StatusOr<Plan> plan = ZPartition(input, options);
    if (!plan.ok()) {
      // Only a lamp may be in the way, and only among what is to be covered.
      EXPECT_THAT(plan, StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("\"lamp\"")));
      continue;
    }
    ++num_plans;
    num_lamps += input.light.kind == Light::Kind::kPoint ? 1 : 0;
    num_left_out += options.num_maps - static_cast<int>(plan->maps.size());
    ExpectServesTheView(input, *plan, options.margin_texels, random);
  }
  EXPECT_GT(num_plans, 200);
  EXPECT_GT(num_lamps, 60);
  EXPECT_GT(num_left_out, 100);
}

TEST(ZPartition, ServesTheViewUnderLightsBehindAboveAndFromLamps) {
  Random random(4);
  const LloydView view = {0.5, 50.0, 0.5};
  MethodInput input = InputOf(view, kBehind);
  input.map = {400, 400};
  for (const Light& light : {Light::Directional("sun", kBehind),
                             Light::Directional("sun", -kBehind),
                             Light::Directional("sun", kOverhead),
                             Light::Point("lamp", {0.0, 90.0, -20.0}),
                             Light::Point("lamp", {0.0, 0.0, 150.0}),
                             Light::Point("lamp", {1.0, 0.0, -200.0})}) {
    input.receivers = {Eigen::Vector3d::Constant(-60.0), Eigen::Vector3d::Constant(60.0)};
    input.light = light;
    for (int num_maps = 1; num_maps <= 5; ++num_maps) {
      ZPartitionOptions options = RandomOptions(random);
      options.num_maps = num_maps;
      const absl::StatusOr<Plan> plan = ZPartition(input, options);
      ASSERT_THAT(plan, IsOk());
      EXPECT_EQ(plan->maps.size(), num_maps);
      ExpectServesTheView(input, *plan, options.margin_texels, random);
    }
  }
}

TEST(ZPartition, LeavesOutSlicesWithoutReceivers) {
  MethodInput input = InputOf({1.0, 10000.0, 0.5}, kOverhead);
  input.map = {600, 600};
  // Depths 15 to 800: slices of a tenfold each, the first and the last without receivers.
  input.receivers = {Eigen::Vector3d(-5.0, -5.0, -800.0), Eigen::Vector3d(5.0, 5.0, -15.0)};
  ZPartitionOptions options;
  options.num_maps = 4;
  const absl::StatusOr<Plan> plan = ZPartition(input, options);
  ASSERT_THAT(plan, IsOk());
  ASSERT_EQ(plan->maps.size(), 2);
  EXPECT_EQ(plan->maps[0].size.width, 424);  // 600 / sqrt(2): they share all texels
  ASSERT_EQ(plan->maps[0].half_spaces.size(), 1);
  ASSERT_EQ(plan->maps[1].half_spaces.size(), 1);
  EXPECT_EQ(plan->maps[0].half_spaces[0], -plan->maps[1].half_spaces[0]);
  EXPECT_NEAR(plan->maps[1].half_spaces[0] * Eigen::Vector4d(0.0, 0.0, -100.0, 1.0), 0.0, 1e-9);
  EXPECT_GT(plan->maps[1].half_spaces[0] * Eigen::Vector4d(0.0, 0.0, -101.0, 1.0), 0.0);
  Random random(5);
  ExpectServesTheView(input, *plan, 0.0, random);
}

TEST(ZPartition, OfOneMapIsTheMethod) {
  Random random(6);
  for (int i = 0; i < 100; ++i) {
    MethodInput input = testing::RandomInput(random);
    input.map = {300, 300};
    ZPartitionOptions options;
    options.num_maps = 1;
    options.method = AllMethods()[random.Int(0, static_cast<int>(AllMethods().size()) - 1)];
    const absl::StatusOr<Plan> plan = ZPartition(input, options);
    const absl::StatusOr<MethodMap> map = SetUpMap(options.method, input);
    ASSERT_EQ(plan.ok(), map.ok()) << i;
    if (!plan.ok()) continue;
    ASSERT_EQ(plan->maps.size(), 1);
    EXPECT_TRUE(plan->maps[0].half_spaces.empty());
    for (const Eigen::Vector3d& point : ViewBody(input.camera, input.receivers)) {
      const Eigen::Vector2d texel =
          (plan->maps[0].map_from_world * point.homogeneous()).hnormalized().head<2>();
      EXPECT_LE((texel - testing::Texel(*map, point)).norm(), 1e-5 * input.map.width) << i;
    }
  }
}

TEST(ZPartition, HasOneMapWhenNothingIsInView) {
  MethodInput input = testing::LevelView(kOverhead);
  input.receivers = {Eigen::Vector3d(-1.0, -1.0, 5.0), Eigen::Vector3d(1.0, 1.0, 9.0)};
  const absl::StatusOr<Plan> plan = ZPartition(input);
  ASSERT_THAT(plan, IsOk());
  ASSERT_EQ(plan->maps.size(), 1);
  const auto look_up = PlanLookUp::Create(*plan, input.light);
  ASSERT_THAT(look_up, IsOk());
  for (const Eigen::Vector3d& corner : BoxCorners(input.receivers)) {
    EXPECT_EQ(look_up->At(corner).map, 0);
  }
}

TEST(ZPartition, OfDegenerateInputIsFiniteOrSaysWhy) {
  Random random(7);
  int num_plans = 0;
  for (int i = 0; i < 400; ++i) {
    const MethodInput input = testing::DegenerateInput(random);
    ZPartitionOptions options = RandomOptions(random);
    options.margin_texels = 0.0;
    const absl::StatusOr<Plan> plan = ZPartition(input, options);
    if (!plan.ok()) {
      EXPECT_EQ(plan.status().code(), absl::StatusCode::kFailedPrecondition) << plan.status();
      continue;
    }
    ++num_plans;
    testing::ExpectFinite(*plan, input);
  }
  EXPECT_GT(num_plans, 150);
}

TEST(ZPartition, NamesAWrongOption) {
  const MethodInput input = testing::LevelView(kOverhead);
  ZPartitionOptions options;
  options.num_maps = 33;
  EXPECT_THAT(ZPartition(input, options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("num_maps = 33")));
  options = {};
  options.log_share = std::nan("");
  EXPECT_THAT(ZPartition(input, options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("log_share = nan")));
  options = {};
  options.margin_texels = -1.0;
  EXPECT_THAT(ZPartition(input, options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("margin_texels = -1")));
  MethodInput endless = input;
  endless.camera.far = std::numeric_limits<double>::infinity();
  EXPECT_THAT(ZPartition(endless),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("far = inf")));
}

}  // namespace
}  // namespace lightfit
