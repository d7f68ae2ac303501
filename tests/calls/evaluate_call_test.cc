#include "calls/evaluate_call.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <string>
#include <vector>

#include "optimizer/evaluate.h"
#include "optimizer/figures/figures.h"
#include "optimizer/figures/stability.h"
#include "optimizer/fit.h"
#include "tests/calls/requests.h"
#include "tests/io/summary_examples.h"
#include "tests/testing/test_scene.h"
#include "wire/crawl_proto.h"
#include "wire/matrix_proto.h"
#include "wire/options_proto.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::kMap;
using ::testing::StartsWith;
using testing::Yard;

v1::CandidateMatrix Candidate(const std::string& light, const Eigen::Matrix4d& map_from_world) {
  v1::CandidateMatrix candidate;
  candidate.set_light(light);
  *candidate.mutable_map_from_world() = MatrixToProto(map_from_world);
  candidate.mutable_map()->set_width(kMap.width);
  candidate.mutable_map()->set_height(kMap.height);
  return candidate;
}

// For each light the matrix of a focused map.
v1::EvaluateRequest RequestFor(const Readback& readback, const std::vector<Light>& lights) {
  auto request = testing::RequestOf<v1::EvaluateRequest>(readback, lights);
  FitOptions options;
  options.search = Search::kFocused;
  for (const Light& light : lights) {
    const auto matrix = FitLight(readback, light, kMap, options);
    EXPECT_THAT(matrix, testing::IsOk());
    *request.add_matrices() = Candidate(light.name, matrix->map_from_world);
  }
  return request;
}

v1::EvaluateRequest YardRequest() { return RequestFor(Yard().file.View(), Yard().lights); }

void ExpectFigures(const v1::Evaluation& evaluation, const Figures& figures) {
  EXPECT_EQ(evaluation.status().code(), 0) << evaluation.status().message();
  EXPECT_EQ(evaluation.energy(), figures.energy);
  EXPECT_EQ(evaluation.footprint().SerializeAsString(),
            FootprintToProto(figures.footprint, true).SerializeAsString());
  EXPECT_EQ(evaluation.samples().SerializeAsString(),
            SampleCountsToProto(figures.samples).SerializeAsString());
  EXPECT_EQ(evaluation.num_behind(), figures.footprint.num_behind);
  EXPECT_EQ(evaluation.wrong_share(), figures.wrong_share);
}

TEST(EvaluateCall, GivesTheLibrarysFigures) {
  v1::EvaluateRequest request = YardRequest();
  request.mutable_options()->set_metric(v1::METRIC_L2);
  request.mutable_readback()->set_source("0001.exr");
  FitOptions options;
  options.metric = Metric::kL2;
  const auto result = AnswerEvaluate(request, CallContext());
  ASSERT_THAT(result, testing::IsOk());
  EXPECT_EQ(result->readback().source(), "0001.exr");
  EXPECT_EQ(result->readback().camera().width(), Yard().file.camera.width);
  EXPECT_EQ(result->options().SerializeAsString(), FitOptionsToProto(options).SerializeAsString());
  ASSERT_EQ(result->evaluations_size(), static_cast<int>(Yard().lights.size()));
  for (int i = 0; i < result->evaluations_size(); ++i) {
    const Light& light = Yard().lights[i];
    const auto matrix = MatrixFromProto(request.matrices(i).map_from_world(), "matrix");
    const auto figures = EvaluateMatrix(Yard().file.View(), light, *matrix, kMap, options);
    ASSERT_THAT(figures, testing::IsOk());
    EXPECT_EQ(result->evaluations(i).light(), light.name);
    ExpectFigures(result->evaluations(i), *figures);
    EXPECT_GT(result->evaluations(i).energy(), 0.0);
  }
}

