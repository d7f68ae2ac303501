// server/server.h
//
// The server: starts, serves, drains.
// In:   ServerOptions.
// Out:  lightfit.v1.LightFit on a port or socket, with health, reflection, metrics and a log.
#pragma once

#include <grpcpp/impl/codegen/service_type.h>

#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "server/server_options.h"

namespace lightfit {

class Server {
 public:
  // Listens when this returns. `more_services` are served beside ours and must outlive the server:
  // for tests and benchmarks. Errors name the option and the way out: InvalidArgument,
  // FailedPrecondition when an address is taken or plain text would leave this machine.
  static absl::StatusOr<std::unique_ptr<Server>> Start(
      const ServerOptions& options, const std::vector<grpc::Service*>& more_services = {});

  // Ends what is still under way at once; see Drain().
  ~Server();

  // Where it listens, the port that the system chose included: "127.0.0.1:50071", "unix:/path".
  const std::string& address() const { return address_; }
  int metrics_port() const;  // 0 without

  // That were taken and are not answered yet, streams included.
  int num_calls() const;

  // Health says NOT_SERVING at once; calls are taken for `delay` more, so that load balancers
  // notice first; then new calls are refused (UNAVAILABLE) and Track streams end after the frame in
  // work. Returns true when all calls that were taken have been answered, false when `limit` after
  // that some were not and have been cancelled. Afterwards nothing is served.
  bool Drain(absl::Duration delay, absl::Duration limit);

  // Opens the log file anew, after its rotation.
  absl::Status ReopenLog();

 private:
  struct Parts;
  explicit Server(std::unique_ptr<Parts> parts);

  std::unique_ptr<Parts> parts_;
  std::string address_;
};

}  // namespace lightfit
