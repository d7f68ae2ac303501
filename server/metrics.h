// server/metrics.h
//
// What the server counts and times, for Prometheus.
// In:   the events of calls.
// Out:  metrics lightfit_*, as text; server/metrics_endpoint.h serves it.
//
// All functions may be called from any thread. Counters and gauges are an atomic addition, a
// histogram takes a short lock; names are looked up once for each method, not for each call, except
// those of errors.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"

namespace prometheus {
class Counter;
class Gauge;
class Histogram;
class Registry;
template <typename T>
class Family;
}  // namespace prometheus

namespace lightfit {

enum class Stage { kQueue, kDecode, kSolve };

class Metrics {
 public:
  // The figures of one method: lightfit_calls_total{method,code}, lightfit_call_seconds{method},
  // lightfit_calls_in_flight{method}, lightfit_stage_seconds{method,stage}.
  class Method {
   public:
    // Every call: one Started() and one Finished(). `duration` is the time between the two.
    void Started();
    void Finished(absl::StatusCode code, absl::Duration duration);

    void ObserveStage(Stage stage, absl::Duration duration);

   private:
    friend class Metrics;
    Method() = default;

    std::string name_;
    prometheus::Family<prometheus::Counter>* calls_ = nullptr;
    prometheus::Counter* ok_calls_ = nullptr;
    prometheus::Gauge* in_flight_ = nullptr;
    prometheus::Histogram* seconds_ = nullptr;
    std::array<prometheus::Histogram*, 3> stage_seconds_ = {};  // by Stage
  };

  // `version` is the label of lightfit_build_info. A limit of memory goes with AddReadbackMemory().
  Metrics(absl::string_view version, int64_t readback_memory_limit_bytes);
  ~Metrics();
  Metrics(const Metrics&) = delete;
  Metrics& operator=(const Metrics&) = delete;

  // The figures of the method "Fit", "Track", ...; lives as long as this object. Ask once and keep
  // it. Only for names from the schema: each makes some seventy time series, so a client's own
  // words must not reach this.
  Method& ForMethod(absl::string_view name);

  // Changes, up and down: values that are set could be overtaken by older ones.
  void AddQueued(int change);                // lightfit_queue_length
  void AddReadbackMemory(int64_t change);    // lightfit_readback_memory_bytes
  void AddWorkersBusy(int change);           // lightfit_workers_busy
  void AddPixels(int64_t num_pixels);        // lightfit_pixels_total
  void AddReceivedBytes(int64_t num_bytes);  // lightfit_received_bytes_total
  void LightDone(absl::StatusCode code);     // lightfit_lights_total{outcome}
  void Refused(absl::string_view reason);    // lightfit_refused_total{reason}; few reasons

  // Everything, in the text format that Prometheus scrapes.
  std::string Text() const;

 private:
  const std::unique_ptr<prometheus::Registry> registry_;
  prometheus::Family<prometheus::Counter>* calls_ = nullptr;
  prometheus::Family<prometheus::Counter>* lights_ = nullptr;
  prometheus::Family<prometheus::Counter>* refused_ = nullptr;
  prometheus::Family<prometheus::Gauge>* in_flight_ = nullptr;
  prometheus::Family<prometheus::Histogram>* seconds_ = nullptr;
  prometheus::Family<prometheus::Histogram>* stage_seconds_ = nullptr;
  prometheus::Gauge* queue_length_ = nullptr;
  prometheus::Gauge* readback_memory_ = nullptr;
  prometheus::Gauge* workers_busy_ = nullptr;
  prometheus::Counter* pixels_ = nullptr;
  prometheus::Counter* received_bytes_ = nullptr;
  prometheus::Counter* ok_lights_ = nullptr;

  std::mutex methods_mutex_;
  std::map<std::string, std::unique_ptr<Method>> methods_;
};

}  // namespace lightfit
