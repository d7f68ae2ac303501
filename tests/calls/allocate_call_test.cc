#include "calls/allocate_call.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "optimizer/evaluate.h"
#include "optimizer/fit.h"
#include "optimizer/light_matrix.h"
#include "optimizer/sizing/allocation.h"
#include "optimizer/sizing/map_shapes.h"
#include "optimizer/sizing/tolerance.h"
#include "tests/calls/requests.h"
#include "tests/io/summary_examples.h"
#include "tests/testing/test_scene.h"
#include "wire/options_proto.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::SetOf;
using testing::Yard;

constexpr int64_t kBudget = 1000000;  // texels

v1::AllocateRequest YardRequest() {
  auto request = testing::RequestOf<v1::AllocateRequest>(Yard().file.View(), Yard().lights);
  request.set_budget_texels(kBudget);
  return request;
}

v1::AllocateRequest SummaryRequest(Metric metric) {
  FitOptions options;
  options.metric = metric;
  v1::AllocateRequest request;
  *request.add_summaries() = SummarySetToProto(SetOf(Yard().file, "yard.exr", options));
  request.set_budget_texels(kBudget);
  return request;
}

v1::Tolerance ToleranceOf(v1::Tolerance::Kind kind, double limit_px, double image_scale = 0.0) {
  v1::Tolerance tolerance;
  tolerance.set_kind(kind);
  tolerance.set_limit_px(limit_px);
  tolerance.set_image_scale(image_scale);
  return tolerance;
}

void ExpectMatrix(const v1::LightResult& light, const absl::StatusOr<LightMatrix>& matrix) {
  ASSERT_THAT(matrix, testing::IsOk());
  EXPECT_EQ(light.status().code(), 0);
  EXPECT_EQ(light.map().width(), matrix->map.width);
  EXPECT_EQ(light.map().height(), matrix->map.height);
  EXPECT_EQ(light.map_from_world().SerializeAsString(),
            MatrixToProto(matrix->map_from_world).SerializeAsString());
  EXPECT_EQ(light.energies().final(), matrix->figures.energy);
}

TEST(AllocateCall, SplitsABudgetAsTheLibraryDoes) {
  v1::AllocateRequest request = YardRequest();
  v1::LightWeight& weight = *request.add_weights();
  weight.set_light(Yard().lights[1].name);
  weight.set_weight(3.0);
  request.mutable_rules()->set_powers_of_two(true);
  const auto result = AnswerAllocate(request, CallContext());
  ASSERT_THAT(result, testing::IsOk());

  const Readback readback = Yard().file.View();
  const FitOptions options;
  MapSizeRules rules;
  rules.powers_of_two = true;
  std::vector<AllocationLight> lights;
  for (const Light& light : Yard().lights) {
    lights.push_back({light, SummarizeForAnyAspect(readback, light, options), 1.0});
  }
  lights[1].weight = 3.0;
  const auto allocation = AllocateBudget(lights, kBudget, rules, options);
  ASSERT_THAT(allocation, testing::IsOk());
  EXPECT_EQ(result->texels(), allocation->texels);
  EXPECT_EQ(result->budget_texels(), kBudget);
  EXPECT_EQ(result->rules().max_side(), rules.max_side);
  ASSERT_EQ(result->lights_size(), static_cast<int>(lights.size()));
  for (int i = 0; i < result->lights_size(); ++i) {
    const MapSize map = allocation->maps[i].matrix->map;
    const auto matrix = FitLight(readback, lights[i].light, map, options);
    ExpectMatrix(result->lights(i), matrix);
    EXPECT_EQ(result->maps(i).weight(), lights[i].weight);
    EXPECT_GT(result->maps(i).equal_split_energy(), 0.0);
    EXPECT_EQ(result->lights(i).foretold_wrong().final(),
              EvaluateMatrix(readback, lights[i].light, matrix->map_from_world, map, options)
                  ->wrong_share);
  }
}

TEST(AllocateCall, KeepsAToleranceAsTheLibraryDoes) {
  constexpr double kScale = 2.0;
  v1::AllocateRequest request = YardRequest();
  *request.mutable_tolerance() = ToleranceOf(v1::Tolerance::KIND_P99, 4.0, kScale);
  const auto result = AnswerAllocate(request, CallContext());
  ASSERT_THAT(result, testing::IsOk());
  EXPECT_EQ(result->options().metric(), v1::METRIC_L2);
  EXPECT_EQ(result->tolerance().image_scale(), kScale);
  for (int i = 0; i < result->lights_size(); ++i) {
    const auto map = MeetTolerance(
        Yard().file.View(), Yard().lights[i], {Tolerance::Kind::kP99, 4.0, kScale}, {});
    ASSERT_THAT(map, testing::IsOk());
    ExpectMatrix(result->lights(i), map->matrix);
    EXPECT_EQ(result->maps(i).reached().is_met(), map->is_met);
    EXPECT_EQ(result->maps(i).reached().reached_px(), map->reached_px);
    EXPECT_EQ(result->maps(i).reached().num_samples(), map->num_samples);
  }
}

