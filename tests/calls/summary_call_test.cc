#include "calls/summary_call.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "optimizer/fit.h"
#include "optimizer/light_matrix.h"
#include "tests/calls/requests.h"
#include "tests/io/summary_examples.h"
#include "wire/options_proto.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using testing::BytesOf;
using testing::FramesOfYard;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::kMap;
using testing::SetOf;
using ::testing::StartsWith;
using testing::Yard;
using testing::YardBytes;

void SetMap(MapSize map, v1::MapSize* proto) {
  proto->set_width(map.width);
  proto->set_height(map.height);
}

// One summary as a message and one as a file.
v1::FitSummaryRequest YardRequest() {
  static const std::vector<SummarySet>& frames = *new std::vector<SummarySet>(FramesOfYard(2));
  v1::FitSummaryRequest request;
  *request.add_summaries() = SummarySetToProto(frames[0]);
  request.add_summary_files(BytesOf(frames[1]));
  SetMap(kMap, request.mutable_map());
  return request;
}

TEST(SummaryCall, AFrameInTwoSummariesIsRefusedWithBothNamed) {
  std::vector<SummarySet> frames = FramesOfYard(2);
  for (int i = 0; i < 2; ++i) {
    frames[i].frames = {IdentityOf(Yard().file.View(), FrameNumber::Whole(1001 + i))};
  }
  v1::FitSummaryRequest request;
  *request.add_summaries() = SummarySetToProto(frames[0]);
  request.add_summary_files(BytesOf(frames[1]));
  SetMap(kMap, request.mutable_map());
  EXPECT_THAT(AnswerFitSummary(request, CallContext()), testing::IsOk());
  request.add_summary_files(BytesOf(frames[0]));
  EXPECT_THAT(AnswerFitSummary(request, CallContext()),
              testing::StatusIs(absl::StatusCode::kInvalidArgument,
                                "frame 1001 is in summaries[0] and in summary_files[1], and would "
                                "count twice: leave one of the two out"));
}

TEST(SummaryCall, IsTheLibrarysFitOfTheSum) {
  std::vector<SummarySet> frames = FramesOfYard(2);
  ASSERT_THAT(AddToSet(frames[1], &frames[0]), testing::IsOk());
  v1::FitSummaryRequest request = YardRequest();
  request.mutable_options()->set_search(v1::SEARCH_ROTATION_LINE_SEARCH);
  request.mutable_clip()->set_depth_range(v1::ClipConvention::DEPTH_RANGE_MINUS_ONE_TO_ONE);
  const auto result = AnswerFitSummary(request, CallContext());
  ASSERT_THAT(result, testing::IsOk());
  FitOptions options;
  options.search = Search::kRotationLineSearch;
  options.compute_statistics = false;
  EXPECT_EQ(result->options().SerializeAsString(), FitOptionsToProto(options).SerializeAsString());
  EXPECT_FALSE(result->readback().has_camera());
  ASSERT_EQ(result->lights_size(), static_cast<int>(frames[0].lights.size()));
  for (int i = 0; i < result->lights_size(); ++i) {
    const LightSummary& light = frames[0].lights[i];
    const v1::LightResult& answer = result->lights(i);
    const auto matrix = Fit(*SummaryOfTotal(light.total), light.total.light, kMap, options);
    ASSERT_THAT(matrix, testing::IsOk());
    EXPECT_EQ(answer.name(), light.name());
    EXPECT_EQ(answer.status().code(), 0);
    EXPECT_THAT(answer.status().message(), IsEmpty());
    EXPECT_EQ(answer.map_from_world().SerializeAsString(),
              MatrixToProto(matrix->map_from_world).SerializeAsString());
    EXPECT_EQ(answer.clip_from_world().SerializeAsString(),
              MatrixToProto(ClipFromMap(kMap, ClipConvention::OpenGl()) * matrix->map_from_world)
                  .SerializeAsString());
    EXPECT_EQ(answer.energies().final(), matrix->figures.energy);
    EXPECT_EQ(answer.evaluations(), matrix->search.evaluations);
  }
}

TEST(SummaryCall, OrderAndFormOfTheSummariesDoNotMatter) {
  const v1::FitSummaryRequest request = YardRequest();
  v1::FitSummaryRequest files = request;
  files.clear_summaries();
  files.add_summary_files(BytesOf(*SummarySetFromProto(request.summaries(0))));
  const auto a = AnswerFitSummary(request, CallContext());
  const auto b = AnswerFitSummary(files, CallContext());
  ASSERT_THAT(a, testing::IsOk());
  ASSERT_THAT(b, testing::IsOk());
  EXPECT_EQ(a->SerializeAsString(), b->SerializeAsString());
}

// A light without any frame fails alone; one that some frames miss says so and has its matrix. What
// a file's name made of the message is UTF-8 again.
TEST(SummaryCall, LightsThatFramesHaveNothingOfSaySo) {
  const FitOptions options;
  SummarySet gone = SetOf(Yard().file, "yard.exr");
  const std::string names[] = {gone.lights[0].name(), gone.lights[1].name()};
  for (LightSummary& light : absl::MakeSpan(gone.lights).subspan(0, 2)) {
    light = SummaryOfFrame(
        light.total.light, absl::NotFoundError("no channel"), "b\xe9ton.exr", options);
  }
  SummarySet whole = SetOf(Yard().file, "yard.exr");
  whole.lights[0] = gone.lights[0];
  v1::FitSummaryRequest request;
  *request.add_summaries() = SummarySetToProto(gone);
  *request.add_summaries() = SummarySetToProto(whole);
  SetMap(kMap, request.mutable_map());
  const auto result = AnswerFitSummary(request, CallContext());
  ASSERT_THAT(result, testing::IsOk());
  EXPECT_EQ(result->lights(0).status().code(), 9);
  EXPECT_THAT(result->lights(0).status().message(),
              HasSubstr(absl::StrCat(names[0], "\": nothing of it in 2 of 2 frames")));
  EXPECT_FALSE(result->lights(0).has_map_from_world());
  EXPECT_EQ(result->lights(1).status().code(), 0);
  EXPECT_THAT(result->lights(1).status().message(),
              AllOf(HasSubstr(absl::StrCat(names[1], "\": nothing of it in 1 of 2 frames")),
                    HasSubstr("b?ton.exr: no channel")));
  EXPECT_TRUE(result->lights(1).has_map_from_world());
  EXPECT_THAT(result->lights(2).status().message(), IsEmpty());
}

