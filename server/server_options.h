// server/server_options.h
//
// Every choice of the server, in the words of `lightfit serve --help`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "absl/time/time.h"
#include "calls/call_context.h"
#include "server/tls.h"

namespace lightfit {

// What clients may take. Memory is at most about memory_bytes for read-backs, half as much again
// for what the network layer holds, and what the process needs by itself.
struct ServerLimits {
  CallLimits calls;
  int num_threads = 2;                            // that compute; >= 1
  int max_queue = 256;                            // calls that wait for a thread, >= 0
  int max_streams = 256;                          // FitStream and Track together, >= 1
  int64_t max_message_bytes = int64_t{16} << 20;  // of one message, >= 4096
  int64_t memory_bytes = int64_t{1} << 30;        // of requests and read-backs, all calls together
  absl::Duration upload_timeout =
      absl::Seconds(60);                            // from a read-back's first message to its last
  absl::Duration idle_timeout = absl::Minutes(10);  // of a Track stream between frames
};

struct ServerOptions {
  std::string listen = "127.0.0.1:50071";  // as ParseListenAddress()
  std::optional<TlsOptions> tls;           // without: plain text
  bool allow_insecure = false;             // whether plain text may leave this machine
  ServerLimits limits;

  std::string metrics_listen;  // "127.0.0.1:9471"; empty: no metrics port
  bool reflection = true;
  bool channelz = false;

  std::string log_path = "-";  // "-": stderr
  std::string log_level = "info";
};

// InvalidArgument names the option, its value and what is wanted.
absl::Status ValidateServerLimits(const ServerLimits& limits);

}  // namespace lightfit
