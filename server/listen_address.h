// server/listen_address.h
//
// Where a server listens: parsed, checked and named before gRPC is asked, whose own errors say
// little.
// In:   "127.0.0.1:50071", "[::1]:0", "localhost:50071", "0.0.0.0:50071",
//       "unix:/run/lightfit.sock".
// Out:  ListenAddress.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace lightfit {

struct ListenAddress {
  std::string target;        // for grpc::ServerBuilder::AddListeningPort()
  bool is_unix = false;      // then `path` is set, else `host` and `port`
  bool is_loopback = false;  // reached from this machine alone; unix sockets are
  std::string host;          // without brackets
  int port = 0;              // 0: the system chooses
  std::string path;          // absolute
};

// InvalidArgument says what is missing. Names other than "localhost" are not looked up, and count
// as reached from elsewhere.
absl::StatusOr<ListenAddress> ParseListenAddress(absl::string_view text);

// Makes way for a unix socket: removes a socket at `path` that nobody listens on, as a killed
// server leaves it. FailedPrecondition when another server listens there, for gRPC would silently
// take the path from it; when something other than a socket is there; when the folder does not
// exist. Two servers that start in the same instant can still take the path from one another.
absl::Status PrepareUnixSocket(const std::string& path);

}  // namespace lightfit