TEST(SummaryCall, BadInputsAreNamed) {
  using Bad = testing::BadInput<v1::FitSummaryRequest>;
  using Request = v1::FitSummaryRequest;
  const std::string set_l2 = [] {
    FitOptions options;
    options.metric = Metric::kL2;
    return BytesOf(SetOf(Yard().file, "yard.exr", options));
  }();
  const std::vector<Bad> bad = {
      {[](Request* r) { *r = Request(); }, "summaries: none, want at least one"},
      {[](Request* r) { r->mutable_summaries(0)->clear_lights(); },
       "summaries[0]: lights: none, want at least one"},
      {[](Request* r) {
         r->mutable_summaries(0)->mutable_lights(0)->mutable_total()->set_num_frames(-1);
       },
       "num_frames = -1, want 1 ... 9007199254740992"},
      {[](Request* r) { r->add_summary_files("nothing"); }, "summary_files[1]: is no summary file"},
      {[](Request* r) { r->mutable_summary_files(0)->pop_back(); }, "summary_files[0]: has "},
      {[&](Request* r) { r->add_summary_files(set_l2); },
       "summary_files[1]: options.metric is METRIC_L2 here and METRIC_L1_ACROSS_EDGE in what"},
      {[](Request* r) { r->clear_map(); }, "map = 0x0, want 1 ... 65536 texels each way"},
      {[](Request* r) { r->mutable_map()->set_width(1 << 30); }, "map = 1073741824x512, want"},
      {[](Request* r) { r->mutable_clip(); },
       "clip: depth_range = 0, want DEPTH_RANGE_ZERO_TO_ONE"},
      {[](Request* r) { r->mutable_options()->set_search(static_cast<v1::Search>(77)); },
       "options.search = 77, want one of SEARCH_FOCUSED"},
      {[](Request* r) { r->mutable_options()->set_min_w(std::nan("")); },
       "options.min_w = nan, want more than 0"},
      {[](Request* r) { r->mutable_options()->set_grid_directions(1 << 30); },
       "options.grid_directions = 1073741824, want at most 1000"},
      {[](Request* r) { r->mutable_options()->set_metric(v1::METRIC_L2); },
       "options.metric = METRIC_L2: the summaries were made with METRIC_L1_ACROSS_EDGE"},
      {[](Request* r) { r->mutable_options()->set_cover(v1::COVER_RECEIVERS); },
       "options.cover = COVER_RECEIVERS: the summaries were made with COVER_SHADOWED"},
      {[](Request* r) { r->mutable_options()->set_border(v1::BORDER_CHOICE_DARK); },
       "options.border = BORDER_CHOICE_DARK: the summaries were made with BORDER_CHOICE_LIT"},
      {[](Request* r) { r->mutable_options()->set_along_edge_share(0.5); },
       "options.along_edge_share = 0.5: the summaries were made with 0.05"},
      {[](Request* r) { r->mutable_options()->mutable_samples()->set_edge_window(3); },
       "options.samples.edge_window = 3: the summaries were made with 2"},
      {[](Request* r) { r->mutable_options()->set_sample_by_sample(true); },
       "options.sample_by_sample"}};
  testing::ExpectRefused(YardRequest(), bad, AnswerFitSummary);
}

TEST(SummaryCall, WhatTheSummariesHoldMayBeSaidOnceMore) {
  v1::FitSummaryRequest request = YardRequest();
  *request.mutable_options() = FitOptionsToProto(FitOptions());
  request.mutable_options()->mutable_samples()->set_min_samples(1);  // of the search
  EXPECT_THAT(AnswerFitSummary(request, CallContext()), testing::IsOk());
}

TEST(SummaryCall, MoreSummariesThanTheLimitAreRefusedUnread) {
  v1::FitSummaryRequest request;
  for (int i = 0; i < 5; ++i) request.add_summary_files("not looked into");
  CallContext context;
  context.limits.max_summaries = 4;
  const absl::Status status = AnswerFitSummary(request, context).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(
      std::string(status.message()),
      StartsWith("summaries and summary_files: 5 of them, and this server takes at most 4"));
}

TEST(SummaryCall, StopsWhenTold) { testing::ExpectStops(YardRequest(), AnswerFitSummary); }

TEST(SummaryCall, DamagedRequestsAreAnsweredOrRefused) {
  v1::FitSummaryRequest request;
  SummarySet set = SetOf(Yard().file, "yard.exr");
  set.lights.resize(1);
  *request.add_summaries() = SummarySetToProto(set);
  SetMap(kMap, request.mutable_map());
  request.mutable_options()->set_search(v1::SEARCH_FOCUSED);
  testing::ExpectSurvivesMutations(request, AnswerFitSummary, 4000);
}

}  // namespace
}  // namespace lightfit
