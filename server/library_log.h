// server/library_log.h
//
// What gRPC and protobuf themselves have to say, in the server's log instead of on stderr.
#pragma once

#include "server/call_log.h"

namespace lightfit {

// As long as it lives; of several in a process the last one made counts.
class LibraryLogRoute {
 public:
  explicit LibraryLogRoute(const CallLog* log);
  ~LibraryLogRoute();

  LibraryLogRoute(const LibraryLogRoute&) = delete;
  LibraryLogRoute& operator=(const LibraryLogRoute&) = delete;

 private:
  const CallLog* log_;
};

}  // namespace lightfit
