// server/tls_files.h
//
// The files of a TLS server, checked before anything is served from them.
// In:   paths of PEM files: a certificate with its chain, its key, the CAs of clients.
// Out:  TlsFiles that hold together, or a Status that names the file and the way out.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace lightfit {

struct TlsOptions {
  std::string certificate_path;  // the server's, then intermediate ones in the order of the chain
  std::string key_path;          // the key of the first certificate, not encrypted
  std::string client_ca_path;    // whose clients are let in; empty: clients need no certificate

  // How often the files are read; more than 0, at most a day. gRPC takes up to a second more to
  // serve what was found.
  absl::Duration reload_interval = absl::Seconds(5);
};

// What the files hold, PEM.
struct TlsFiles {
  std::string certificate, key, client_ca;

  friend bool operator==(const TlsFiles&, const TlsFiles&) = default;
};

// The server's own certificate.
struct TlsCertificate {
  std::string name;  // common name of its subject; may be empty
  absl::Time not_before, not_after;
};

absl::StatusOr<TlsFiles> ReadTlsFiles(const TlsOptions& options);

// Succeeds when gRPC will serve the files: all blocks of the PEM files are whole, OpenSSL takes the
// certificate at its security level, and the key is the certificate's. Dates are not checked: an
// expired certificate is the client's to refuse, see DateWarning().
absl::StatusOr<TlsCertificate> CheckTlsFiles(const TlsOptions& options, const TlsFiles& files);

// "expires on 2027-01-31 12:00:00 UTC" when it has expired, is not valid yet or has less than a
// week; else empty.
std::string DateWarning(const TlsCertificate& certificate, absl::Time now);

}  // namespace lightfit
