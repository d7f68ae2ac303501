#include "server/tls.h"

#include <fcntl.h>
#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_credentials_options.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <system_error>
#include <thread>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "absl/time/clock.h"
#include "base/text_file.h"

namespace lightfit {
namespace {

constexpr unsigned int kGrpcWatchInterval_s = 1;  // its least

// A path of this process alone, whose contents change in one step: a file descriptor that is made
// to stand for another file in memory. It is never closed, for gRPC may look at the path until the
// process ends, and the number must not come to stand for something else.
class SwitchedFile {
 public:
  std::string path() const { return absl::StrCat("/proc/self/fd/", file_); }

  absl::Status Replace(absl::string_view contents) {
    const int next = memfd_create("lightfit-tls", MFD_CLOEXEC);
    if (next < 0) return Failed("memfd_create");
    absl::Status status = Fill(next, contents);
    if (status.ok() && file_ < 0) {
      file_ = next;
      return status;
    }
    if (status.ok() && dup3(next, file_, O_CLOEXEC) < 0) status = Failed("dup3");
    close(next);
    return status;
  }

 private:
  absl::Status Fill(int file, absl::string_view contents) {
    while (!contents.empty()) {
      const ssize_t written = write(file, contents.data(), contents.size());
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) return Failed("write");
      contents.remove_prefix(static_cast<size_t>(written));
    }
    if (fchmod(file, S_IRUSR | S_IWUSR) != 0) return Failed("fchmod");
    // gRPC reads key and certificate one after the other and compares times of modification, in
    // whole seconds, to see whether the file changed in between: none may come twice.
    const timespec time = {++generation_, 0};
    const timespec times[] = {time, time};
    if (futimens(file, times) != 0) return Failed("futimens");
    return absl::OkStatus();
  }

  static absl::Status Failed(absl::string_view call) {
    const int error_number = errno;
    return absl::UnavailableError(
        absl::StrCat("no memory file for TLS: ",
                     call,
                     ": ",
                     std::error_code(error_number, std::generic_category()).message()));
  }

  int file_ = -1;
  time_t generation_ = 0;
};

}  // namespace

// Reads the files again and again, and publishes what holds together.
class ReloadingCredentials::Follower {
 public:
  Follower(TlsOptions options, TlsLog log) : options_(std::move(options)), log_(std::move(log)) {}

  // Publishes the files if they changed.
  absl::Status Update() {
    absl::StatusOr<TlsFiles> files = ReadTlsFiles(options_);
    if (!files.ok()) return files.status();
    if (*files == published_) return absl::OkStatus();
    absl::StatusOr<TlsCertificate> certificate = CheckTlsFiles(options_, *files);
    if (!certificate.ok()) return certificate.status();
    // Key and chain in one file change together. Clients' CAs concern other handshakes.
    absl::Status status = identity_.Replace(absl::StrCat(files->key, "\n", files->certificate));
    if (status.ok() && !files->client_ca.empty()) status = client_ca_.Replace(files->client_ca);
    if (!status.ok()) return status;
    published_ = *std::move(files);
    certificate_ = *std::move(certificate);
    log_.info(absl::StrCat("serves ", Description()));
    return status;
  }

  void WarnOfDates() {
    std::string warning = DateWarning(certificate_, absl::Now());
    if (warning != date_warning_ && !warning.empty()) {
      log_.warning(absl::StrCat(Description(), " ", warning));
    }
    date_warning_ = std::move(warning);
  }

  void Run() {
    thread_ = std::jthread([this](const std::stop_token& stop) {
      std::string refusal;
      std::mutex mutex;
      std::condition_variable_any stopped;
      std::unique_lock lock(mutex);
      const auto is_stopping = [&stop] { return stop.stop_requested(); };
      while (!stopped.wait_for(
          lock, stop, absl::ToChronoNanoseconds(options_.reload_interval), is_stopping)) {
        const absl::Status status = Update();
        if (!status.ok() && status.message() != refusal) {
          log_.warning(absl::StrCat("goes on with the previous files: ", status.message()));
        }
        refusal = std::string(status.message());
        WarnOfDates();
      }
    });
  }

  std::string Description() const {
    return absl::StrCat("certificate \"", certificate_.name, "\" of ", options_.certificate_path);
  }

  const SwitchedFile& identity() const { return identity_; }
  const SwitchedFile& client_ca() const { return client_ca_; }

 private:
  const TlsOptions options_;
  const TlsLog log_;
  SwitchedFile identity_, client_ca_;
  TlsFiles published_;
  TlsCertificate certificate_;
  std::string date_warning_;
  std::jthread thread_;  // last: it uses the others
};

ReloadingCredentials::ReloadingCredentials() = default;
ReloadingCredentials::~ReloadingCredentials() = default;

absl::StatusOr<std::unique_ptr<ReloadingCredentials>> ReloadingCredentials::Start(
    TlsOptions options, TlsLog log) {
  if (options.reload_interval <= absl::ZeroDuration() ||
      options.reload_interval > absl::Hours(24)) {
    return absl::InvalidArgumentError(absl::StrCat("TLS reload interval = ",
                                                   absl::FormatDuration(options.reload_interval),
                                                   ", want more than 0 and at most 24h"));
  }
  const bool has_client_ca = !options.client_ca_path.empty();
  std::unique_ptr<ReloadingCredentials> result(new ReloadingCredentials);
  result->follower_ = std::make_unique<Follower>(std::move(options), std::move(log));
  Follower& follower = *result->follower_;
  if (absl::Status status = follower.Update(); !status.ok()) return status;
  follower.WarnOfDates();

  const std::string identity = follower.identity().path();
  if (const auto text = ReadTextFile(identity); !text.ok()) {
    return absl::FailedPreconditionError(
        absl::StrCat("TLS needs /proc, mount it: ", text.status().message()));
  }
  namespace tls = grpc::experimental;
  tls::TlsServerCredentialsOptions server(std::make_shared<tls::FileWatcherCertificateProvider>(
      identity, identity, has_client_ca ? follower.client_ca().path() : "", kGrpcWatchInterval_s));
  server.watch_identity_key_cert_pairs();
  if (has_client_ca) {
    server.watch_root_certs();
    server.set_cert_request_type(GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY);
  }
  result->credentials_ = tls::TlsServerCredentials(server);
  follower.Run();
  return result;
}

}  // namespace lightfit
