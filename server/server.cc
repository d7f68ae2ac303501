#include "server/server.h"

#include <grpcpp/ext/channelz_service_plugin.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/resource_quota.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/clock.h"
#include "base/version.h"
#include "server/call.h"
#include "server/library_log.h"
#include "server/listen_address.h"
#include "server/metrics.h"
#include "server/metrics_endpoint.h"
#include "server/service.h"
#include "server/tls.h"

namespace lightfit {
namespace {

constexpr char kServiceName[] = "lightfit.v1.LightFit";

// How long a drained server goes on refusing calls before it hangs up.
constexpr absl::Duration kRefusalTime = absl::Milliseconds(200);

absl::Status CheckPlainText(const ServerOptions& options, const ListenAddress& address) {
  if (options.tls.has_value() || options.allow_insecure || address.is_loopback) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(
      absl::StrFormat("--listen %s: other machines reach it, and without TLS anybody can read and "
                      "change what is sent; give --tls-certificate and --tls-key, or --insecure "
                      "where the network itself is safe",
                      options.listen));
}

// Messages are not to be unpacked: a few kilobytes could become gigabytes before anybody sees
// their size.
void RefuseCompression(grpc::ServerBuilder* builder) {
  for (const grpc_compression_algorithm algorithm : {GRPC_COMPRESS_DEFLATE, GRPC_COMPRESS_GZIP}) {
    builder->SetCompressionAlgorithmSupportStatus(algorithm, false);
  }
  builder->AddChannelArgument(GRPC_ARG_ENABLE_PER_MESSAGE_DECOMPRESSION, 0);
}

// Connections stay while nobody calls, for as long as their peers answer: one that is gone without
// a word is found out after a minute. A client may ask likewise, and as often as it likes, as an
// answer costs next to nothing; by default gRPC hangs up on the third ping within hours.
void KeepConnections(grpc::ServerBuilder* builder) {
  builder->AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, 60000);
  builder->AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 20000);
  builder->AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder->AddChannelArgument(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);  // of ours: any number
  builder->AddChannelArgument(GRPC_ARG_HTTP2_MIN_SENT_PING_INTERVAL_WITHOUT_DATA_MS, 10000);
  builder->AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 1000);
  builder->AddChannelArgument(GRPC_ARG_HTTP2_MAX_PING_STRIKES, 0);  // of theirs: any number
}

void SetLimits(const ServerLimits& limits, grpc::ServerBuilder* builder) {
  builder->SetMaxReceiveMessageSize(static_cast<int>(limits.max_message_bytes));
  builder->SetMaxSendMessageSize(-1);  // results are small
  grpc::ResourceQuota quota("lightfit");
  quota.Resize(static_cast<size_t>(limits.memory_bytes / 2));
  builder->SetResourceQuota(quota);
  KeepConnections(builder);
  // Two servers on one port would each get some of the calls.
  builder->AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
}

absl::StatusOr<std::unique_ptr<ReloadingCredentials>> StartTls(const TlsOptions& options,
                                                               CallLog* log) {
  return ReloadingCredentials::Start(
      options,
      {[log](const std::string& message) { log->Event(LogLevel::kInfo, "tls", message); },
       [log](const std::string& message) { log->Event(LogLevel::kWarning, "tls", message); }});
}

absl::Status CheckAtLeast(const char* option, int64_t value, int64_t least) {
  if (value >= least) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("%s %d: want at least %d", option, value, least));
}

}  // namespace

absl::Status ValidateServerLimits(const ServerLimits& limits) {
  constexpr int64_t kMostMessageBytes = int64_t{1} << 30;  // gRPC counts them in an int
  absl::Status status = CheckAtLeast("--threads", limits.num_threads, 1);
  if (status.ok()) status = CheckAtLeast("--queue", limits.max_queue, 0);
  if (status.ok()) status = CheckAtLeast("--max-streams", limits.max_streams, 1);
  if (status.ok()) status = CheckAtLeast("--max-message-mib", limits.max_message_bytes, 1 << 20);
  if (status.ok()) status = CheckAtLeast("--memory-mib", limits.memory_bytes, 1 << 20);
  if (status.ok()) status = CheckAtLeast("--max-pixels", limits.calls.max_pixels, 1);
  if (status.ok()) status = CheckAtLeast("--max-maps", limits.calls.max_maps, 1);
  if (status.ok() && limits.max_message_bytes > kMostMessageBytes) {
    status = absl::InvalidArgumentError(
        absl::StrFormat("--max-message-mib %d: want at most 1024; larger read-backs are streamed",
                        limits.max_message_bytes >> 20));
  }
  if (status.ok() && limits.upload_timeout <= absl::ZeroDuration()) {
    status = absl::InvalidArgumentError("--upload-timeout-s: want more than 0");
  }
  if (status.ok() && limits.idle_timeout <= absl::ZeroDuration()) {
    status = absl::InvalidArgumentError("--idle-timeout-s: want more than 0");
  }
  return status;
}

// In the order in which they are made; they go in the opposite one.
struct Server::Parts {
  Parts(const ServerOptions& options, CallLog opened_log)
      : log(std::move(opened_log)),
        library_log(&log),
        metrics(kVersion, options.limits.memory_bytes),
        calls(options.limits, &metrics, &log),
        service(&calls) {}

  CallLog log;
  LibraryLogRoute library_log;
  Metrics metrics;
  std::unique_ptr<MetricsEndpoint> metrics_endpoint;
  std::unique_ptr<ReloadingCredentials> tls;
  ServerParts calls;
  LightFitService service;
  std::unique_ptr<grpc::Server> server;
};

