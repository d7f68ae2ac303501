// cli/serve.h
//
// `lightfit serve`: the gRPC server, until it is told to stop.
#pragma once

#include <functional>

#include "absl/time/time.h"
#include "server/server_options.h"

namespace CLI {
class App;
}

namespace lightfit::cli {

struct ServeFlags {
  ServerOptions server;
  absl::Duration drain_delay;                      // before calls are refused
  absl::Duration drain_limit = absl::Seconds(30);  // for calls to finish
};

std::function<int()> DeclareServe(CLI::App* app);

// Serves until SIGTERM or SIGINT, then drains; a second one ends the process at once. SIGHUP opens
// the log anew.
int RunServe(const ServeFlags& flags);

}  // namespace lightfit::cli
