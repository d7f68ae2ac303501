// server/tls.h
//
// TLS credentials of a gRPC server that follow their files while it runs.
// In:   PEM files, which may be replaced at any time and in any order, written in place, renamed or
//       behind a symbolic link.
// Out:  grpc::ServerCredentials: new connections get the latest files that hold together.
//
// gRPC can watch files itself, but aborts the process when it meets a certificate that is half
// written or has another key. So a thread here reads the files, checks them (server/tls_files.h),
// and hands gRPC consistent ones through a file that has no name and never reaches a disk.
#pragma once

#include <grpcpp/security/server_credentials.h>

#include <functional>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "server/tls_files.h"

namespace lightfit {

// Called from the thread that reads the files, and from Start().
struct TlsLog {
  std::function<void(const std::string& message)> info;     // files reloaded
  std::function<void(const std::string& message)> warning;  // refused, once each; dates
};

class ReloadingCredentials {
 public:
  // InvalidArgument or NotFound names the file and what is wrong with it. Needs /proc.
  static absl::StatusOr<std::unique_ptr<ReloadingCredentials>> Start(TlsOptions options,
                                                                     TlsLog log);

  // Stops following the files. Servers that use the credentials go on with the last ones.
  ~ReloadingCredentials();
  ReloadingCredentials(const ReloadingCredentials&) = delete;
  ReloadingCredentials& operator=(const ReloadingCredentials&) = delete;

  // Clients need a certificate of TlsOptions::client_ca_path, where that is given.
  std::shared_ptr<grpc::ServerCredentials> credentials() const { return credentials_; }

 private:
  class Follower;

  ReloadingCredentials();

  std::unique_ptr<Follower> follower_;
  std::shared_ptr<grpc::ServerCredentials> credentials_;
};

}  // namespace lightfit