// The same map in every clip convention; to rounding, as its inverse comes in.
TEST(EvaluateCall, TakesMatricesInAnyClipSpace) {
  constexpr double kRounding = 1e-10;  // relative
  const v1::EvaluateRequest request = YardRequest();
  const auto expected = AnswerEvaluate(request, CallContext());
  ASSERT_THAT(expected, testing::IsOk());
  for (const ClipConvention& clip : {ClipConvention::Vulkan(),
                                     ClipConvention::Direct3D(),
                                     ClipConvention::OpenGl(),
                                     ClipConvention::ReversedZ(),
                                     ClipConvention::Direct3DReversed()}) {
    v1::EvaluateRequest clipped = request;
    for (v1::CandidateMatrix& candidate : *clipped.mutable_matrices()) {
      const Eigen::Matrix4d matrix = *MatrixFromProto(candidate.map_from_world(), "matrix");
      *candidate.mutable_clip_from_world() = MatrixToProto(ClipFromMap(kMap, clip) * matrix);
      *candidate.mutable_clip() = ClipConventionToProto(clip);
    }
    const auto result = AnswerEvaluate(clipped, CallContext());
    ASSERT_THAT(result, testing::IsOk());
    for (int i = 0; i < result->evaluations_size(); ++i) {
      const double energy = expected->evaluations(i).energy();
      EXPECT_NEAR(result->evaluations(i).energy(), energy, kRounding * energy);
    }
  }
}

TEST(EvaluateCall, TellsCrawlFromTheFrameBefore) {
  v1::EvaluateRequest request = YardRequest();
  const ReadbackFile frame_before = testing::FrameOfYard(1);
  *request.mutable_before() = testing::ReadbackMessage(frame_before.View());
  const v1::Matrix4x4 kept = request.matrices(0).map_from_world();
  v1::Matrix4x4 shifted = kept;  // by a third of a texel to the left
  for (int column = 0; column < 4; ++column) {
    shifted.set_m(column, kept.m(column) - kept.m(12 + column) / 3.0);
  }
  for (const v1::Matrix4x4& before : {kept, shifted}) {
    *request.mutable_matrices(0)->mutable_map_from_world_before() = before;
    const auto result = AnswerEvaluate(request, CallContext());
    ASSERT_THAT(result, testing::IsOk());
    EXPECT_FALSE(result->evaluations(1).has_crawl());
    const auto want = MeasureCrawl({frame_before.View(), *MatrixFromProto(before, ""), kMap},
                                   {Yard().file.View(), *MatrixFromProto(kept, ""), kMap},
                                   Yard().lights[0]);
    ASSERT_THAT(want, testing::IsOk());
    EXPECT_EQ(result->evaluations(0).crawl().SerializeAsString(),
              CrawlToProto(*want).SerializeAsString());
  }
  request.clear_before();
  const auto without = AnswerEvaluate(request, CallContext());
  ASSERT_THAT(without, testing::IsOk());
  EXPECT_THAT(without->evaluations(0).status().message(), HasSubstr("map_from_world_before: want"));
}

// Row 3 is the depth that a map stores, and has no part in its figures.
TEST(EvaluateCall, RowThreeDoesNotMatter) {
  v1::EvaluateRequest request = YardRequest();
  const auto expected = AnswerEvaluate(request, CallContext());
  for (int column = 0; column < 4; ++column) {
    request.mutable_matrices(0)->mutable_map_from_world()->set_m(8 + column, 0.0);
  }
  const auto result = AnswerEvaluate(request, CallContext());
  ASSERT_THAT(expected, testing::IsOk());
  ASSERT_THAT(result, testing::IsOk());
  EXPECT_EQ(result->evaluations(0).SerializeAsString(),
            expected->evaluations(0).SerializeAsString());
}

