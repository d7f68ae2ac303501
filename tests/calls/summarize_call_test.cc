#include "calls/summarize_call.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "optimizer/fit.h"
#include "tests/calls/requests.h"
#include "tests/io/summary_examples.h"
#include "tests/testing/test_scene.h"
#include "wire/matrix_proto.h"
#include "wire/summary_proto.h"

namespace lightfit {
namespace {

using testing::BytesOf;
using testing::FrameOfYard;
using testing::SetOf;
using testing::Yard;

v1::SummarizeRequest YardRequest(const ReadbackFile& file, const std::string& name) {
  auto request = testing::RequestOf<v1::SummarizeRequest>(file.View(), Yard().lights);
  request.mutable_readback()->set_source(name);
  return request;
}

// The bytes that lights' summaries take; those of the file say who wrote it, too.
std::string LightsOf(const v1::SummaryFile& summary) {
  v1::SummaryFile lights;
  *lights.mutable_lights() = summary.lights();
  return lights.SerializeAsString();
}

TEST(SummarizeCall, IsTheLibrarysSummary) {
  const auto result = AnswerSummarize(YardRequest(Yard().file, "yard.exr"), CallContext());
  ASSERT_THAT(result, testing::IsOk());
  const SummarySet want = SetOf(Yard().file, "yard.exr");
  EXPECT_EQ(LightsOf(result->summary()), LightsOf(SummarySetToProto(want)));
  const auto file = ParseSummarySet(result->summary_file());
  ASSERT_THAT(file, testing::IsOk());
  EXPECT_EQ(LightsOf(SummarySetToProto(*file)), LightsOf(result->summary()));
}

TEST(SummarizeCall, AddsUpWhatItIsGiven) {
  SummarySet sum = SetOf(FrameOfYard(0), "0.exr");
  ASSERT_THAT(AddToSet(SetOf(FrameOfYard(1), "1.exr"), &sum), testing::IsOk());
  ASSERT_THAT(AddToSet(SetOf(FrameOfYard(2), "2.exr"), &sum), testing::IsOk());
  v1::SummarizeRequest request = YardRequest(FrameOfYard(2), "2.exr");
  *request.add_summaries() = SummarySetToProto(SetOf(FrameOfYard(1), "1.exr"));
  request.add_summary_files(BytesOf(SetOf(FrameOfYard(0), "0.exr")));
  const auto result = AnswerSummarize(request, CallContext());
  ASSERT_THAT(result, testing::IsOk());
  EXPECT_EQ(LightsOf(result->summary()), LightsOf(SummarySetToProto(sum)));
}

TEST(SummarizeCall, LightsWithoutAWeighingMapSaySo) {
  v1::SummarizeRequest request = YardRequest(Yard().file, "yard.exr");
  request.mutable_options()->set_metric(v1::METRIC_L1);
  const std::string name = Yard().lights[0].name;
  v1::CandidateMatrix* candidate = request.add_weigh_by();
  candidate->set_light(name);
  candidate->mutable_map()->set_width(1024);
  candidate->mutable_map()->set_height(1024);
  FitOptions options;
  options.metric = Metric::kL1;
  const auto fit = FitLight(Yard().file.View(), Yard().lights[0], {1024, 1024}, options);
  ASSERT_THAT(fit, testing::IsOk());
  *candidate->mutable_map_from_world() = MatrixToProto(fit->map_from_world);
  const auto result = AnswerSummarize(request, CallContext());
  ASSERT_THAT(result, testing::IsOk());
  for (const v1::LightSummary& light : result->summary().lights()) {
    const bool is_weighed = light.light().name() == name;
    EXPECT_EQ(light.has_weighed_in(), is_weighed);
    EXPECT_EQ(light.num_frames_without(), is_weighed ? 0 : 1);
    if (is_weighed) continue;
    EXPECT_THAT(light.failure().message(), ::testing::HasSubstr("weigh_by has no matrix"));
  }
}

TEST(SummarizeCall, BadInputsAreNamed) {
  using Request = v1::SummarizeRequest;
  const std::vector<testing::BadInput<Request>> bad = {
      {[](Request* r) { *r = Request(); }, "readback: none, and no summaries either"},
      {[](Request* r) { r->clear_lights(); }, "lights"},
      {[](Request* r) { r->mutable_readback()->clear_depth(); }, "depth"},
      {[](Request* r) { r->mutable_options()->set_margin_percent(-1.0); }, "margin_percent"},
      {[](Request* r) {
         r->mutable_options()->set_metric(v1::METRIC_L2);
         r->add_weigh_by()->set_light("sun");
       },
       "weigh_by: is for METRIC_L1"},
      {[](Request* r) {
         r->mutable_options()->set_metric(v1::METRIC_L1);
         r->add_weigh_by()->set_light("sun");
       },
       "weigh_by[0]: map = 0x0"},
      {[](Request* r) { r->add_summary_files("none"); }, "summary_files[0]: is no summary file"},
      {[](Request* r) {
         FitOptions options;
         options.metric = Metric::kL2;
         r->add_summary_files(BytesOf(SetOf(Yard().file, "yard.exr", options)));
       },
       "readback: "}};
  testing::ExpectRefused(YardRequest(Yard().file, "yard.exr"), bad, &AnswerSummarize);
}

TEST(SummarizeCall, StopsWhenItIsTold) {
  testing::ExpectStops(YardRequest(Yard().file, "yard.exr"), &AnswerSummarize);
}

TEST(SummarizeCall, DamagedRequestsAreAnsweredOrRefused) {
  const testing::TestScene scene(3, 2, 24, 16);
  auto request = testing::RequestOf<v1::SummarizeRequest>(scene.View(), scene.lights);
  testing::ExpectSurvivesMutations(request, &AnswerSummarize, 1000);
}

}  // namespace
}  // namespace lightfit
