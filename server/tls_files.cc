#include "server/tls_files.h"

#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

#include <ctime>
#include <memory>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "base/text_file.h"

namespace lightfit {
namespace {

constexpr int64_t kMaxPemBytes = int64_t{4} << 20;  // a bundle of all public CAs has 0.2 MB
constexpr absl::Duration kWarnBeforeExpiry = absl::Hours(24 * 7);

struct Free {
  void operator()(BIO* bio) const { BIO_free(bio); }
  void operator()(EVP_PKEY* key) const { EVP_PKEY_free(key); }
  void operator()(SSL_CTX* context) const { SSL_CTX_free(context); }
  void operator()(X509* certificate) const { X509_free(certificate); }
};
using Bio = std::unique_ptr<BIO, Free>;
using Key = std::unique_ptr<EVP_PKEY, Free>;
using Context = std::unique_ptr<SSL_CTX, Free>;
using Certificate = std::unique_ptr<X509, Free>;

Bio BioOf(const std::string& text) {
  return Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
}

std::string LastSslError() {
  const char* reason = ERR_reason_error_string(ERR_peek_last_error());
  return reason == nullptr ? "unknown" : reason;
}

absl::Status Wrong(const std::string& path, absl::string_view why) {
  return absl::InvalidArgumentError(absl::StrCat(path, ": ", why));
}

int Count(absl::string_view text, absl::string_view part) {
  int count = 0;
  for (size_t at = text.find(part); at != absl::string_view::npos; at = text.find(part, at + 1)) {
    ++count;
  }
  return count;
}

// Instead of OpenSSL's own callback, which asks at the terminal. `asked` is a bool.
int RefusePassword(char* /*password*/, int /*size*/, int /*is_for_writing*/, void* asked) {
  *static_cast<bool*>(asked) = true;
  return -1;
}

absl::StatusOr<std::vector<Certificate>> ParseCertificates(const std::string& path,
                                                           const std::string& pem) {
  // OpenSSL takes a file that breaks off within a BEGIN line for one that ends before it.
  if (Count(pem, "-----BEGIN ") != Count(pem, "-----END ")) {
    return Wrong(path, "breaks off within a PEM block; is it still being written?");
  }
  const Bio bio = BioOf(pem);
  std::vector<Certificate> certificates;
  bool asked = false;
  ERR_clear_error();
  while (X509* const certificate = PEM_read_bio_X509(bio.get(), nullptr, RefusePassword, &asked)) {
    certificates.emplace_back(certificate);
  }
  if (ERR_GET_REASON(ERR_peek_last_error()) != PEM_R_NO_START_LINE) {
    return Wrong(path,
                 absl::StrCat("certificate ",
                              certificates.size() + 1,
                              " cannot be read (",
                              LastSslError(),
                              "); want PEM, whole"));
  }
  if (certificates.empty()) {
    return Wrong(path, "holds no certificate; want PEM, with -----BEGIN CERTIFICATE-----");
  }
  return certificates;
}

absl::StatusOr<Key> ParseKey(const std::string& path, const std::string& pem) {
  const Bio bio = BioOf(pem);
  bool asked = false;
  ERR_clear_error();
  Key key(PEM_read_bio_PrivateKey(bio.get(), nullptr, RefusePassword, &asked));
  if (key != nullptr) return key;
  if (asked) {
    return Wrong(path, "is encrypted; want a key without password, readable by the server alone");
  }
  return Wrong(
      path, absl::StrCat("holds no private key that can be read (", LastSslError(), "); want PEM"));
}

absl::Time TimeOf(const ASN1_TIME* time) {
  std::tm fields = {};
  if (ASN1_TIME_to_tm(time, &fields) != 1) return absl::InfinitePast();
  return absl::FromTM(fields, absl::UTCTimeZone());
}

std::string CommonName(const X509* certificate) {
  char name[256] = "";
  X509_NAME_get_text_by_NID(X509_get_subject_name(certificate), NID_commonName, name, sizeof(name));
  return name;
}

}  // namespace

absl::StatusOr<TlsFiles> ReadTlsFiles(const TlsOptions& options) {
  TlsFiles files;
  const std::pair<const std::string*, std::string*> wanted[] = {
      {&options.certificate_path, &files.certificate},
      {&options.key_path, &files.key},
      {&options.client_ca_path, &files.client_ca}};
  for (const auto& [path, contents] : wanted) {
    if (path == &options.client_ca_path && path->empty()) continue;
    absl::StatusOr<std::string> text = ReadTextFile(*path, kMaxPemBytes);
    if (!text.ok()) return text.status();
    *contents = *std::move(text);
  }
  return files;
}

absl::StatusOr<TlsCertificate> CheckTlsFiles(const TlsOptions& options, const TlsFiles& files) {
  const absl::StatusOr<std::vector<Certificate>> chain =
      ParseCertificates(options.certificate_path, files.certificate);
  if (!chain.ok()) return chain.status();
  const absl::StatusOr<Key> key = ParseKey(options.key_path, files.key);
  if (!key.ok()) return key.status();
  X509* const certificate = chain->front().get();
  if (X509_check_private_key(certificate, key->get()) != 1) {
    return Wrong(
        options.key_path,
        absl::StrCat("is not the key of the first certificate in ", options.certificate_path));
  }
  const Context context(SSL_CTX_new(TLS_server_method()));
  if (context == nullptr) return absl::InternalError("OpenSSL gives no context");
  if (SSL_CTX_use_certificate(context.get(), certificate) != 1) {  // a key too small, MD5, ...
    return Wrong(options.certificate_path,
                 absl::StrCat("OpenSSL refuses the certificate (", LastSslError(), ")"));
  }
  if (!options.client_ca_path.empty()) {
    const auto authorities = ParseCertificates(options.client_ca_path, files.client_ca);
    if (!authorities.ok()) return authorities.status();
  }
  return TlsCertificate{CommonName(certificate),
                        TimeOf(X509_get0_notBefore(certificate)),
                        TimeOf(X509_get0_notAfter(certificate))};
}

std::string DateWarning(const TlsCertificate& certificate, absl::Time now) {
  const auto text = [](absl::string_view verb, absl::Time time) {
    return absl::StrCat(
        verb, " ", absl::FormatTime("%Y-%m-%d %H:%M:%S UTC", time, absl::UTCTimeZone()));
  };
  if (now < certificate.not_before) return text("is not valid before", certificate.not_before);
  if (now > certificate.not_after) return text("expired on", certificate.not_after);
  if (now + kWarnBeforeExpiry > certificate.not_after) {
    return text("expires on", certificate.not_after);
  }
  return "";
}

}  // namespace lightfit
