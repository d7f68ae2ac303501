#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "calls/allocate_call.h"
#include "calls/pixel_buffer.h"
#include "optimizer/readback/surfaces.h"
#include "partition/fit_plans.h"
#include "tests/calls/requests.h"
#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"
#include "tests/testing/test_scene.h"
#include "wire/matrix_proto.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;

// A floor with two shadows and two lights: plans of it take milliseconds.
std::vector<Light> FloorLights() {
  return {Light::Directional("sun", {0.2, 0.3, -1.0}, 0), Light::Point("lamp", {1.0, 2.0, 5.0}, 1)};
}

v1::AllocateRequest PlanRequest() {
  testing::PlaneReadback floor = testing::FloorReadback();
  floor.Cast(0, [](int x, int y) { return x > 12 && x < 25 && y > 8 && y < 20; });
  floor.Cast(1, [](int x, int y) { return x + y > 35; });
  auto request = testing::RequestOf<v1::AllocateRequest>(floor.View(), FloorLights());
  request.set_budget_texels(8192);
  request.mutable_plan_options()->set_max_maps(2);
  return request;
}

TEST(AllocatePlans, DividesABudgetAsTheLibraryDoes) {
  v1::AllocateRequest request = PlanRequest();
  v1::LightWeight& weight = *request.add_weights();
  weight.set_light("lamp");
  weight.set_weight(3.0);
  const auto result = AnswerAllocate(request, CallContext());
  ASSERT_THAT(result, testing::IsOk());
  EXPECT_EQ(result->plan_options().max_maps(), 2);
  EXPECT_EQ(result->plan_options().texels(), request.budget_texels());
  EXPECT_LE(result->texels(), request.budget_texels());

  const auto readback = ReadbackView::Of(request.readback(), 2, CallLimits());
  ASSERT_THAT(readback, testing::IsOk());
  PlanOptions options;
  options.max_maps = 2;
  options.texels = request.budget_texels();
  const auto surfaces = FindSurfaces(readback->view(), 0x3, options.fit.samples);
  ASSERT_THAT(surfaces, testing::IsOk());
  std::vector<PlannedLight> lights;
  for (const Light& light : FloorLights()) lights.push_back({light, 1.0});
  lights[1].weight = 3.0;
  const LightPlans plans = FitPlans(*surfaces, lights, options);
  for (int i = 0; i < result->lights_size(); ++i) {
    ASSERT_THAT(plans[i], testing::IsOk());
    const v1::LightResult& light = result->lights(i);
    ASSERT_EQ(light.plan().maps_size(), static_cast<int>(plans[i]->maps.size()));
    for (int k = 0; k < light.plan().maps_size(); ++k) {
      EXPECT_EQ(light.plan().maps(k).map_from_world().SerializeAsString(),
                MatrixToProto(plans[i]->maps[k].map_from_world).SerializeAsString());
    }
    EXPECT_EQ(result->maps(i).texels(), NumTexels(PlanOf(*plans[i])));
  }
  // What the result says of its options may be asked for again.
  *request.mutable_plan_options() = result->plan_options();
  const auto again = AnswerAllocate(request, CallContext());
  ASSERT_THAT(again, testing::IsOk());
  EXPECT_EQ(again->SerializeAsString(), result->SerializeAsString());
}

TEST(AllocatePlans, SaysWhatDoesNotGoWithThem) {
  using Request = v1::AllocateRequest;
  const auto plan = [](Request* r) { return r->mutable_plan_options(); };
  const std::vector<testing::BadInput<Request>> bad = {
      {[](Request* r) {
         r->mutable_tolerance()->set_kind(v1::Tolerance::KIND_RMS);
         r->mutable_tolerance()->set_limit_px(1.0);
       },
       "plan_options: plans divide a budget, and a tolerance is for single maps; want "
       "budget_texels"},
      {[](Request* r) {
         r->clear_readback();
         r->clear_lights();
         r->add_summary_files("x");
       },
       "plan_options: a plan is fitted to the pixels of a read-back"},
      {[](Request* r) { r->mutable_rules()->set_min_side(32); },
       "rules: do not go with plan_options; want plan_options.sizes"},
      {[&](Request* r) { plan(r)->set_texels(4096); },
       "plan_options.texels = 4096: budget_texels = 8192 is what all maps of all lights have"},
      {[&](Request* r) { plan(r)->mutable_each()->set_width(32); }, "plan_options.each = 32x0: "},
      {[&](Request* r) { plan(r)->set_max_maps(33); }, "plan_options.max_maps = 33, want 1 ... 32"},
      {[&](Request* r) { plan(r)->mutable_sizes()->set_multiple(-2); },
       "plan_options.sizes.multiple = -2 texels"},
      {[](Request* r) { r->set_budget_texels(255); },
       "budget_texels = 255, want 256 ... 8589934592 for 2 lights of up to 2 maps each"},
      {[&](Request* r) { plan(r)->mutable_sizes()->set_min_side(64); },
       "budget_texels = 8192, want 16384 ... "},
      {[](Request* r) { r->set_budget_texels(int64_t{32} * 65536 * 65536); },
       "want 256 ... 8589934592 for 2 lights"},
      {[](Request* r) { r->mutable_options()->set_search(v1::SEARCH_FOCUSED); },
       "options.search = SEARCH_FOCUSED: the maps of a plan are searched in one way"},
      {[](Request* r) { r->mutable_options()->set_affine(v1::AFFINE_SKEWED_RECTANGLE); },
       "options.affine = AFFINE_SKEWED_RECTANGLE"}};
  testing::ExpectRefused(PlanRequest(), bad, AnswerAllocate);
  CallContext context;
  context.limits.max_maps = 1;
  const absl::Status status = AnswerAllocate(PlanRequest(), context).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("plan_options.max_maps = 2, and this server takes at most 1"));
}

TEST(AllocatePlans, ALightThatCannotBeUsedHasNoShare) {
  v1::AllocateRequest request = PlanRequest();
  request.mutable_lights(0)->clear_direction();
  const auto result = AnswerAllocate(request, CallContext());
  ASSERT_THAT(result, testing::IsOk());
  EXPECT_EQ(result->lights(0).status().code(), 3);
  EXPECT_EQ(result->maps(0).texels(), 0);
  EXPECT_EQ(result->lights(1).status().code(), 0);
  EXPECT_GT(result->maps(1).texels(), request.budget_texels() / 2);
}

TEST(AllocatePlans, StopsWhenTold) { testing::ExpectStops(PlanRequest(), AnswerAllocate); }

TEST(AllocatePlans, DamagedRequestsAreAnsweredOrRefused) {
  const testing::TestScene scene(3, 2, 24, 16);
  auto request = testing::RequestOf<v1::AllocateRequest>(scene.View(), scene.lights);
  request.set_budget_texels(10000);
  request.mutable_plan_options()->set_max_maps(2);
  request.mutable_plan_options()->set_guard_texels(1.0);
  request.mutable_plan_options()->mutable_sizes()->set_min_side(16);
  request.mutable_plan_options()->mutable_sizes()->set_multiple(8);
  // More maps are more work, and no more to survive.
  const auto answer = [](const v1::AllocateRequest& damaged, CallContext context) {
    context.limits.max_maps = 2;
    return AnswerAllocate(damaged, context);
  };
  testing::ExpectSurvivesMutations(request, answer, 150);
}

}  // namespace
}  // namespace lightfit
