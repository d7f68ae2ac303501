// The call Fit with plan_options: several maps for each light.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "calls/fit_call.h"
#include "io/lights_file.h"
#include "io/readback_exr.h"
#include "optimizer/fit.h"
#include "partition/fit_plan.h"
#include "tests/calls/fine_floor.h"
#include "tests/calls/requests.h"
#include "tests/io/summary_examples.h"
#include "tests/testing/plane_readback.h"
#include "wire/plan_proto.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::Yard;

v1::FitResult Answered(const v1::FitRequest& request) {
  const absl::StatusOr<v1::FitResult> result = AnswerFit(request, CallContext());
  EXPECT_THAT(result, testing::IsOk());
  return result.ok() ? *result : v1::FitResult();
}

v1::FitRequest YardRequest() {
  auto request = testing::RequestOf<v1::FitRequest>(Yard().file.View(), Yard().lights);
  request.mutable_plan_options()->set_texels(90000);
  return request;
}

// A floor with two shadows and two lights: a request of a few kilobytes.
v1::FitRequest FloorRequest() {
  testing::PlaneReadback floor = testing::FloorReadback();
  floor.Cast(0, [](int x, int y) { return x > 12 && x < 25 && y > 8 && y < 20; });
  floor.Cast(1, [](int x, int y) { return x + y > 35; });
  const std::vector<Light> lights = {Light::Directional("sun", {0.2, 0.3, -1.0}, 0),
                                     Light::Point("lamp", {1.0, 2.0, 5.0}, 1)};
  auto request = testing::RequestOf<v1::FitRequest>(floor.View(), lights);
  request.mutable_plan_options()->set_max_maps(2);
  request.mutable_plan_options()->set_texels(4096);
  return request;
}

// The room, whose lamp hangs among its receivers.
v1::FitRequest RoomRequest() {
  const std::string folder = testing::RepositoryFile("examples/room_180");
  const std::vector<Light> lights = ReadLightsFile(folder + "/scene.json").value();
  const ReadbackFile file = ReadReadbackExr(folder + "/0001.exr", lights).value();
  auto request = testing::RequestOf<v1::FitRequest>(file.View(), lights);
  request.mutable_options()->set_cover(v1::COVER_RECEIVERS);
  return request;
}

TEST(PlanCall, GivesTheLibrarysPlans) {
  const v1::FitResult result = Answered(YardRequest());
  PlanOptions options;
  options.texels = 90000;
  const auto surfaces = FindSurfaces(Yard().file.View(), LightMask(Yard().lights), {});
  ASSERT_THAT(surfaces, testing::IsOk());
  ASSERT_EQ(result.lights_size(), static_cast<int>(Yard().lights.size()));
  for (int l = 0; l < result.lights_size(); ++l) {
    const Light& light = Yard().lights[l];
    const v1::LightResult& answer = result.lights(l);
    const auto plan = FitPlan(*surfaces, light, options);
    ASSERT_THAT(plan, testing::IsOk());
    EXPECT_EQ(answer.plan().SerializeAsString(),
              PlanToProto(*plan, light, ClipConvention::Vulkan(), 0.0, true)->SerializeAsString());
    EXPECT_GT(answer.plan().maps_size(), 1);
    EXPECT_FALSE(answer.has_map_from_world());
    EXPECT_FALSE(answer.has_map());
    EXPECT_FALSE(answer.has_foretold_wrong());
    EXPECT_GT(answer.energies().final(), 0.0);
    EXPECT_GT(answer.footprint().rms(), 0.0);
    EXPECT_GT(answer.samples().used(), 0);
  }
  EXPECT_EQ(result.plan_options().SerializeAsString(),
            PlanOptionsToProto(options).SerializeAsString());
}

TEST(PlanCall, OneMapIsTheAnswerWithoutAPlan) {
  v1::FitRequest request = YardRequest();
  request.set_foretell_wrong(true);
  request.mutable_plan_options()->set_max_maps(1);
  v1::FitResult plans = Answered(request);
  request.clear_plan_options();
  request.mutable_map()->set_width(300);
  request.mutable_map()->set_height(300);
  const v1::FitResult matrices = Answered(request);
  plans.clear_plan_options();
  for (v1::LightResult& light : *plans.mutable_lights()) {
    ASSERT_EQ(light.plan().maps_size(), 1);
    EXPECT_EQ(light.plan().maps(0).map_from_world().SerializeAsString(),
              light.map_from_world().SerializeAsString());
    light.clear_plan();
  }
  EXPECT_EQ(plans.SerializeAsString(), matrices.SerializeAsString());
}

