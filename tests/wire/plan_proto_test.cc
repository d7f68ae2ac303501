#include "wire/plan_proto.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "tests/partition/random_plan.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"
#include "wire/matrix_proto.h"
#include "wire/proto_json.h"
#include "wire/result_json.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::Random;
using testing::RandomPlanLight;
using testing::RandomPlanMap;
using testing::StatusIs;

// What a fit says of a map that nobody fitted.
LightMatrix RandomMap(const Light& light, Border border, Random& random) {
  const PlanMap placed = RandomPlanMap(light, random);
  LightMatrix map;
  map.light_name = light.name;
  map.border = border;
  map.map = placed.size;
  map.map_from_world = placed.map_from_world;
  map.figures.energy = random.LogUniform(1e-3, 1e3);
  map.figures.footprint = {random.Uniform(0.0, 9.0), 0.2, 0.3, random.Uniform(0.0, 9.0)};
  map.figures.samples.used = random.Int(0, 5000);
  return map;
}

LightPlan RandomLightPlan(const Light& light, Random& random) {
  LightPlan plan;
  plan.light_name = light.name;
  plan.border = random.Coin() ? Border::kLit : Border::kDark;
  const int num_maps = random.Int(1, 8);
  for (int k = 0; k < num_maps; ++k) plan.maps.push_back(RandomMap(light, plan.border, random));
  return plan;
}

v1::Plan ThroughJson(const v1::Plan& plan) {
  v1::Plan read;
  const absl::StatusOr<std::string> json = ProtoToJson(plan);
  EXPECT_THAT(json, IsOk());
  EXPECT_THAT(JsonToProto(*json, read), IsOk());
  return read;
}

// The map that a point asks, by the words of result.proto and by nothing else; -1: none.
int AskedByTheMessage(const v1::Plan& plan, const Eigen::Vector3d& world) {
  int asked = -1;
  double least = std::numeric_limits<double>::infinity();
  for (const v1::PlanMap& map : plan.maps()) {
    const Eigen::Vector4d at =
        *MatrixFromProto(map.map_from_world(), "map_from_world") * world.homogeneous();
    if (!(at.w() > 0.0)) continue;
    const double u = at.x() / at.w(), v = at.y() / at.w(), guard = plan.guard_texels();
    if (!(u >= guard && u < map.map().width() - guard)) continue;
    if (!(v >= guard && v < map.map().height() - guard)) continue;
    const double q = map.coarseness() * at.w();
    if (q >= least) continue;
    least = q;
    asked = map.index();
  }
  return asked;
}

TEST(PlanProto, ReadsBackExactlyThroughJson) {
  Random random(11);
  for (int i = 0; i < 50; ++i) {
    const Light light = RandomPlanLight(random);
    const LightPlan plan = RandomLightPlan(light, random);
    const double guard = random.Uniform(0.0, 3.0);
    const absl::StatusOr<v1::Plan> written =
        PlanToProto(plan, light, ClipConvention::Direct3D(), guard, /*with_quantiles=*/true);
    ASSERT_THAT(written, IsOk());
    const v1::Plan read = ThroughJson(*written);
    EXPECT_EQ(read.SerializeAsString(), written->SerializeAsString());
    EXPECT_EQ(read.guard_texels(), guard);
    const absl::StatusOr<Plan> back = PlanFromProto(read, "plan");
    ASSERT_THAT(back, IsOk());
    EXPECT_EQ(back->border, plan.border);
    EXPECT_EQ(read.texels(), NumTexels(*back));
    ASSERT_EQ(back->maps.size(), plan.maps.size());
    for (size_t k = 0; k < plan.maps.size(); ++k) {
      EXPECT_EQ(back->maps[k].map_from_world, plan.maps[k].map_from_world);
      EXPECT_EQ(back->maps[k].size.width, plan.maps[k].map.width);
      EXPECT_EQ(back->maps[k].size.height, plan.maps[k].map.height);
      const v1::PlanMap& map = read.maps(static_cast<int>(k));
      EXPECT_EQ(map.energy(), plan.maps[k].figures.energy);
      EXPECT_EQ(map.footprint().rms(), plan.maps[k].figures.footprint.rms);
      EXPECT_EQ(map.footprint().worst(), plan.maps[k].figures.footprint.worst);
      EXPECT_EQ(map.samples(), plan.maps[k].figures.samples.used);
    }
  }
}

