// What a server refuses, and what it stops.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <string>
#include <thread>

#include "tests/server/test_server.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::LongFitRequest;
using testing::QuietOptions;
using testing::TestServer;
using testing::YardFitRequest;

constexpr char kPushbackKey[] = "grpc-retry-pushback-ms";

bool HasPushback(const grpc::ClientContext& context) {
  return context.GetServerTrailingMetadata().count(kPushbackKey) > 0;
}

void WaitUntilIdle(TestServer& server) {
  while (server.server().num_calls() > 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

TEST(Limits, ADeadlineStopsTheSearch) {
  ServerOptions options = QuietOptions();
  options.limits.max_message_bytes = 64 << 20;
  TestServer server(options);
  const v1::FitRequest request = LongFitRequest();
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::milliseconds(300));
  v1::FitResult result;
  const grpc::Status status = server.stub().Fit(&context, request, &result);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::DEADLINE_EXCEEDED) << status.error_message();
  const auto begin = std::chrono::steady_clock::now();
  WaitUntilIdle(server);  // for ever, if the search were not stopped within the test's time
  const std::chrono::duration<double, std::milli> duration =
      std::chrono::steady_clock::now() - begin;
  std::cout << "the server was done " << duration.count() << " ms after the client\n";
}

TEST(Limits, ACancelledCallStopsTheSearch) {
  ServerOptions options = QuietOptions();
  options.limits.max_message_bytes = 64 << 20;
  TestServer server(options);
  const v1::FitRequest request = LongFitRequest();
  grpc::ClientContext context;
  v1::FitResult result;
  grpc::Status status;
  std::thread call([&] { status = server.stub().Fit(&context, request, &result); });
  while (server.server().num_calls() == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  context.TryCancel();
  call.join();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::CANCELLED) << status.error_message();
  WaitUntilIdle(server);
}

