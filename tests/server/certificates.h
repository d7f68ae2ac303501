// tests/server/certificates.h
//
// Certificates for the tests of the server, made on the spot: nothing secret, nothing that expires.
#pragma once

#include <memory>
#include <string>

#include "absl/time/clock.h"
#include "absl/time/time.h"

namespace lightfit::testing {

// PEM.
struct CertifiedKey {
  std::string certificate;
  std::string key;
};

// What a certificate says, beside the name.
struct CertificateTerms {
  absl::Time not_before = absl::Now() - absl::Hours(1);
  absl::Time not_after = absl::Now() + absl::Hours(24 * 30);
};

// An authority with a P-256 key and a certificate of its own.
class CertificateAuthority {
 public:
  explicit CertificateAuthority(const std::string& name);
  ~CertificateAuthority();

  const std::string& certificate() const { return certificate_; }  // PEM

  // A certificate for a server on this machine (localhost, 127.0.0.1, ::1) or for its client.
  CertifiedKey Issue(const std::string& name, const CertificateTerms& terms = {}) const;

 private:
  struct Keys;

  std::unique_ptr<Keys> keys_;
  std::string certificate_;
};

// `key`, PEM, protected by a password.
std::string Encrypted(const std::string& key, const std::string& password);

}  // namespace lightfit::testing