// Who has the message alone asks the same maps as who has the library.   math.md (20)
TEST(PlanProto, HasWhatALookUpNeeds) {
  Random random(12);
  int num_asked = 0, num_contested = 0;
  for (int i = 0; i < 50; ++i) {
    const Light light = RandomPlanLight(random);
    const LightPlan plan = RandomLightPlan(light, random);
    const double guard = random.Coin() ? 0.0 : random.Uniform(0.0, 10.0);
    const absl::StatusOr<v1::Plan> message =
        PlanToProto(plan, light, ClipConvention::Vulkan(), guard, /*with_quantiles=*/false);
    ASSERT_THAT(message, IsOk());
    const Plan library = PlanOf(plan);
    const absl::StatusOr<PlanLookUp> look_up = PlanLookUp::Create(library, light, guard);
    ASSERT_THAT(look_up, IsOk());
    for (int j = 0; j < 200; ++j) {
      const Eigen::Vector3d world = random.InCube(4.0);
      const PlanPlace place = look_up->At(world);
      EXPECT_EQ(AskedByTheMessage(*message, world), place.map);
      if (place.map < 0) continue;
      ++num_asked;
      Eigen::Vector2d texel;
      int num_askable = 0;
      for (int k = 0; k < look_up->num_maps(); ++k)
        num_askable += look_up->IsAskable(k, world, &texel);
      num_contested += num_askable > 1 ? 1 : 0;
    }
  }
  EXPECT_GT(num_asked, 1000);
  EXPECT_GT(num_contested, 300);
}

TEST(PlanProto, ClipFromWorldIsOfEachMapsOwnSize) {
  Random random(13);
  const Light light = RandomPlanLight(random);
  const LightPlan plan = RandomLightPlan(light, random);
  const ClipConvention clip = ClipConvention::ReversedZ();
  const absl::StatusOr<v1::Plan> message = PlanToProto(plan, light, clip, 0.0, true);
  ASSERT_THAT(message, IsOk());
  for (const v1::PlanMap& map : message->maps()) {
    const LightMatrix& fitted = plan.maps[map.index()];
    const Eigen::Matrix4d expected = ClipFromMap(fitted.map, clip) * fitted.map_from_world;
    EXPECT_EQ(*MatrixFromProto(map.clip_from_world(), "clip_from_world"), expected);
  }
}

TEST(PlanProto, SaysWhichFieldIsWrong) {
  Random random(14);
  const Light light = RandomPlanLight(random);
  LightPlan plan = RandomLightPlan(light, random);
  plan.maps.push_back(RandomMap(light, plan.border, random));
  const v1::Plan good = *PlanToProto(plan, light, ClipConvention::Vulkan(), 0.0, true);
  const auto refused = [&](const auto& damage, const std::string& words) {
    v1::Plan bad = good;
    damage(bad);
    EXPECT_THAT(
        PlanFromProto(bad, "light \"sun\": plan"),
        StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("light \"sun\": plan" + words)));
  };
  refused([](v1::Plan& bad) { bad.clear_maps(); }, ".maps: 0 of them, want 1 ... 32");
  refused([](v1::Plan& bad) { bad.mutable_maps(1)->set_index(5); }, ".maps[1].index = 5, want 1");
  refused([](v1::Plan& bad) { bad.mutable_maps(1)->clear_map(); }, ".maps[1]: map = 0x0");
  refused([](v1::Plan& bad) { bad.mutable_maps(0)->clear_map_from_world(); },
          ".maps[0].map_from_world: m has 0 numbers");
  refused([](v1::Plan& bad) { bad.set_border(static_cast<v1::Border>(9)); }, ".border = 9");
}

TEST(PlanProto, AGuardLeavesSomethingOfEveryMap) {
  Random random(15);
  const Light light = RandomPlanLight(random);
  v1::Plan plan = *PlanToProto(RandomLightPlan(light, random), light, {}, 0.0, true);
  plan.mutable_maps(0)->mutable_map()->set_width(40);
  plan.mutable_maps(0)->mutable_map()->set_height(30);
  const auto guard_of = [&plan](double guard_texels) {
    plan.set_guard_texels(guard_texels);
    return GuardTexelsFromProto(plan, "plan");
  };
  ASSERT_THAT(guard_of(1.25), IsOk());
  EXPECT_EQ(*guard_of(1.25), 1.25);
  EXPECT_THAT(
      guard_of(15.0),
      StatusIs(absl::StatusCode::kInvalidArgument,
               HasSubstr("plan.guard_texels = 15 leaves nothing of maps[0] of 40x30 texels, "
                         "want less than 15")));
  for (const double bad : {-0.5, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(guard_of(bad),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("plan.guard_texels = ")));
  }
}

