#include "calls/fit_call.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "optimizer/evaluate.h"
#include "optimizer/fit.h"
#include "tests/calls/fine_floor.h"
#include "tests/calls/requests.h"
#include "tests/io/summary_examples.h"
#include "tests/testing/plane_readback.h"
#include "wire/options_proto.h"
#include "wire/result_json.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::kMap;
using testing::Yard;

v1::FitRequest WithMap(v1::FitRequest request) {
  request.mutable_map()->set_width(kMap.width);
  request.mutable_map()->set_height(kMap.height);
  return request;
}

v1::FitRequest YardRequest() {
  return WithMap(testing::RequestOf<v1::FitRequest>(Yard().file.View(), Yard().lights));
}

// A floor with one shadow and two lights: a request of a few kilobytes.
v1::FitRequest FloorRequest() {
  testing::PlaneReadback floor = testing::FloorReadback();
  floor.Cast(0, [](int x, int y) { return x > 12 && x < 25 && y > 8 && y < 20; });
  floor.Cast(1, [](int x, int y) { return x + y > 35; });
  const std::vector<Light> lights = {Light::Directional("sun", {0.2, 0.3, -1.0}, 0),
                                     Light::Point("lamp", {1.0, 2.0, 5.0}, 1)};
  return WithMap(testing::RequestOf<v1::FitRequest>(floor.View(), lights));
}

TEST(FitCall, GivesTheLibrarysMatrices) {
  v1::FitRequest request = YardRequest();
  request.mutable_readback()->set_source("0001.exr");
  request.set_foretell_wrong(true);
  request.mutable_options()->set_metric(v1::METRIC_L2);
  FitOptions options;
  options.metric = Metric::kL2;
  FitReport report;
  report.source = "0001.exr";
  report.camera = Yard().file.camera;
  report.depth_kind = Yard().file.depth_kind;
  report.options = options;
  report.map = kMap;
  for (const Light& light : Yard().lights) {
    LightFit& fit = report.lights.emplace_back();
    fit.light = light;
    fit.matrix = FitLight(Yard().file.View(), light, kMap, options);
    if (!fit.matrix.ok()) continue;
    fit.wrong_share =
        EvaluateMatrix(Yard().file.View(), light, fit.matrix->map_from_world, kMap, options)
            ->wrong_share;
  }
  const auto result = AnswerFit(request, CallContext());
  ASSERT_THAT(result, testing::IsOk());
  EXPECT_EQ(result->SerializeAsString(), FitResultToProto(report).SerializeAsString());
}

TEST(FitCall, TellsMatricesInTheClipConventionAskedFor) {
  v1::FitRequest request = FloorRequest();
  *request.mutable_clip() = ClipConventionToProto(ClipConvention::OpenGl());
  const auto result = AnswerFit(request, CallContext());
  ASSERT_THAT(result, testing::IsOk());
  const v1::LightResult& light = result->lights(0);
  EXPECT_EQ(light.clip().name(), "opengl");
  const Eigen::Matrix4d map_from_world = *MatrixFromProto(light.map_from_world(), "m");
  EXPECT_EQ(*MatrixFromProto(light.clip_from_world(), "m"),
            ClipFromMap(kMap, ClipConvention::OpenGl()) * map_from_world);
}

TEST(FitCall, ALightThatCannotBeUsedFailsAlone) {
  v1::FitRequest request = FloorRequest();
  const auto both = AnswerFit(request, CallContext());
  ASSERT_THAT(both, testing::IsOk());
  request.mutable_lights(0)->set_direction(1, std::numeric_limits<double>::quiet_NaN());
  const auto result = AnswerFit(request, CallContext());
  ASSERT_THAT(result, testing::IsOk());
  EXPECT_EQ(result->lights(0).name(), "sun");
  EXPECT_EQ(result->lights(0).status().code(), 3);
  EXPECT_THAT(result->lights(0).status().message(), HasSubstr("direction"));
  EXPECT_FALSE(result->lights(0).has_light());
  EXPECT_EQ(result->lights(1).SerializeAsString(), both->lights(1).SerializeAsString());
}

TEST(FitCall, ALightWithoutShadowsHasTheFocusedMap) {
  v1::FitRequest request = FloorRequest();
  v1::Light& third = *request.add_lights();
  third.set_name("fill");
  for (const double value : {0.0, 0.0, -1.0}) third.add_direction(value);
  const auto result = AnswerFit(request, CallContext());
  ASSERT_THAT(result, testing::IsOk());
  EXPECT_EQ(result->lights(0).status().code(), 0);
  EXPECT_EQ(result->lights(2).status().code(), 0);
  EXPECT_EQ(result->lights(2).stop_reason(), v1::STOP_REASON_TOO_FEW_SAMPLES);
}