TEST(AllocateCall, WorksFromSummaries) {
  v1::AllocateRequest request = SummaryRequest(Metric::kL2);
  *request.mutable_tolerance() = ToleranceOf(v1::Tolerance::KIND_RMS, 1.0);
  const auto result = AnswerAllocate(request, CallContext());
  ASSERT_THAT(result, testing::IsOk());
  EXPECT_FALSE(result->readback().has_camera());
  EXPECT_EQ(result->tolerance().image_scale(), 1.0);
  const SummarySet set = *SummarySetFromProto(request.summaries(0));
  FitOptions options = set.options;
  options.compute_statistics = false;
  ASSERT_EQ(result->lights_size(), static_cast<int>(set.lights.size()));
  for (int i = 0; i < result->lights_size(); ++i) {
    const SummaryTotal& total = set.lights[i].total;
    const auto map = MeetTolerance(
        *SummaryOfTotal(total), total.light, {Tolerance::Kind::kRms, 1.0}, {}, options);
    ASSERT_THAT(map, testing::IsOk());
    ExpectMatrix(result->lights(i), map->matrix);
    EXPECT_FALSE(result->lights(i).has_foretold_wrong());
  }
}

TEST(AllocateCall, LightsThatCannotBeUsedLeaveTheirTexelsToTheOthers) {
  v1::AllocateRequest request = YardRequest();
  request.mutable_lights(0)->clear_position();
  request.mutable_lights(0)->clear_direction();
  for (const bool has_tolerance : {false, true}) {
    if (has_tolerance) *request.mutable_tolerance() = ToleranceOf(v1::Tolerance::KIND_RMS, 1.0);
    const auto result = AnswerAllocate(request, CallContext());
    ASSERT_THAT(result, testing::IsOk());
    EXPECT_EQ(result->lights(0).status().code(), 3);
    EXPECT_THAT(result->lights(0).status().message(), HasSubstr("neither position nor direction"));
    EXPECT_FALSE(result->lights(0).has_light());
    EXPECT_EQ(result->maps(0).texels(), 0);
    EXPECT_EQ(result->lights(1).status().code(), 0);
    EXPECT_GT(result->maps(1).texels(), 0);
    EXPECT_THAT(result->lights(1).status().message(), IsEmpty());
  }
}

TEST(AllocateCall, BadInputsAreNamed) {
  using Request = v1::AllocateRequest;
  const auto weight = [](const std::string& light, double value) {
    return [light, value](Request* r) {
      r->add_weights()->set_light(light);
      r->mutable_weights(r->weights_size() - 1)->set_weight(value);
    };
  };
  const auto tolerance = [](v1::Tolerance::Kind kind, double limit, double scale) {
    return [=](Request* r) { *r->mutable_tolerance() = ToleranceOf(kind, limit, scale); };
  };
  const std::string sun = Yard().lights[0].name;
  const std::vector<testing::BadInput<Request>> bad = {
      {[](Request* r) { *r = Request(); }, "readback: is missing, want a read-back and its lights"},
      {[](Request* r) { r->clear_readback(); }, "readback: is missing"},
      {[](Request* r) { r->add_summary_files("x"); }, "readback: summaries bring theirs"},
      {[](Request* r) {
         r->clear_readback();
         r->add_summary_files("x");
       },
       "lights: summaries bring theirs"},
      {[](Request* r) { r->clear_lights(); }, "lights: none"},
      {[](Request* r) { r->clear_goal(); }, "goal: is missing, want budget_texels or tolerance"},
      {[](Request* r) { r->set_budget_texels(-5); }, "budget_texels = -5, want 1 ... 137438953472"},
      {[](Request* r) { r->set_budget_texels(std::numeric_limits<int64_t>::max()); },
       "budget_texels = 9223372036854775807, want 1 ... "},
      {[](Request* r) { r->set_budget_texels(100); },
       "budget_texels = 100, want at least 12288: 3 maps of 64x64, the smallest that "
       "rules.min_side = 64 allows"},
      {tolerance(v1::Tolerance::KIND_UNSPECIFIED, 1.0, 1.0), "tolerance.kind = 0, want KIND_RMS"},
      {tolerance(static_cast<v1::Tolerance::Kind>(1000), 1.0, 1.0), "tolerance.kind = 1000, want"},
      {tolerance(v1::Tolerance::KIND_RMS, 0.0, 1.0), "tolerance.limit_px = 0, want a number above"},
      {tolerance(v1::Tolerance::KIND_RMS, std::nan(""), 1.0), "tolerance.limit_px = nan"},
      {tolerance(v1::Tolerance::KIND_RMS, 1.0, -1.0), "tolerance.image_scale = -1, want a number"},
      {tolerance(v1::Tolerance::KIND_RMS, 1.0, 1e300), "tolerance.image_scale = 1e+300, want at"},
      {[&](Request* r) {
         weight(sun, 2.0)(r);
         *r->mutable_tolerance() = ToleranceOf(v1::Tolerance::KIND_RMS, 1.0);
       },
       "weights: do not count with a tolerance"},
      {weight("moon", 1.0), "weights[0].light = \"moon\": there is no such light"},
      {weight(sun, 0.0), "weights[0].weight = 0, want a number above 0"},
      {weight(sun, std::numeric_limits<double>::infinity()), "weights[0].weight = inf, want"},
      {[&](Request* r) {
         weight(sun, 2.0)(r);
         weight(sun, 3.0)(r);
       },
       "has a weight already"},
      {[](Request* r) { r->mutable_rules()->set_multiple(-64); }, "rules.multiple = -64 texels"},
      {[](Request* r) { r->mutable_rules()->set_max_side(1 << 30); },
       "rules.min_side, max_side = 64, 1073741824 texels, want 1 <= min_side"},
      {[](Request* r) { r->mutable_rules()->set_multiple(2000000000); },
       "rules: no multiple of 2000000000 lies in min_side ... max_side"},
      {[](Request* r) { r->mutable_options()->set_margin_texels(1e300); },
       "rules.min_side = 64 texels, want more than twice options.margin_texels = 1e+300"},
      {[](Request* r) { r->mutable_clip(); }, "clip: depth_range = 0"},
      {[](Request* r) { r->mutable_options()->set_line_search_rounds(1001); },
       "options.line_search_rounds = 1001, want at most 1000"}};
  testing::ExpectRefused(YardRequest(), bad, AnswerAllocate);
}

