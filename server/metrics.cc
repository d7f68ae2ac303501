#include "server/metrics.h"

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include <algorithm>

namespace lightfit {
namespace {

using prometheus::Counter;
using prometheus::Family;
using prometheus::Gauge;
using prometheus::Histogram;
using prometheus::Registry;

// Seconds. A summary takes 200 us, an 8K read-back of 32 lights tens of seconds.
const Histogram::BucketBoundaries& Buckets() {
  static const auto& buckets = *new Histogram::BucketBoundaries{0.0001,
                                                                0.00025,
                                                                0.0005,
                                                                0.001,
                                                                0.0025,
                                                                0.005,
                                                                0.01,
                                                                0.025,
                                                                0.05,
                                                                0.1,
                                                                0.25,
                                                                0.5,
                                                                1.0,
                                                                2.5,
                                                                5.0,
                                                                10.0,
                                                                30.0};
  return buckets;
}

// A clock that was set back, or an infinite duration, must not turn sums into nonsense.
double Seconds(absl::Duration duration) {
  return absl::ToDoubleSeconds(std::clamp(duration, absl::ZeroDuration(), absl::Hours(24)));
}

std::string CodeName(absl::StatusCode code) {
  const std::string name = absl::StatusCodeToString(code);
  return name.empty() ? "UNKNOWN" : name;
}

Family<Counter>& Counters(Registry& registry, const char* name, const char* help) {
  return prometheus::BuildCounter().Name(name).Help(help).Register(registry);
}

Family<Gauge>& Gauges(Registry& registry, const char* name, const char* help) {
  return prometheus::BuildGauge().Name(name).Help(help).Register(registry);
}

Family<Histogram>& Histograms(Registry& registry, const char* name, const char* help) {
  return prometheus::BuildHistogram().Name(name).Help(help).Register(registry);
}

}  // namespace

void Metrics::Method::Started() { in_flight_->Increment(); }

void Metrics::Method::Finished(absl::StatusCode code, absl::Duration duration) {
  in_flight_->Decrement();
  seconds_->Observe(Seconds(duration));
  if (code == absl::StatusCode::kOk) {
    ok_calls_->Increment();
  } else {
    calls_->Add({{"method", name_}, {"code", CodeName(code)}}).Increment();
  }
}

void Metrics::Method::ObserveStage(Stage stage, absl::Duration duration) {
  stage_seconds_[static_cast<size_t>(stage)]->Observe(Seconds(duration));
}

Metrics::Metrics(absl::string_view version, int64_t readback_memory_limit_bytes)
    : registry_(std::make_unique<Registry>()) {
  Registry& registry = *registry_;
  calls_ = &Counters(registry, "lightfit_calls_total", "Calls answered, by status code.");
  seconds_ = &Histograms(
      registry, "lightfit_call_seconds", "Time from the arrival of a call to its answer.");
  stage_seconds_ = &Histograms(registry,
                               "lightfit_stage_seconds",
                               "Time of calls in the queue, in decoding and in solving.");
  in_flight_ = &Gauges(registry, "lightfit_calls_in_flight", "Calls that have no answer yet.");
  queue_length_ =
      &Gauges(registry, "lightfit_queue_length", "Jobs that wait for a worker.").Add({});
  workers_busy_ = &Gauges(registry, "lightfit_workers_busy", "Workers that solve.").Add({});
  readback_memory_ = &Gauges(registry,
                             "lightfit_readback_memory_bytes",
                             "Memory reserved for the read-backs of calls.")
                          .Add({});
  Gauges(registry,
         "lightfit_readback_memory_limit_bytes",
         "What lightfit_readback_memory_bytes cannot exceed.")
      .Add({})
      .Set(static_cast<double>(readback_memory_limit_bytes));
  pixels_ =
      &Counters(registry, "lightfit_pixels_total", "Pixels of the read-backs received.").Add({});
  received_bytes_ =
      &Counters(registry, "lightfit_received_bytes_total", "Bytes of the requests received.")
           .Add({});
  lights_ = &Counters(registry, "lightfit_lights_total", "Lights answered, by outcome.");
  ok_lights_ = &lights_->Add({{"outcome", "ok"}});
  refused_ = &Counters(
      registry, "lightfit_refused_total", "Calls refused to protect the server, by reason.");
  Gauges(registry, "lightfit_build_info", "Always 1; the label names the version.")
      .Add({{"version", std::string(version)}})
      .Set(1.0);
}

Metrics::~Metrics() = default;

Metrics::Method& Metrics::ForMethod(absl::string_view name) {
  const std::lock_guard lock(methods_mutex_);
  std::unique_ptr<Method>& method = methods_[std::string(name)];
  if (method == nullptr) {
    const prometheus::Labels labels = {{"method", std::string(name)}};
    method.reset(new Method);
    method->name_ = std::string(name);
    method->calls_ = calls_;
    method->ok_calls_ = &calls_->Add({{"method", method->name_}, {"code", "OK"}});
    method->in_flight_ = &in_flight_->Add(labels);
    method->seconds_ = &seconds_->Add(labels, Buckets());
    const char* const stages[] = {"queue", "decode", "solve"};
    for (size_t i = 0; i < 3; ++i) {
      method->stage_seconds_[i] =
          &stage_seconds_->Add({{"method", method->name_}, {"stage", stages[i]}}, Buckets());
    }
  }
  return *method;
}

void Metrics::AddQueued(int change) { queue_length_->Increment(change); }

void Metrics::AddReadbackMemory(int64_t change) {
  readback_memory_->Increment(static_cast<double>(change));
}

void Metrics::AddWorkersBusy(int change) { workers_busy_->Increment(change); }

void Metrics::AddPixels(int64_t num_pixels) { pixels_->Increment(static_cast<double>(num_pixels)); }

void Metrics::AddReceivedBytes(int64_t num_bytes) {
  received_bytes_->Increment(static_cast<double>(num_bytes));
}

void Metrics::LightDone(absl::StatusCode code) {
  if (code == absl::StatusCode::kOk) {
    ok_lights_->Increment();
  } else {
    lights_->Add({{"outcome", CodeName(code)}}).Increment();
  }
}

void Metrics::Refused(absl::string_view reason) {
  refused_->Add({{"reason", std::string(reason)}}).Increment();
}

std::string Metrics::Text() const {
  return prometheus::TextSerializer().Serialize(registry_->Collect());
}

}  // namespace lightfit