TEST(PlanOptionsProto, ReadsBackAndSaysWhatIsWrong) {
  PlanOptions options;
  options.max_maps = 7;
  options.texels = 123456;
  options.guard_texels = 1.5;
  options.choose_by_forecast = false;
  absl::StatusOr<PlanOptions> back = PlanOptionsFromProto(PlanOptionsToProto(options), options.fit);
  ASSERT_THAT(back, IsOk());
  EXPECT_EQ(back->max_maps, 7);
  EXPECT_EQ(back->texels, 123456);
  EXPECT_FALSE(back->each.has_value());
  EXPECT_EQ(back->guard_texels, 1.5);
  EXPECT_FALSE(back->choose_by_forecast);
  options.each = MapSize{256, 128};
  back = PlanOptionsFromProto(PlanOptionsToProto(options), options.fit);
  ASSERT_THAT(back, IsOk());
  ASSERT_TRUE(back->each.has_value());
  EXPECT_EQ(back->each->width, 256);
  EXPECT_EQ(back->each->height, 128);
  // What is absent is the default.
  back = PlanOptionsFromProto(v1::PlanOptions(), options.fit);
  ASSERT_THAT(back, IsOk());
  EXPECT_EQ(PlanOptionsToProto(*back).SerializeAsString(),
            PlanOptionsToProto(PlanOptions()).SerializeAsString());
  v1::PlanOptions bad = PlanOptionsToProto(options);
  bad.set_max_maps(33);
  EXPECT_THAT(PlanOptionsFromProto(bad, options.fit),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("max_maps = 33")));
}

TEST(PlanOptionsProto, HasTheSizesThatMapsMayHave) {
  PlanOptions options;
  options.sizes = MapSizeRules{.multiple = 32, .min_side = 96, .max_side = 2048};
  const v1::PlanOptions proto = PlanOptionsToProto(options);
  const absl::StatusOr<PlanOptions> back = PlanOptionsFromProto(proto, options.fit);
  ASSERT_THAT(back, IsOk());
  ASSERT_TRUE(back->sizes.has_value());
  EXPECT_EQ(PlanOptionsToProto(*back).SerializeAsString(), proto.SerializeAsString());
  // Numbers of 0 are the defaults; both one size and several to choose from are too much.
  v1::PlanOptions few;
  few.mutable_sizes()->set_powers_of_two(true);
  const absl::StatusOr<PlanOptions> defaults = PlanOptionsFromProto(few, options.fit);
  ASSERT_THAT(defaults, IsOk());
  EXPECT_EQ(defaults->sizes->min_side, MapSizeRules().min_side);
  v1::PlanOptions bad = proto;
  bad.mutable_sizes()->set_min_side(4096);
  EXPECT_THAT(PlanOptionsFromProto(bad, options.fit),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("plan_options.sizes")));
  bad = proto;
  bad.clear_texels();
  bad.mutable_each()->set_width(256);
  bad.mutable_each()->set_height(256);
  EXPECT_THAT(PlanOptionsFromProto(bad, options.fit),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("plan_options.each")));
}

// A light with several maps has no single matrix, and one with one map has both.
TEST(PlanInResult, OfOneMapIsTheMatrixOfTheLightToo) {
  Random random(15);
  const Light light = RandomPlanLight(random);
  for (const size_t num_maps : {size_t{1}, size_t{3}}) {
    FitReport report;
    report.plan_options.emplace();
    LightFit& fit = report.lights.emplace_back();
    fit.light = light;
    fit.plan.emplace();
    while (fit.plan->plan.maps.size() < num_maps) {
      fit.plan->plan.maps.push_back(RandomMap(light, Border::kLit, random));
    }
    fit.plan->figures.energy = 4.0;
    fit.plan->figures.wrong_share = 0.125;
    fit.wrong_share = 0.25;
    fit.matrix = fit.plan->plan.maps[0];
    fit.one_map.emplace();
    fit.one_map->energy = 16.0;
    fit.one_map->wrong_share = 0.5;
    const v1::FitResult result = FitResultToProto(report);
    EXPECT_TRUE(result.has_plan_options());
    const v1::LightResult& proto = result.lights(0);
    ASSERT_EQ(proto.plan().maps_size(), static_cast<int>(num_maps));
    EXPECT_EQ(proto.has_map_from_world(), num_maps == 1);
    EXPECT_EQ(proto.has_clip_from_world(), num_maps == 1);
    EXPECT_EQ(proto.has_map(), num_maps == 1);
    EXPECT_TRUE(proto.has_clip());
    EXPECT_EQ(proto.foretold_wrong().one_map(), 0.5);
    EXPECT_EQ(proto.foretold_wrong().final(), num_maps == 1 ? 0.25 : 0.125);
    EXPECT_EQ(proto.energies().one_map(), 16.0);
    if (num_maps == 1) {
      EXPECT_EQ(proto.map_from_world().SerializeAsString(),
                proto.plan().maps(0).map_from_world().SerializeAsString());
    } else {
      EXPECT_EQ(proto.energies().final(), 4.0);
      EXPECT_EQ(proto.energies().final_over_one_map(), 0.25);
    }
  }
}

TEST(PlanInResult, ALightWithoutAPlanHasItsStatusAndNoSizes) {
  FitReport report;
  report.plan_options.emplace();
  report.lights.emplace_back().matrix = absl::FailedPreconditionError("no 2 maps");
  const v1::LightResult light = FitResultToProto(report).lights(0);
  EXPECT_EQ(light.status().message(), "no 2 maps");
  EXPECT_FALSE(light.has_plan());
  EXPECT_FALSE(light.has_map());
}

}  // namespace
}  // namespace lightfit