TEST(FitCall, RefusesWhatCannotBeAnswered) {
  const std::vector<testing::BadInput<v1::FitRequest>> bad = {
      {[](auto* r) { r->clear_readback(); }, "readback.camera: is missing"},
      {[](auto* r) { r->mutable_readback()->mutable_camera()->set_width(0); },
       "readback.camera: size = 0x30"},
      {[](auto* r) { r->mutable_readback()->mutable_camera()->set_width(-7); }, "size = -7x30"},
      {[](auto* r) { r->mutable_readback()->mutable_camera()->set_width(1 << 30); },
       "pixels, and this server takes at most",
       absl::StatusCode::kResourceExhausted},
      {[](auto* r) { r->mutable_readback()->mutable_depth()->pop_back(); },
       "readback.depth: 4799 bytes, want whole values of 4 bytes"},
      {[](auto* r) { r->mutable_readback()->mutable_depth()->resize(400); },
       "readback.depth: 400 bytes, want 4800"},
      {[](auto* r) { r->mutable_readback()->mutable_shadow_bits()->append("1234"); },
       "readback.shadow_bits: 4804 bytes, want 4800"},
      {[](auto* r) { r->mutable_readback()->clear_shadow_bits(); },
       "readback.shadow_bits: 0 bytes, want 4800"},
      {[](auto* r) { r->mutable_readback()->add_shadow_planes("1"); }, "want one of them"},
      {[](auto* r) { r->mutable_readback()->set_source(std::string(5000, 'x')); },
       "readback.source: 5000 bytes, want at most 4096"},
      {[](auto* r) { r->clear_lights(); }, "lights: none"},
      {[](auto* r) {
         for (int i = 0; i < 40; ++i) r->add_lights()->set_name(std::to_string(i));
       },
       "lights: 42 of them, want at most 32"},
      {[](auto* r) { r->mutable_lights(1)->set_name("sun"); }, "lights[1].name = \"sun\""},
      {[](auto* r) { r->mutable_lights(1)->clear_name(); }, "lights[1].name: is empty"},
      {[](auto* r) { r->clear_map(); }, "map = 0x0"},
      {[](auto* r) { r->mutable_map()->set_height(1 << 30); }, "want 1 ..."},
      {[](auto* r) { r->mutable_options()->set_metric(static_cast<v1::Metric>(99)); }, "metric"},
      {[](auto* r) { r->mutable_options()->set_min_w(-1.0); }, "min_w"},
      {[](auto* r) { r->mutable_clip(); }, "clip"},
  };
  testing::ExpectRefused(FloorRequest(), bad, [](const auto& request, const auto& context) {
    return AnswerFit(request, context);
  });
}

// What lies outside of the pixels' shadow has room, as in the library.
TEST(FitCall, TakesAFinerCover) {
  const testing::ShadowReachesFurther scene;
  const std::vector<Light>& lights = scene.lights;
  Readback readback = scene.floor.View();
  const absl::StatusOr<LightMatrix> without = FitLight(readback, lights[0], kMap, FitOptions());
  readback.fine_cover = &scene.cover;
  const absl::StatusOr<LightMatrix> want = FitLight(readback, lights[0], kMap, FitOptions());
  ASSERT_THAT(want, testing::IsOk());
  v1::FitRequest request = WithMap(testing::RequestOf<v1::FitRequest>(readback, lights));
  *request.mutable_readback()->mutable_fine_cover() = testing::FineCoverMessage(scene.cover);
  auto result = AnswerFit(request, CallContext());
  ASSERT_THAT(result, testing::IsOk());
  EXPECT_EQ(*MatrixFromProto(result->lights(0).map_from_world(), "m"), want->map_from_world);
  EXPECT_NE(want->map_from_world, without->map_from_world);
  request.mutable_options()->set_use_fine_cover(false);
  result = AnswerFit(request, CallContext());
  ASSERT_THAT(result, testing::IsOk());
  EXPECT_EQ(*MatrixFromProto(result->lights(0).map_from_world(), "m"), without->map_from_world);
}

TEST(FitCall, StopsWhenToldTo) {
  v1::FitRequest request = YardRequest();
  *request.mutable_options() = FitOptionsToProto(FitOptions::AsPublished());
  request.mutable_options()->set_sample_by_sample(true);
  testing::ExpectStops(request, [](const auto& request, const auto& context) {
    return AnswerFit(request, context);
  });
}

TEST(FitCall, SurvivesWhateverComesIn) {
  testing::ExpectSurvivesMutations(
      FloorRequest(),
      [](const auto& request, const auto& context) { return AnswerFit(request, context); },
      4000);
}

}  // namespace
}  // namespace lightfit
