// server/metrics_endpoint.h
//
// The port that Prometheus scrapes.
// In:   an address, Metrics.
// Out:  GET http://ADDRESS/metrics, plain text; every other request gets an error and is closed.
//
// An HTTP server of its own, one connection after the other on one thread. That of prometheus-cpp
// (civetweb) runs on stacks of 100 kB, of which the thread-local data of Ceres' libraries take two
// thirds: its page for 404 then overflows the rest, and takes the whole process with it.
#pragma once

#include <memory>
#include <thread>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "server/metrics.h"

namespace lightfit {

class MetricsEndpoint {
 public:
  // `address` is as for ParseListenAddress(), host and port. What is served tells how a server is
  // used and asks for no password, so an address that other machines reach is refused unless
  // `allow_other_machines`. FailedPrecondition when the port is taken. `metrics` must outlive the
  // endpoint.
  static absl::StatusOr<std::unique_ptr<MetricsEndpoint>> Start(absl::string_view address,
                                                                const Metrics& metrics,
                                                                bool allow_other_machines = false);

  // Stops at once, whoever is connected.
  ~MetricsEndpoint();
  MetricsEndpoint(const MetricsEndpoint&) = delete;
  MetricsEndpoint& operator=(const MetricsEndpoint&) = delete;

  int port() const { return port_; }  // the one in use, also where the address said 0

 private:
  explicit MetricsEndpoint(const Metrics& metrics) : metrics_(metrics) {}

  void Run();
  void Answer(int connection);

  const Metrics& metrics_;
  int listener_ = -1;
  int stop_event_ = -1;  // readable when the thread must end
  int port_ = 0;
  std::thread thread_;
};

}  // namespace lightfit