Server::Server(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

absl::StatusOr<std::unique_ptr<Server>> Server::Start(
    const ServerOptions& options, const std::vector<grpc::Service*>& more_services) {
  if (absl::Status status = ValidateServerLimits(options.limits); !status.ok()) return status;
  const absl::StatusOr<ListenAddress> address = ParseListenAddress(options.listen);
  if (!address.ok()) return address.status();
  if (absl::Status status = CheckPlainText(options, *address); !status.ok()) return status;
  if (address->is_unix) {
    if (absl::Status status = PrepareUnixSocket(address->path); !status.ok()) return status;
  }
  const absl::StatusOr<LogLevel> level = ParseLogLevel(options.log_level);
  if (!level.ok()) return level.status();
  absl::StatusOr<CallLog> log = CallLog::Open(options.log_path, *level);
  if (!log.ok()) return log.status();

  auto parts = std::make_unique<Parts>(options, *std::move(log));
  if (!options.metrics_listen.empty()) {
    auto endpoint =
        MetricsEndpoint::Start(options.metrics_listen, parts->metrics, options.allow_insecure);
    if (!endpoint.ok()) return endpoint.status();
    parts->metrics_endpoint = *std::move(endpoint);
  }
  std::shared_ptr<grpc::ServerCredentials> credentials = grpc::InsecureServerCredentials();
  if (options.tls.has_value()) {
    auto tls = StartTls(*options.tls, &parts->log);
    if (!tls.ok()) return tls.status();
    parts->tls = *std::move(tls);
    credentials = parts->tls->credentials();
  }

  grpc::EnableDefaultHealthCheckService(true);
  if (options.reflection) grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  if (options.channelz) grpc::channelz::experimental::InitChannelzService();
  grpc::ServerBuilder builder;
  if (options.channelz) builder.AddChannelArgument(GRPC_ARG_ENABLE_CHANNELZ, 1);
  RefuseCompression(&builder);
  SetLimits(options.limits, &builder);
  int port = 0;
  builder.AddListeningPort(address->target, credentials, &port);
  builder.RegisterService(&parts->service);
  for (grpc::Service* service : more_services) builder.RegisterService(service);
  parts->server = builder.BuildAndStart();
  if (parts->server == nullptr || (port == 0 && !address->is_unix)) {
    return absl::FailedPreconditionError(
        absl::StrFormat("--listen %s: cannot listen there; another program may, or the address is "
                        "not this machine's. Choose another port, or 0 for any free one",
                        options.listen));
  }
  parts->server->GetHealthCheckService()->SetServingStatus(kServiceName, true);

  auto server = std::unique_ptr<Server>(new Server(std::move(parts)));
  const bool is_v6 = address->host.find(':') != std::string::npos;
  server->address_ =
      address->is_unix
          ? options.listen
          : absl::StrCat(is_v6 ? absl::StrCat("[", address->host, "]") : address->host, ":", port);
  server->parts_->log.Event(LogLevel::kInfo,
                            "start",
                            absl::StrCat("listening on ", server->address_),
                            {{"version", kVersion},
                             {"tls", options.tls.has_value() ? "on" : "off"},
                             {"threads", absl::StrCat(options.limits.num_threads)}});
  return server;
}

Server::~Server() {
  if (parts_ != nullptr && parts_->server != nullptr) {
    Drain(absl::ZeroDuration(), absl::ZeroDuration());
  }
}

int Server::metrics_port() const {
  return parts_->metrics_endpoint == nullptr ? 0 : parts_->metrics_endpoint->port();
}

int Server::num_calls() const {
  return parts_->calls.calls.num_inside() + parts_->calls.streams.num_inside();
}

bool Server::Drain(absl::Duration delay, absl::Duration limit) {
  parts_->server->GetHealthCheckService()->SetServingStatus(kServiceName, false);
  parts_->server->GetHealthCheckService()->SetServingStatus("", false);
  parts_->log.Event(LogLevel::kInfo, "drain", "finishing the calls that are under way");
  absl::SleepFor(delay);
  const absl::Time deadline = absl::Now() + limit;
  parts_->calls.calls.Close();
  parts_->calls.streams.Close();
  const bool calls_are_done = parts_->calls.calls.WaitUntilEmpty(deadline - absl::Now());
  const bool streams_are_done = parts_->calls.streams.WaitUntilEmpty(deadline - absl::Now());
  const int num_cancelled = num_calls();
  // Calls that come between gRPC's first step of a shutdown and its last are told CANCELLED, after
  // which clients do not try elsewhere. Those that hear UNAVAILABLE before do.
  absl::SleepFor(std::min(limit, kRefusalTime));
  // What is left now is cancelled; of health's watchers and reflection's streams nobody waits for
  // an answer.
  parts_->server->Shutdown(std::chrono::system_clock::now());
  parts_->server.reset();
  parts_->log.Event(num_cancelled == 0 ? LogLevel::kInfo : LogLevel::kWarning,
                    "stop",
                    num_cancelled == 0 ? std::string("all calls were answered")
                                       : absl::StrFormat("calls cancelled after %s: %d",
                                                         absl::FormatDuration(limit),
                                                         num_cancelled));
  return calls_are_done && streams_are_done;
}

absl::Status Server::ReopenLog() { return parts_->log.Reopen(); }

}  // namespace lightfit
