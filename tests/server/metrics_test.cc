#include "server/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <thread>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_split.h"

namespace lightfit {
namespace {

// The value of the time series written exactly so, NaN where there is none.
double Value(absl::string_view text, absl::string_view series) {
  for (const absl::string_view line : absl::StrSplit(text, '\n')) {
    double value = 0.0;
    const size_t space = line.rfind(' ');
    if (space != absl::string_view::npos && line.substr(0, space) == series &&
        absl::SimpleAtod(line.substr(space + 1), &value)) {
      return value;
    }
  }
  return NAN;
}

TEST(Metrics, CallsAreCountedByMethodAndCode) {
  Metrics metrics("1.2.3", 1000);
  Metrics::Method& fit = metrics.ForMethod("Fit");
  EXPECT_EQ(&metrics.ForMethod("Fit"), &fit);
  for (int i = 0; i < 3; ++i) fit.Started();
  EXPECT_EQ(Value(metrics.Text(), "lightfit_calls_in_flight{method=\"Fit\"}"), 3);
  fit.Finished(absl::StatusCode::kOk, absl::Milliseconds(3));
  fit.Finished(absl::StatusCode::kInvalidArgument, absl::Milliseconds(40));
  fit.ObserveStage(Stage::kQueue, absl::Microseconds(50));
  fit.ObserveStage(Stage::kDecode, absl::Milliseconds(1));
  fit.ObserveStage(Stage::kSolve, absl::Seconds(60));
  metrics.ForMethod("Track").Started();

  const std::string text = metrics.Text();
  EXPECT_EQ(Value(text, "lightfit_calls_in_flight{method=\"Fit\"}"), 1);
  EXPECT_EQ(Value(text, "lightfit_calls_in_flight{method=\"Track\"}"), 1);
  EXPECT_EQ(Value(text, "lightfit_calls_total{code=\"OK\",method=\"Fit\"}"), 1);
  EXPECT_EQ(Value(text, "lightfit_calls_total{code=\"INVALID_ARGUMENT\",method=\"Fit\"}"), 1);
  EXPECT_EQ(Value(text, "lightfit_calls_total{code=\"OK\",method=\"Track\"}"), 0);
  EXPECT_EQ(Value(text, "lightfit_call_seconds_count{method=\"Fit\"}"), 2);
  EXPECT_NEAR(Value(text, "lightfit_call_seconds_sum{method=\"Fit\"}"), 0.043, 1e-12);
  EXPECT_EQ(Value(text, "lightfit_call_seconds_bucket{method=\"Fit\",le=\"0.0025\"}"), 0);
  EXPECT_EQ(Value(text, "lightfit_call_seconds_bucket{method=\"Fit\",le=\"0.005\"}"), 1);
  const std::string stage = "lightfit_stage_seconds_bucket{method=\"Fit\",stage=";
  EXPECT_EQ(Value(text, stage + "\"queue\",le=\"0.0001\"}"), 1);
  EXPECT_EQ(Value(text, stage + "\"decode\",le=\"0.001\"}"), 1);
  EXPECT_EQ(Value(text, stage + "\"solve\",le=\"30\"}"), 0);
  EXPECT_EQ(Value(text, stage + "\"solve\",le=\"+Inf\"}"), 1);
}

TEST(Metrics, TotalsAndGauges) {
  Metrics metrics("1.2.3", 1000);
  for (int i = 0; i < 8; ++i) metrics.AddQueued(1);
  metrics.AddQueued(-1);
  metrics.AddReadbackMemory(1000);
  metrics.AddReadbackMemory(-400);
  metrics.AddWorkersBusy(1);
  metrics.AddWorkersBusy(1);
  metrics.AddWorkersBusy(-1);
  metrics.AddPixels(32400);
  metrics.AddPixels(100);
  metrics.AddReceivedBytes(int64_t{3} << 32);
  metrics.LightDone(absl::StatusCode::kOk);
  metrics.LightDone(absl::StatusCode::kOk);
  metrics.LightDone(absl::StatusCode::kFailedPrecondition);
  metrics.Refused("queue");
  const std::string text = metrics.Text();
  EXPECT_EQ(Value(text, "lightfit_queue_length"), 7);
  EXPECT_EQ(Value(text, "lightfit_readback_memory_bytes"), 600);
  EXPECT_EQ(Value(text, "lightfit_readback_memory_limit_bytes"), 1000);
  EXPECT_EQ(Value(text, "lightfit_workers_busy"), 1);
  EXPECT_EQ(Value(text, "lightfit_pixels_total"), 32500);
  EXPECT_EQ(Value(text, "lightfit_received_bytes_total"), 12884901888.0);
  EXPECT_EQ(Value(text, "lightfit_lights_total{outcome=\"ok\"}"), 2);
  EXPECT_EQ(Value(text, "lightfit_lights_total{outcome=\"FAILED_PRECONDITION\"}"), 1);
  EXPECT_EQ(Value(text, "lightfit_refused_total{reason=\"queue\"}"), 1);
  EXPECT_EQ(Value(text, "lightfit_build_info{version=\"1.2.3\"}"), 1);
}

TEST(Metrics, AbsurdDurationsLeaveSumsFinite) {
  Metrics metrics("1", 0);
  Metrics::Method& fit = metrics.ForMethod("Fit");
  fit.ObserveStage(Stage::kSolve, absl::InfiniteDuration());
  fit.ObserveStage(Stage::kSolve, -absl::InfiniteDuration());
  fit.ObserveStage(Stage::kSolve, absl::Seconds(-5));
  EXPECT_EQ(Value(metrics.Text(), "lightfit_stage_seconds_sum{method=\"Fit\",stage=\"solve\"}"),
            86400);
}

TEST(Metrics, NothingIsLostWithManyThreads) {
  constexpr int kNumThreads = 4, kNumCalls = 2000;
  Metrics metrics("1", 0);
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < kNumThreads; ++i) {
      threads.emplace_back([&metrics] {
        Metrics::Method& fit = metrics.ForMethod("Fit");
        for (int call = 0; call < kNumCalls; ++call) {
          fit.Started();
          fit.Finished(call % 2 == 0 ? absl::StatusCode::kOk : absl::StatusCode::kCancelled,
                       absl::Milliseconds(1));
          metrics.AddPixels(1);
        }
      });
    }
  }
  const std::string text = metrics.Text();
  const double half = 0.5 * kNumThreads * kNumCalls;
  EXPECT_EQ(Value(text, "lightfit_calls_total{code=\"OK\",method=\"Fit\"}"), half);
  EXPECT_EQ(Value(text, "lightfit_calls_total{code=\"CANCELLED\",method=\"Fit\"}"), half);
  EXPECT_EQ(Value(text, "lightfit_calls_in_flight{method=\"Fit\"}"), 0);
  EXPECT_EQ(Value(text, "lightfit_pixels_total"), 2 * half);
}

}  // namespace
}  // namespace lightfit
