#include "calls/compare/compare_call.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "tests/calls/requests.h"
#include "tests/io/summary_examples.h"
#include "tests/testing/test_scene.h"
#include "wire/matrix_proto.h"

namespace lightfit {
namespace {

using testing::Yard;

v1::CompareRequest YardRequest() {
  auto request = testing::RequestOf<v1::CompareRequest>(Yard().file.View(), Yard().lights);
  request.mutable_lights()->RemoveLast();  // two of them will do
  request.mutable_map()->set_width(400);
  request.mutable_map()->set_height(400);
  return request;
}

TEST(CompareCall, HasEveryMethodOfEveryLight) {
  const auto result = AnswerCompare(YardRequest(), CallContext());
  ASSERT_THAT(result, testing::IsOk());
  ASSERT_EQ(result->lights_size(), static_cast<int>(Yard().lights.size()) - 1);
  for (const v1::LightComparison& light : result->lights()) {
    EXPECT_EQ(light.methods_size(), result->totals_size());
    const v1::MethodComparison& ours = *light.methods().rbegin();
    EXPECT_EQ(ours.method(), "lightfit");
    EXPECT_EQ(ours.energy_ratio(), 1.0);
    for (const v1::MethodComparison& method : light.methods()) {
      EXPECT_FALSE(method.has_wrong());  // which takes a scene
      EXPECT_TRUE(method.status().code() != 0 || method.has_foretold_share()) << method.method();
    }
  }
}

TEST(CompareCall, BadInputsAreNamed) {
  using Request = v1::CompareRequest;
  const std::vector<testing::BadInput<Request>> bad = {
      {[](Request* r) { r->clear_lights(); }, "lights"},
      {[](Request* r) { r->clear_map(); }, "map = 0x0"},
      {[](Request* r) { r->mutable_readback()->clear_depth(); }, "depth"},
      {[](Request* r) { r->mutable_options()->set_min_w(2.0); }, "min_w"},
      {[](Request* r) { r->add_given(); }, "given[0]: name: is empty"},
      {[](Request* r) {
         r->add_given()->set_name("engine");
         r->mutable_given(0)->add_matrices()->set_light("sun");
       },
       "given[0]: matrices[0]: map = 0x0"},
      {[](Request* r) {
         r->add_given()->set_name("engine");
         for (int i = 0; i < 1025; ++i) r->mutable_given(0)->add_matrices();
       },
       "given: 1025 matrices, and this server takes at most 1024",
       absl::StatusCode::kResourceExhausted}};
  testing::ExpectRefused(YardRequest(), bad, &AnswerCompare);
}

TEST(CompareCall, StopsWhenItIsTold) {
  v1::CompareRequest request = YardRequest();
  while (request.lights_size() > 1) request.mutable_lights()->RemoveLast();
  testing::ExpectStops(request, &AnswerCompare);
}

TEST(CompareCall, DamagedRequestsAreAnsweredOrRefused) {
  const testing::TestScene scene(3, 2, 24, 16);
  auto request = testing::RequestOf<v1::CompareRequest>(scene.View(), scene.lights);
  request.mutable_map()->set_width(64);
  request.mutable_map()->set_height(64);
  testing::ExpectSurvivesMutations(request, &AnswerCompare, 300);
}

}  // namespace
}  // namespace lightfit
