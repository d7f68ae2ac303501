#include "cli/serve.h"

#include <malloc.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <type_traits>

#include "absl/strings/str_cat.h"
#include "cli/exit_code.h"
#include "cli/flags/choice_option.h"
#include "cli/flags/number_checks.h"
#include "server/server.h"

namespace lightfit::cli {
namespace {

constexpr char kExamples[] =
    "Examples:\n"
    "  lightfit serve\n"
    "  lightfit serve --listen unix:/run/lightfit/socket --log /var/log/lightfit.log\n"
    "  lightfit serve --listen 0.0.0.0:50071 --tls-certificate server.pem --tls-key server.key \\\n"
    "      --tls-client-ca studio-ca.pem --metrics 127.0.0.1:9471\n"
    "\n"
    "SIGTERM drains: health says NOT_SERVING, calls that were taken are finished, then the server\n"
    "ends; a second SIGTERM ends it at once. SIGHUP opens the log file anew. TLS files are "
    "followed\n"
    "while the server runs, and may be replaced in any order.\n"
    "Clients: the Python package lightfit, or any gRPC client of proto/lightfit/v1/service.proto.";

constexpr int64_t kMib = int64_t{1} << 20;

// An option in units of its own, with its default in the help.
template <typename Number, typename Store>
void AddScaled(CLI::App* app,
               const std::string& group,
               const std::string& flag,
               Number number,
               const std::string& unit,
               const std::string& meaning,
               const Store& store) {
  CLI::Option* option =
      app->add_option_function<Number>(flag, store, absl::StrCat(meaning, " [", number, "]"))
          ->type_name(unit)
          ->group(group);
  if constexpr (std::is_floating_point_v<Number>) {
    option->check(NumberIn(0.0, std::numeric_limits<Number>::infinity()));
  }
}

void DeclareAddress(CLI::App* app, ServeFlags* flags) {
  const std::string group = "Address";
  ServerOptions& server = flags->server;
  app->add_option("--listen",
                  server.listen,
                  absl::StrCat("Where to listen; port 0 takes a free one [", server.listen, "]"))
      ->type_name("HOST:PORT|unix:/PATH")
      ->group(group);
  app->add_flag("--insecure",
                server.allow_insecure,
                "Let plain text, and the metrics, be reached from other machines")
      ->group(group);
}

void DeclareTls(CLI::App* app, ServeFlags* flags) {
  const std::string group = "TLS";
  const auto tls = [flags]() -> TlsOptions& {
    if (!flags->server.tls.has_value()) flags->server.tls.emplace();
    return *flags->server.tls;
  };
  const auto add_file = [&](const char* flag, const char* meaning, std::string TlsOptions::*path) {
    return app
        ->add_option_function<std::string>(
            flag, [tls, path](const std::string& value) { tls().*path = value; }, meaning)
        ->type_name("FILE.pem")
        ->group(group);
  };
  CLI::Option* certificate = add_file("--tls-certificate",
                                      "The server's certificate, then its chain",
                                      &TlsOptions::certificate_path);
  CLI::Option* key = add_file("--tls-key", "Its key", &TlsOptions::key_path);
  certificate->needs(key);
  key->needs(certificate);
  add_file("--tls-client-ca",
           "Let in only clients with a certificate of these authorities (mutual TLS)",
           &TlsOptions::client_ca_path)
      ->needs(certificate);
  AddScaled<double>(app,
                    group,
                    "--tls-reload-s",
                    5,
                    "SECONDS",
                    "How often to look whether the files have changed",
                    [tls](double s) { tls().reload_interval = absl::Seconds(s); });
}

void DeclareLimits(CLI::App* app, ServeFlags* flags) {
  const std::string group = "Limits";
  ServerLimits* limits = &flags->server.limits;
  const auto add = [&](const char* flag, const char* meaning, int* value) {
    app->add_option(flag, *value, absl::StrCat(meaning, " [", *value, "]"))
        ->type_name("N")
        ->group(group);
  };
  add("--threads", "Threads that compute; the default is one for each core", &limits->num_threads);
  add("--queue", "Calls that may wait for a thread", &limits->max_queue);
  add("--max-streams", "Open FitStream and Track calls", &limits->max_streams);
  AddScaled<int64_t>(app,
                     group,
                     "--max-message-mib",
                     limits->max_message_bytes / kMib,
                     "MIB",
                     "Largest message; larger read-backs are streamed",
                     [limits](int64_t mib) { limits->max_message_bytes = mib * kMib; });
  AddScaled<int64_t>(app,
                     group,
                     "--memory-mib",
                     limits->memory_bytes / kMib,
                     "MIB",
                     "For requests and read-backs of all calls together",
                     [limits](int64_t mib) { limits->memory_bytes = mib * kMib; });
  app->add_option("--max-pixels",
                  limits->calls.max_pixels,
                  absl::StrCat("Largest read-back [", limits->calls.max_pixels, "]"))
      ->type_name("N")
      ->group(group);
  add("--max-maps", "Most maps that a plan may have", &limits->calls.max_maps);
  AddScaled<double>(app,
                    group,
                    "--upload-timeout-s",
                    absl::ToDoubleSeconds(limits->upload_timeout),
                    "SECONDS",
                    "From a streamed read-back's first message to its last",
                    [limits](double s) { limits->upload_timeout = absl::Seconds(s); });
  AddScaled<double>(app,
                    group,
                    "--idle-timeout-s",
                    absl::ToDoubleSeconds(limits->idle_timeout),
                    "SECONDS",
                    "How long a Track stream may be without a frame",
                    [limits](double s) { limits->idle_timeout = absl::Seconds(s); });
}

void DeclareOperation(CLI::App* app, ServeFlags* flags) {
  const std::string group = "Operation";
  ServerOptions& server = flags->server;
  app->add_option(
         "--metrics", server.metrics_listen, "Serve GET /metrics for Prometheus there [no metrics]")
      ->type_name("HOST:PORT")
      ->group(group);
  app->add_option("--log", server.log_path, "Log, one JSON object a line [-, stderr]")
      ->type_name("FILE")
      ->group(group);
  AddChoice(
      app, "--log-level", LogLevelWords(), &server.log_level, "Least level that is logged [info]")
      ->group(group);
  AddScaled<double>(app,
                    group,
                    "--drain-limit-s",
                    absl::ToDoubleSeconds(flags->drain_limit),
                    "SECONDS",
                    "How long SIGTERM lets calls finish",
                    [flags](double s) { flags->drain_limit = absl::Seconds(s); });
  AddScaled<double>(app,
                    group,
                    "--drain-delay-s",
                    0,
                    "SECONDS",
                    "How long SIGTERM goes on taking calls, for load balancers to notice first",
                    [flags](double s) { flags->drain_delay = absl::Seconds(s); });
  app->add_flag("!--no-reflection", server.reflection, "Do not tell clients the schema")
      ->group(group);
  app->add_flag("--channelz", server.channelz, "Serve channelz, which shows every connection")
      ->group(group);
}

// Each connection is a file; the usual limit is 1024.
void RaiseFileLimit() {
  rlimit limit;
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

// Has read-backs returned to the system when they go. By itself glibc learns from their size to
// keep them, in a heap for each of gRPC's threads, and --memory-mib would not be all they take.
void ReturnLargeMemory() {
  constexpr int kLargeBytes = 4 << 20;
  mallopt(M_MMAP_THRESHOLD, kLargeBytes);  // NOLINT(concurrency-mt-unsafe): no thread yet
}

}  // namespace

std::function<int()> DeclareServe(CLI::App* app) {
  const auto flags = std::make_shared<ServeFlags>();
  const int num_cores = static_cast<int>(std::thread::hardware_concurrency());
  flags->server.limits.num_threads = std::max(num_cores, 1);
  DeclareAddress(app, flags.get());
  DeclareTls(app, flags.get());
  DeclareLimits(app, flags.get());
  DeclareOperation(app, flags.get());
  app->footer(kExamples);
  return [flags] { return RunServe(*flags); };
}

int RunServe(const ServeFlags& flags) {
  RaiseFileLimit();
  ReturnLargeMemory();
  // Before any thread is made, so that none of them takes these signals.
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&signals, signal);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::signal(SIGPIPE, SIG_IGN);

  const absl::StatusOr<std::unique_ptr<Server>> server = Server::Start(flags.server);
  if (!server.ok()) return Fail(kExitBadInput, server.status());
  std::printf("listening on %s\n", (*server)->address().c_str());
  if ((*server)->metrics_port() != 0) {
    std::printf("metrics on port %d\n", (*server)->metrics_port());
  }
  std::fflush(stdout);

  int signal = 0;
  while (sigwait(&signals, &signal) == 0 && signal == SIGHUP) {
    if (absl::Status status = (*server)->ReopenLog(); !status.ok()) PrintWarning(status.message());
  }
  // Signals have their usual effect again: the next one ends the process.
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
  const bool is_complete = (*server)->Drain(flags.drain_delay, flags.drain_limit);
  return is_complete ? kExitOk : kExitIncomplete;
}

}  // namespace lightfit::cli