TEST(AllocateCall, SummariesServeTheTolerancesOfSquaresOnly) {
  using Request = v1::AllocateRequest;
  testing::ExpectRefused<Request>(
      SummaryRequest(Metric::kL2),
      {{[](Request* r) { *r->mutable_tolerance() = ToleranceOf(v1::Tolerance::KIND_WORST, 1.0); },
        "tolerance.kind: KIND_P99 and KIND_WORST go through the samples one by one"},
       {[](Request* r) { r->mutable_options()->set_metric(v1::METRIC_L1); },
        "options.metric = METRIC_L1: the summaries were made with METRIC_L2"}},
      AnswerAllocate);
  testing::ExpectRefused<Request>(
      SummaryRequest(Metric::kL1),
      {{[](Request* r) { *r->mutable_tolerance() = ToleranceOf(v1::Tolerance::KIND_RMS, 1.0); },
        "tolerance: the summaries hold sums for METRIC_L1, and a tolerance wants METRIC_L2"}},
      AnswerAllocate);
}

// The most sizes that rules can allow, and more texels than they can use.
TEST(AllocateCall, AbsurdSizesAreAnsweredAsAnyOthers) {
  v1::AllocateRequest request = SummaryRequest(Metric::kL2);
  request.set_budget_texels(int64_t{32} * 65536 * 65536);
  request.mutable_rules()->set_multiple(1);
  request.mutable_rules()->set_min_side(1);
  request.mutable_rules()->set_max_side(65536);
  const auto result = AnswerAllocate(request, CallContext());
  ASSERT_THAT(result, testing::IsOk());
  for (const v1::LightResult& light : result->lights()) {
    EXPECT_EQ(light.map().width(), 65536);
    EXPECT_EQ(light.map().height(), 65536);
  }
}

TEST(AllocateCall, StopsWhenTold) {
  v1::AllocateRequest request = YardRequest();
  testing::ExpectStops(request, AnswerAllocate);
  *request.mutable_tolerance() = ToleranceOf(v1::Tolerance::KIND_RMS, 1.0);
  testing::ExpectStops(request, AnswerAllocate);
}

TEST(AllocateCall, DamagedRequestsAreAnsweredOrRefused) {
  const testing::TestScene scene(3, 2, 24, 16);
  auto request = testing::RequestOf<v1::AllocateRequest>(scene.View(), scene.lights);
  request.set_budget_texels(100000);
  request.mutable_rules()->set_powers_of_two(true);
  request.mutable_rules()->set_max_side(512);
  request.mutable_options()->set_search(v1::SEARCH_FOCUSED);
  request.mutable_options()->set_metric(v1::METRIC_L2);
  testing::ExpectSurvivesMutations(request, AnswerAllocate, 1500);
  *request.mutable_tolerance() = ToleranceOf(v1::Tolerance::KIND_RMS, 10.0);
  testing::ExpectSurvivesMutations(request, AnswerAllocate, 1500);
}

}  // namespace
}  // namespace lightfit