// It is told how many maps would do, and that does.
TEST(PlanCall, ALampAmongItsReceiversHasAPlan) {
  v1::FitRequest request = RoomRequest();
  request.mutable_map()->set_width(512);
  request.mutable_map()->set_height(512);
  const v1::FitResult single = Answered(request);
  int num_lamps = 0;
  for (const v1::LightResult& light : single.lights()) {
    if (light.status().code() == 0) continue;
    ++num_lamps;
    EXPECT_EQ(light.status().code(), static_cast<int>(absl::StatusCode::kFailedPrecondition));
    EXPECT_THAT(light.status().message(),
                HasSubstr("A plan of 2 maps (plan_options.max_maps = 2) would do"));
  }
  EXPECT_EQ(num_lamps, 1);
  request.clear_map();
  request.mutable_plan_options()->set_max_maps(2);
  const v1::FitResult several = Answered(request);
  for (const v1::LightResult& light : several.lights()) {
    EXPECT_EQ(light.status().code(), 0) << light.status().message();
    EXPECT_EQ(light.plan().maps_size(), 2);
  }
}

// A server that takes no plans of so many does not speak of them.
TEST(PlanCall, ALampIsNotToldOfMoreMapsThanTheServerTakes) {
  v1::FitRequest request = RoomRequest();
  request.mutable_map()->set_width(512);
  request.mutable_map()->set_height(512);
  CallContext context;
  context.limits.max_maps = 1;
  const absl::StatusOr<v1::FitResult> result = AnswerFit(request, context);
  ASSERT_THAT(result, testing::IsOk());
  int num_lamps = 0;
  for (const v1::LightResult& light : result->lights()) {
    if (light.status().code() == 0) continue;
    ++num_lamps;
    EXPECT_THAT(light.status().message(), HasSubstr("hangs among its receivers"));
    EXPECT_THAT(light.status().message(), Not(HasSubstr("would do")));
  }
  EXPECT_EQ(num_lamps, 1);
}

// What lies outside of the pixels' shadow has room, as in the library.
TEST(PlanCall, TakesAFinerCover) {
  const testing::ShadowReachesFurther scene;
  const std::vector<Light>& lights = scene.lights;
  Readback readback = scene.floor.View();
  v1::FitRequest request = testing::RequestOf<v1::FitRequest>(readback, lights);
  request.mutable_plan_options()->set_max_maps(2);
  request.mutable_plan_options()->set_texels(4096);
  const v1::FitResult without = Answered(request);
  readback.fine_cover = &scene.cover;
  *request.mutable_readback()->mutable_fine_cover() = testing::FineCoverMessage(scene.cover);
  const v1::FitResult with = Answered(request);
  PlanOptions options;
  options.max_maps = 2;
  options.texels = 4096;
  const auto surfaces = FindSurfaces(readback, LightMask(lights), {});
  ASSERT_THAT(surfaces, testing::IsOk());
  const auto plan = FitPlan(*surfaces, lights[0], options);
  ASSERT_THAT(plan, testing::IsOk());
  EXPECT_EQ(
      with.lights(0).plan().SerializeAsString(),
      PlanToProto(*plan, lights[0], ClipConvention::Vulkan(), 0.0, true)->SerializeAsString());
  EXPECT_NE(with.lights(0).plan().SerializeAsString(),
            without.lights(0).plan().SerializeAsString());
  request.mutable_options()->set_use_fine_cover(false);
  EXPECT_EQ(Answered(request).lights(0).plan().SerializeAsString(),
            without.lights(0).plan().SerializeAsString());
}

TEST(PlanCall, ALightThatCannotBeUsedFailsAlone) {
  v1::FitRequest request = FloorRequest();
  const v1::FitResult both = Answered(request);
  request.mutable_lights(0)->set_direction(1, std::numeric_limits<double>::quiet_NaN());
  const v1::FitResult one = Answered(request);
  EXPECT_EQ(one.lights(0).status().code(), 3);
  EXPECT_THAT(one.lights(0).status().message(), HasSubstr("direction"));
  EXPECT_FALSE(one.lights(0).has_plan());
  EXPECT_EQ(one.lights(1).SerializeAsString(), both.lights(1).SerializeAsString());
}

