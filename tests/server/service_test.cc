// Every method, against the function of calls/ behind it, over a real connection.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "calls/allocate_call.h"
#include "calls/evaluate_call.h"
#include "calls/fit_call.h"
#include "calls/pixel_buffer.h"
#include "calls/summary_call.h"
#include "calls/track_session.h"
#include "tests/server/test_server.h"
#include "wire/options_proto.h"
#include "wire/summary_proto.h"

namespace lightfit {
namespace {

using testing::FitInStream;
using ::testing::HasSubstr;
using testing::TestServer;
using testing::Yard;
using testing::YardFitRequest;

void ExpectOk(const grpc::Status& status) {
  EXPECT_TRUE(status.ok()) << status.error_code() << ": " << status.error_message();
}

void ExpectRefused(const grpc::Status& status, grpc::StatusCode code, const std::string& words) {
  EXPECT_EQ(status.error_code(), code) << status.error_message();
  EXPECT_THAT(status.error_message(), HasSubstr(words));
}

template <typename Message>
void ExpectSame(const Message& found, const absl::StatusOr<Message>& want) {
  ASSERT_THAT(want, testing::IsOk());
  EXPECT_EQ(found.SerializeAsString(), want->SerializeAsString());
}

TEST(Service, FitGivesTheLibrarysMatrices) {
  TestServer server;
  const v1::FitRequest request = YardFitRequest();
  grpc::ClientContext context;
  v1::FitResult result;
  ExpectOk(server.stub().Fit(&context, request, &result));
  ExpectSame(result, AnswerFit(request, CallContext()));
}

TEST(Service, FitStreamGivesTheSameAsFit) {
  TestServer server;
  const v1::FitRequest request = YardFitRequest();
  for (const size_t chunk_bytes : {size_t{4000}, size_t{1} << 20}) {
    grpc::ClientContext context;
    v1::FitResult result;
    ExpectOk(FitInStream(server.stub(), request, chunk_bytes, &context, &result));
    ExpectSame(result, AnswerFit(request, CallContext()));
  }
}

// Whole and in chunks, and frame by frame.
TEST(Service, PlansComeAsMatricesDo) {
  TestServer server;
  v1::FitRequest request = YardFitRequest();
  request.clear_map();
  request.mutable_plan_options()->set_max_maps(3);
  request.mutable_plan_options()->set_texels(90000);
  const absl::StatusOr<v1::FitResult> want = AnswerFit(request, CallContext());
  grpc::ClientContext whole, chunks;
  v1::FitResult result;
  ExpectOk(server.stub().Fit(&whole, request, &result));
  ExpectSame(result, want);
  EXPECT_EQ(result.lights(0).plan().maps_size(), 3);
  ExpectOk(FitInStream(server.stub(), request, 100000, &chunks, &result));
  ExpectSame(result, want);

  v1::TrackSetup setup;
  *setup.mutable_plan_options() = request.plan_options();
  auto session = TrackSession::Begin(setup);
  ASSERT_THAT(session, testing::IsOk());
  grpc::ClientContext context;
  const auto stream = server.stub().Track(&context);
  v1::TrackRequest message;
  *message.mutable_setup() = setup;
  ASSERT_TRUE(stream->Write(message));
  for (int f = 0; f < 2; ++f) {
    const ReadbackFile file = testing::FrameOfYard(f);
    const auto frame = testing::RequestOf<v1::TrackFrame>(file.View(), Yard().lights);
    *message.mutable_frame() = frame;
    ASSERT_TRUE(stream->Write(message));
    v1::TrackResult tracked;
    ASSERT_TRUE(stream->Read(&tracked));
    EXPECT_EQ(tracked.result().lights(0).shot().plan().is_new(), f == 0);
    EXPECT_EQ(tracked.SerializeAsString(),
              session->Update(frame, file.View(), {}).SerializeAsString());
  }
  stream->WritesDone();
  ExpectOk(stream->Finish());
}

TEST(Service, PlansOfMoreMapsThanTheServerTakesAreRefused) {
  ServerOptions options = testing::QuietOptions();
  options.limits.calls.max_maps = 2;
  TestServer server(options);
  v1::FitRequest request = YardFitRequest();
  request.clear_map();
  request.mutable_plan_options()->set_max_maps(3);
  grpc::ClientContext fit, track;
  v1::FitResult result;
  const std::string words = "plan_options.max_maps = 3, and this server takes at most 2";
  ExpectRefused(
      server.stub().Fit(&fit, request, &result), grpc::StatusCode::RESOURCE_EXHAUSTED, words);
  const auto stream = server.stub().Track(&track);
  v1::TrackRequest message;
  *message.mutable_setup()->mutable_plan_options() = request.plan_options();
  stream->Write(message);
  stream->WritesDone();
  ExpectRefused(stream->Finish(), grpc::StatusCode::RESOURCE_EXHAUSTED, words);

  auto allocate = testing::RequestOf<v1::AllocateRequest>(Yard().file.View(), Yard().lights);
  allocate.set_budget_texels(360000);
  *allocate.mutable_plan_options() = request.plan_options();
  grpc::ClientContext refused, taken;
  v1::Allocation allocation;
  ExpectRefused(server.stub().Allocate(&refused, allocate, &allocation),
                grpc::StatusCode::RESOURCE_EXHAUSTED,
                words);
  allocate.mutable_plan_options()->set_max_maps(2);
  ExpectOk(server.stub().Allocate(&taken, allocate, &allocation));
  EXPECT_EQ(allocation.lights(0).plan().maps_size(), 2);
}

TEST(Service, FacingPlanesComeWholeOrInChunks) {
  TestServer server;
  v1::FitRequest request = YardFitRequest();
  *request.mutable_readback() =
      testing::WithFacingPlanes(request.readback(), request.lights_size());
  const absl::StatusOr<v1::FitResult> want = AnswerFit(request, CallContext());
  {
    grpc::ClientContext context;
    v1::FitResult result;
    ExpectOk(server.stub().Fit(&context, request, &result));
    ExpectSame(result, want);
  }
  for (const size_t chunk_bytes : {size_t{4000}, size_t{1} << 20}) {
    grpc::ClientContext context;
    v1::FitResult result;
    ExpectOk(FitInStream(server.stub(), request, chunk_bytes, &context, &result));
    ExpectSame(result, want);
  }
  request.mutable_readback()->mutable_facing_planes(2)->pop_back();
  grpc::ClientContext whole, stream;
  v1::FitResult result;
  const std::string words = "readback.facing_planes[2]: 32399 bytes, want 32400";
  ExpectRefused(
      server.stub().Fit(&whole, request, &result), grpc::StatusCode::INVALID_ARGUMENT, words);
  ExpectRefused(FitInStream(server.stub(), request, 4000, &stream, &result),
                grpc::StatusCode::INVALID_ARGUMENT,
                words);
}

TEST(Service, FitSummaryTakesMessagesAndFiles) {
  TestServer server;
  v1::FitSummaryRequest request = testing::WithMap(v1::FitSummaryRequest());
  const std::vector<SummarySet> frames = testing::FramesOfYard(2);
  *request.add_summaries() = SummarySetToProto(frames[0]);
  request.add_summary_files(*SerializeSummarySet(frames[1], "test"));
  grpc::ClientContext context;
  v1::FitResult result;
  ExpectOk(server.stub().FitSummary(&context, request, &result));
  ExpectSame(result, AnswerFitSummary(request, CallContext()));
}

TEST(Service, EvaluateJudgesTheCallersMatrices) {
  TestServer server;
  const v1::FitRequest fit = YardFitRequest();
  const absl::StatusOr<v1::FitResult> fitted = AnswerFit(fit, CallContext());
  v1::EvaluateRequest request;
  *request.mutable_readback() = fit.readback();
  *request.mutable_lights() = fit.lights();
  for (const v1::LightResult& light : fitted->lights()) {
    v1::CandidateMatrix& candidate = *request.add_matrices();
    candidate.set_light(light.name());
    *candidate.mutable_map_from_world() = light.map_from_world();
    *candidate.mutable_map() = light.map();
  }
  grpc::ClientContext context;
  v1::EvaluateResult result;
  ExpectOk(server.stub().Evaluate(&context, request, &result));
  ExpectSame(result, AnswerEvaluate(request, CallContext()));
}

TEST(Service, AllocateSplitsABudget) {
  TestServer server;
  const v1::FitRequest fit = YardFitRequest();
  v1::AllocateRequest request;
  *request.mutable_readback() = fit.readback();
  *request.mutable_lights() = fit.lights();
  request.set_budget_texels(2048 * 2048);
  grpc::ClientContext context;
  v1::Allocation result;
  ExpectOk(server.stub().Allocate(&context, request, &result));
  ExpectSame(result, AnswerAllocate(request, CallContext()));
}

// Frames whole and in chunks, one of which cannot be used.
TEST(Service, TrackAnswersFrameByFrame) {
  TestServer server;
  v1::TrackSetup setup = testing::WithMap(v1::TrackSetup());
  setup.set_stability(0.5);
  auto session = TrackSession::Begin(setup);
  ASSERT_THAT(session, testing::IsOk());

  grpc::ClientContext context;
  const auto stream = server.stub().Track(&context);
  v1::TrackRequest first;
  *first.mutable_setup() = setup;
  ASSERT_TRUE(stream->Write(first));
  for (int f = 0; f < 4; ++f) {
    const ReadbackFile file = testing::FrameOfYard(f);
    auto frame = testing::RequestOf<v1::TrackFrame>(file.View(), Yard().lights);
    frame.set_number(f);
    if (f == 1) {
      *frame.mutable_readback() = testing::WithFacingPlanes(frame.readback(), frame.lights_size());
    }
    if (f == 2) frame.mutable_readback()->mutable_camera()->set_width(0);
    const v1::Readback whole = frame.readback();
    if (f == 1 || f == 2) *frame.mutable_readback() = testing::WithoutPixels(whole);
    v1::TrackRequest request;
    *request.mutable_frame() = frame;
    ASSERT_TRUE(stream->Write(request));
    if (f == 1 || f == 2) {
      for (const v1::PixelChunk& chunk : testing::Chunks(whole, 100000)) {
        v1::TrackRequest part;
        *part.mutable_pixels() = chunk;
        ASSERT_TRUE(stream->Write(part));
      }
    }
    v1::TrackResult result;
    ASSERT_TRUE(stream->Read(&result));
    EXPECT_EQ(result.number(), f);
    if (f == 2) {
      EXPECT_EQ(result.status().code(), 3);
      EXPECT_THAT(result.status().message(), HasSubstr("readback.camera"));
      continue;
    }
    const auto view = ReadbackView::Of(whole, frame.lights_size(), CallLimits());
    ASSERT_THAT(view, testing::IsOk());
    EXPECT_EQ(result.SerializeAsString(),
              session->Update(frame, view->view(), {}).SerializeAsString());
  }
  stream->WritesDone();
  v1::TrackResult more;
  EXPECT_FALSE(stream->Read(&more));
  ExpectOk(stream->Finish());
}

TEST(Service, StreamsThatMakeNoSenseAreRefused) {
  TestServer server;
  const v1::FitRequest request = YardFitRequest();
  const auto send = [&](const std::vector<v1::FitStreamRequest>& parts) {
    grpc::ClientContext context;
    v1::FitResult result;
    const auto writer = server.stub().FitStream(&context, &result);
    for (const v1::FitStreamRequest& part : parts) {
      if (!writer->Write(part)) break;
    }
    writer->WritesDone();
    return writer->Finish();
  };
  constexpr grpc::StatusCode kInvalid = grpc::StatusCode::INVALID_ARGUMENT;
  v1::FitStreamRequest first, pixels, large;
  *first.mutable_request() = request;
  *first.mutable_request()->mutable_readback() = testing::WithoutPixels(request.readback());
  pixels.mutable_pixels()->set_depth("1234");
  large.mutable_pixels()->set_depth(std::string(2 << 20, '\0'));
  ExpectRefused(send({}), kInvalid, "ended before its first message");
  ExpectRefused(send({pixels}), kInvalid, "pixels: come before request");
  ExpectRefused(send({v1::FitStreamRequest()}), kInvalid, "message is empty");
  ExpectRefused(send({first, first}), kInvalid, "request: is here already");
  ExpectRefused(send({first, large}), kInvalid, "want at most 1 MiB");
  ExpectRefused(send({first, pixels}), kInvalid, "readback.depth: 4 bytes, want");

  grpc::ClientContext context;
  const auto stream = server.stub().Track(&context);
  v1::TrackRequest frame;
  frame.mutable_frame();
  stream->Write(frame);
  stream->WritesDone();
  ExpectRefused(stream->Finish(), kInvalid, "first message is not setup");
}

TEST(Service, RequestIdsComeBack) {
  TestServer server;
  const v1::FitRequest request = YardFitRequest();
  const auto id_for = [&](const std::string& sent) {
    grpc::ClientContext context;
    if (!sent.empty()) context.AddMetadata("x-request-id", sent);
    v1::FitResult result;
    ExpectOk(server.stub().Fit(&context, request, &result));
    const auto found = context.GetServerInitialMetadata().find("x-request-id");
    EXPECT_NE(found, context.GetServerInitialMetadata().end());
    return std::string(found->second.data(), found->second.size());
  };
  EXPECT_EQ(id_for("shot 7, frame 12"), "shot 7, frame 12");
  EXPECT_EQ(id_for("").size(), 16u);
  EXPECT_EQ(id_for(std::string(500, 'x')).size(), 16u);
}

}  // namespace
}  // namespace lightfit