TEST(Limits, AFullQueueSaysWhenToTryAgain) {
  ServerOptions options = QuietOptions();
  options.limits.max_message_bytes = 64 << 20;
  options.limits.num_threads = 1;
  options.limits.max_queue = 0;
  TestServer server(options);
  const v1::FitRequest long_request = LongFitRequest(), request = YardFitRequest();
  grpc::ClientContext long_context;
  v1::FitResult long_result;
  std::thread call([&] { server.stub().Fit(&long_context, long_request, &long_result); });
  while (server.server().num_calls() == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  grpc::ClientContext context;
  v1::FitResult result;
  const grpc::Status status = server.stub().Fit(&context, request, &result);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << status.error_message();
  EXPECT_THAT(status.error_message(), HasSubstr("try again in"));
  EXPECT_TRUE(HasPushback(context));
  long_context.TryCancel();
  call.join();
}

TEST(Limits, ReadbacksBeyondTheMemoryAreRefusedBeforeTheyAreSent) {
  ServerOptions options = QuietOptions();
  options.limits.memory_bytes = 1 << 20;
  TestServer server(options);
  v1::FitRequest request = YardFitRequest();
  request.mutable_readback()->mutable_camera()->set_width(2000);
  request.mutable_readback()->mutable_camera()->set_height(2000);
  grpc::ClientContext context;
  v1::FitResult result;
  const auto writer = server.stub().FitStream(&context, &result);
  v1::FitStreamRequest first;
  *first.mutable_request() = request;
  *first.mutable_request()->mutable_readback() = testing::WithoutPixels(request.readback());
  writer->Write(first);
  const grpc::Status status = writer->Finish();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << status.error_message();
  EXPECT_THAT(status.error_message(), HasSubstr("--memory-mib"));
  EXPECT_FALSE(HasPushback(context));  // trying again would not help
}

TEST(Limits, AMessageThatIsTooLargeIsRefusedForGood) {
  ServerOptions options = QuietOptions();
  options.limits.max_message_bytes = 1 << 20;
  TestServer server(options);
  const v1::FitRequest request = LongFitRequest();
  grpc::ClientContext context;
  v1::FitResult result;
  const grpc::Status status = server.stub().Fit(&context, request, &result);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << status.error_message();
  EXPECT_FALSE(HasPushback(context));
}

int64_t ResidentBytes() {
  std::ifstream file("/proc/self/statm");
  int64_t size = 0, resident = 0;
  file >> size >> resident;
  return resident * 4096;
}

// A message of zeros packs a thousandfold: unpacked it would be far above the limit.
TEST(Limits, PackedMessagesAreRefusedUnopened) {
  constexpr int64_t kUnpackedBytes = int64_t{512} << 20;
  TestServer server;
  v1::FitRequest request;
  request.mutable_readback()->set_depth(std::string(kUnpackedBytes, '\0'));
  for (const grpc_compression_algorithm algorithm : {GRPC_COMPRESS_GZIP, GRPC_COMPRESS_DEFLATE}) {
    grpc::ClientContext context;
    context.set_compression_algorithm(algorithm);
    v1::FitResult result;
    const int64_t before = ResidentBytes();
    const grpc::Status status = server.stub().Fit(&context, request, &result);
    std::cout << status.error_code() << ": " << status.error_message() << "\n"
              << ((ResidentBytes() - before) >> 20) << " MiB more than before\n";
    EXPECT_EQ(status.error_code(), grpc::StatusCode::UNIMPLEMENTED) << status.error_message();
  }
}

TEST(Limits, AnUploadThatStallsIsEnded) {
  ServerOptions options = QuietOptions();
  options.limits.upload_timeout = absl::Milliseconds(200);
  TestServer server(options);
  const v1::FitRequest request = YardFitRequest();
  grpc::ClientContext context;
  v1::FitResult result;
  const auto writer = server.stub().FitStream(&context, &result);
  v1::FitStreamRequest first;
  *first.mutable_request() = request;
  *first.mutable_request()->mutable_readback() = testing::WithoutPixels(request.readback());
  writer->Write(first);
  const grpc::Status status = writer->Finish();  // the server's word
  EXPECT_EQ(status.error_code(), grpc::StatusCode::DEADLINE_EXCEEDED) << status.error_message();
  EXPECT_THAT(status.error_message(), HasSubstr("200ms"));

  grpc::ClientContext track_context;
  const auto stream = server.stub().Track(&track_context);
  v1::TrackRequest setup, frame;
  *setup.mutable_setup() = testing::WithMap(v1::TrackSetup());
  *frame.mutable_frame()->mutable_readback() = testing::WithoutPixels(request.readback());
  *frame.mutable_frame()->mutable_lights() = request.lights();
  stream->Write(setup);
  stream->Write(frame);
  EXPECT_EQ(stream->Finish().error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
  WaitUntilIdle(server);
}

TEST(Limits, AStreamWithoutFramesIsEnded) {
  ServerOptions options = QuietOptions();
  options.limits.idle_timeout = absl::Milliseconds(200);
  TestServer server(options);
  grpc::ClientContext context;
  const auto stream = server.stub().Track(&context);
  v1::TrackRequest setup;
  *setup.mutable_setup() = testing::WithMap(v1::TrackSetup());
  stream->Write(setup);
  const grpc::Status status = stream->Finish();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::DEADLINE_EXCEEDED) << status.error_message();
  EXPECT_THAT(status.error_message(), HasSubstr("no frame for 200ms"));
}

TEST(Start, SaysWhatIsWrongWithItsOptions) {
  const auto expect_refused = [](const ServerOptions& options, const std::string& words) {
    const auto server = Server::Start(options);
    ASSERT_FALSE(server.ok()) << words;
    EXPECT_THAT(std::string(server.status().message()), HasSubstr(words));
  };
  ServerOptions options = QuietOptions();
  options.listen = "0.0.0.0:0";
  expect_refused(options, "--insecure");
  options = QuietOptions();
  options.limits.num_threads = 0;
  expect_refused(options, "--threads 0: want at least 1");
  options = QuietOptions();
  options.listen = "127.0.0.1";
  expect_refused(options, "port");
  options = QuietOptions();
  options.log_path = "/dev/null/server.log";
  expect_refused(options, "/dev/null/server.log");
  TestServer other;
  options = QuietOptions();
  options.listen = other.server().address();
  expect_refused(options, "cannot listen there");
}

TEST(Drain, AnswersWhatWasTakenAndRefusesTheRest) {
  ServerOptions options = QuietOptions();
  options.limits.num_threads = 1;
  TestServer server(options);
  const v1::FitRequest request = YardFitRequest();

  // An open Track stream must not hold the drain up.
  grpc::ClientContext track_context;
  const auto stream = server.stub().Track(&track_context);
  v1::TrackRequest setup;
  *setup.mutable_setup() = testing::WithMap(v1::TrackSetup());
  stream->Write(setup);

  constexpr int kNumCalls = 16;
  std::vector<std::thread> calls;
  std::vector<grpc::Status> statuses(kNumCalls);
  for (int i = 0; i < kNumCalls; ++i) {
    calls.emplace_back([&, i] {
      grpc::ClientContext context;
      v1::FitResult result;
      statuses[i] = server.stub().Fit(&context, request, &result);
    });
  }
  while (server.server().num_calls() < 4) std::this_thread::yield();
  EXPECT_TRUE(server.server().Drain(absl::ZeroDuration(), absl::Seconds(60)));
  for (std::thread& call : calls) call.join();
  int num_answered = 0;
  for (const grpc::Status& status : statuses) {
    num_answered += status.ok() ? 1 : 0;
    if (!status.ok()) {
      EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAVAILABLE) << status.error_message();
    }
  }
  std::cout << num_answered << " of " << kNumCalls << " answered\n";
  EXPECT_GE(num_answered, 3);
  EXPECT_EQ(stream->Finish().error_code(), grpc::StatusCode::UNAVAILABLE);
}

}  // namespace
}  // namespace lightfit