// Each matrix has its own status, whatever is wrong with the others.
TEST(EvaluateCall, BadMatricesFailAlone) {
  v1::EvaluateRequest request = YardRequest();
  request.mutable_lights(1)->clear_direction();
  request.mutable_lights(1)->clear_position();
  const v1::CandidateMatrix good = request.matrices(0);
  request.clear_matrices();
  const auto add = [&](const std::function<void(v1::CandidateMatrix*)>& spoil) {
    v1::CandidateMatrix& candidate = *request.add_matrices() = good;
    spoil(&candidate);
  };
  const std::vector<std::pair<std::function<void(v1::CandidateMatrix*)>, std::string>> bad = {
      {[](v1::CandidateMatrix* c) { c->set_light("moon"); },
       "matrices[0]: light = \"moon\": there is no such light, want one of \""},
      {[](v1::CandidateMatrix* c) { c->set_light(std::string(100000, 'x')); },
       "xxxx...\": there is no such light"},
      {[](v1::CandidateMatrix* c) { c->set_light(Yard().lights[1].name); },
       "has neither position nor direction, want either"},
      {[](v1::CandidateMatrix* c) { c->clear_matrix(); },
       "matrices[3]: want map_from_world or clip_from_world"},
      {[](v1::CandidateMatrix* c) { c->mutable_map_from_world()->add_m(1.0); },
       "map_from_world: m has 17 numbers, want 16"},
      {[](v1::CandidateMatrix* c) { c->mutable_map_from_world()->set_m(3, std::nan("")); },
       "map_from_world: m has values that are not finite"},
      {[](v1::CandidateMatrix* c) {
         *c->mutable_clip_from_world() = v1::Matrix4x4(c->map_from_world());
         c->mutable_clip()->set_depth_range(static_cast<v1::ClipConvention::DepthRange>(9));
       },
       "clip: depth_range = 9, want DEPTH_RANGE_ZERO_TO_ONE"},
      {[](v1::CandidateMatrix* c) { c->mutable_map()->set_height(-1); },
       "matrices[7]: map = 1024x-1, want 1 ... "},
      {[](v1::CandidateMatrix* c) {
         *c->mutable_map_from_world() = MatrixToProto(Eigen::Matrix4d::Zero());
       },
       "matrices[8]: "}};
  for (const auto& [spoil, words] : bad) add(spoil);
  add([](v1::CandidateMatrix*) {});
  const auto result = AnswerEvaluate(request, CallContext());
  ASSERT_THAT(result, testing::IsOk());
  const int last = static_cast<int>(bad.size());
  ASSERT_EQ(result->evaluations_size(), last + 1);
  for (int i = 0; i < last; ++i) {
    const v1::Evaluation& evaluation = result->evaluations(i);
    EXPECT_EQ(evaluation.status().code(), 3) << i;
    EXPECT_THAT(evaluation.status().message(), HasSubstr(bad[i].second));
    EXPECT_LT(evaluation.status().message().size(), 1000U);
    EXPECT_EQ(evaluation.light(), request.matrices(i).light());
    EXPECT_FALSE(evaluation.has_footprint());
  }
  EXPECT_EQ(result->evaluations(last).status().code(), 0);
  EXPECT_GT(result->evaluations(last).energy(), 0.0);
}

TEST(EvaluateCall, BadInputsAreNamed) {
  using Request = v1::EvaluateRequest;
  const std::vector<testing::BadInput<Request>> bad = {
      {[](Request* r) { r->clear_matrices(); }, "matrices: none, want at least one"},
      {[](Request* r) {
         for (int i = 0; i < 1100; ++i) r->add_matrices();
       },
       "matrices: 1103 of them, and this server takes at most 1024; send several requests",
       absl::StatusCode::kResourceExhausted},
      {[](Request* r) { r->clear_lights(); }, "lights: none, want 1 to 32"},
      {[](Request* r) { r->clear_readback(); }, "readback.camera: is missing"},
      {[](Request* r) { r->mutable_readback()->mutable_depth()->pop_back(); }, "readback.depth: "},
      {[](Request* r) { r->mutable_readback()->mutable_camera()->set_width(1 << 30); },
       "readback.camera: ",
       absl::StatusCode::kResourceExhausted},
      {[](Request* r) { r->mutable_options()->set_reweighting_rounds(0); },
       "options.reweighting_rounds = 0, want 1 or more"},
      {[](Request* r) { r->mutable_options()->set_reweighting_rounds(2000000000); },
       "options.reweighting_rounds = 2000000000, want at most 1000"}};
  testing::ExpectRefused(YardRequest(), bad, AnswerEvaluate);
}

TEST(EvaluateCall, StopsWhenTold) { testing::ExpectStops(YardRequest(), AnswerEvaluate); }

TEST(EvaluateCall, DamagedRequestsAreAnsweredOrRefused) {
  const testing::TestScene scene(3, 2, 24, 16);
  testing::ExpectSurvivesMutations(RequestFor(scene.View(), scene.lights), AnswerEvaluate, 3000);
}

}  // namespace
}  // namespace lightfit