TEST(PlanCall, RefusesWhatCannotBeAnswered) {
  const auto plan = [](v1::FitRequest* request) { return request->mutable_plan_options(); };
  const std::vector<testing::BadInput<v1::FitRequest>> bad = {
      {[&](auto* r) { plan(r)->set_max_maps(0); }, "plan_options.max_maps = 0, want 1 ... 32"},
      {[&](auto* r) { plan(r)->set_max_maps(33); }, "plan_options.max_maps = 33, want 1 ... 32"},
      {[&](auto* r) { plan(r)->set_max_maps(-2000000000); }, "plan_options.max_maps"},
      {[&](auto* r) { plan(r)->set_texels(127); }, "plan_options.texels = 127, want 128 ..."},
      {[&](auto* r) { plan(r)->set_texels(std::numeric_limits<int64_t>::max()); },
       "plan_options.texels = 9223372036854775807"},
      {[&](auto* r) { plan(r)->set_guard_texels(-1.0); }, "plan_options.guard_texels = -1"},
      {[&](auto* r) { plan(r)->set_guard_texels(std::numeric_limits<double>::quiet_NaN()); },
       "plan_options.guard_texels = nan"},
      {[&](auto* r) { plan(r)->mutable_each()->set_width(64); },
       "plan_options.texels = 4096: is what all maps have together"},
      {[&](auto* r) {
         plan(r)->clear_texels();
         plan(r)->mutable_each()->set_width(64);
       },
       "plan_options.each = 64x0, want 1 ..."},
      {[&](auto* r) {
         plan(r)->clear_texels();
         plan(r)->mutable_each()->set_width(64);
         plan(r)->mutable_each()->set_height(32);
         plan(r)->set_guard_texels(16.0);
       },
       "plan_options.each = 64x32: the guard of 16 texels"},
      {[&](auto* r) {
         plan(r)->mutable_sizes()->set_min_side(40);
         plan(r)->mutable_sizes()->set_multiple(1);
         plan(r)->set_guard_texels(20.0);
       },
       "plan_options.sizes.min_side = 40: the guard of 20 texels"},
      {[&](auto* r) {
         plan(r)->mutable_sizes()->set_min_side(64);
         plan(r)->set_guard_texels(20.0);
         r->mutable_options()->set_margin_texels(12.0);
       },
       "plan_options.sizes.min_side = 64: the guard of 20 and the margin of 12 texels on every "
       "side "
       "leave nothing"},
      {[&](auto* r) { plan(r)->mutable_sizes()->set_multiple(-1); },
       "plan_options.sizes.multiple = -1 texels, want 1 or more"},
      {[](auto* r) { r->mutable_map()->set_width(64); }, "map: does not go with plan_options"},
      {[](auto* r) { r->mutable_options()->set_search(v1::SEARCH_FOCUSED); },
       "options.search = SEARCH_FOCUSED"},
      {[](auto* r) { r->mutable_options()->set_affine(v1::AFFINE_SKEWED_RECTANGLE); },
       "options.affine = AFFINE_SKEWED_RECTANGLE"},
      {[](auto* r) { r->mutable_options()->set_min_w(-1.0); }, "min_w"},
  };
  testing::ExpectRefused(FloorRequest(), bad, [](const auto& request, const auto& context) {
    return AnswerFit(request, context);
  });
  CallContext context;
  context.limits.max_maps = 1;
  const absl::Status status = AnswerFit(FloorRequest(), context).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()), HasSubstr("this server takes at most 1"));
}

// What a result says of its options may be asked for again.
TEST(PlanCall, TakesTheOptionsOfAResult) {
  v1::FitRequest request = FloorRequest();
  const v1::FitResult first = Answered(request);
  *request.mutable_options() = first.options();
  *request.mutable_plan_options() = first.plan_options();
  EXPECT_EQ(Answered(request).SerializeAsString(), first.SerializeAsString());
}

TEST(PlanCall, StopsWhenToldTo) {
  v1::FitRequest request = YardRequest();
  request.mutable_plan_options()->set_max_maps(6);
  testing::ExpectStops(request, [](const auto& request, const auto& context) {
    return AnswerFit(request, context);
  });
}

TEST(PlanCall, SurvivesWhateverComesIn) {
  testing::ExpectSurvivesMutations(
      FloorRequest(),
      [](v1::FitRequest request, const CallContext& context) {
        // 32 maps are as many times the work, and no more to survive.
        constexpr int kMaxMaps = 4;
        if (request.plan_options().max_maps() > kMaxMaps) {
          request.mutable_plan_options()->set_max_maps(kMaxMaps);
        }
        return AnswerFit(request, context);
      },
      200);
}

}  // namespace
}  // namespace lightfit
