#include "server/metrics_endpoint.h"

#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <string>
#include <system_error>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "server/listen_address.h"

namespace lightfit {
namespace {

constexpr absl::Duration kPatience = absl::Seconds(3);  // for a request and its answer
constexpr size_t kMaxRequestBytes = 8192;

// Whether `file` is ready for `events` before the deadline, and before `stop_event` is set.
bool IsReady(int file, short events, int stop_event, absl::Time deadline) {
  for (;;) {
    const absl::Duration left =
        std::clamp(deadline - absl::Now(), absl::ZeroDuration(), absl::Hours(1));
    pollfd files[] = {{file, events, 0}, {stop_event, POLLIN, 0}};
    const int num_ready = poll(files, 2, static_cast<int>(absl::ToInt64Milliseconds(left)));
    if (num_ready < 0 && errno == EINTR) continue;
    return num_ready > 0 && files[1].revents == 0;
  }
}

std::string Response(absl::string_view status, absl::string_view type, absl::string_view body) {
  return absl::StrCat("HTTP/1.1 ",
                      status,
                      "\r\nContent-Type: ",
                      type,
                      "\r\nContent-Length: ",
                      body.size(),
                      "\r\nConnection: close\r\n\r\n",
                      body);
}

std::string ErrnoText(int error_number) {
  return std::error_code(error_number, std::generic_category()).message();
}

// A socket that listens there, or -1 and errno.
int Listen(const addrinfo& address) {
  const int listener =
      socket(address.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, IPPROTO_TCP);
  if (listener < 0) return -1;
  const int yes = 1;  // the port of a server that just ended is free
  if (setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes)) == 0 &&
      bind(listener, address.ai_addr, address.ai_addrlen) == 0 &&
      listen(listener, SOMAXCONN) == 0) {
    return listener;
  }
  const int error_number = errno;
  close(listener);
  errno = error_number;
  return -1;
}

int PortOf(int listener) {
  sockaddr_in6 name = {};  // sin_port of IPv4 is at the same place
  socklen_t size = sizeof(name);
  if (getsockname(listener, reinterpret_cast<sockaddr*>(&name), &size) != 0) return 0;
  return ntohs(name.sin6_port);
}

}  // namespace

absl::StatusOr<std::unique_ptr<MetricsEndpoint>> MetricsEndpoint::Start(absl::string_view address,
                                                                        const Metrics& metrics,
                                                                        bool allow_other_machines) {
  const auto failed = [address](absl::StatusCode code, absl::string_view why) {
    return absl::Status(code, absl::StrCat("metrics address \"", address, "\": ", why));
  };
  const absl::StatusOr<ListenAddress> parsed = ParseListenAddress(address);
  if (!parsed.ok()) {
    return absl::Status(parsed.status().code(),
                        absl::StrCat("metrics ", parsed.status().message()));
  }
  if (parsed->is_unix) {
    return failed(absl::StatusCode::kInvalidArgument, "want host:port, as in 127.0.0.1:9471");
  }
  if (!parsed->is_loopback && !allow_other_machines) {
    return failed(absl::StatusCode::kInvalidArgument,
                  "other machines could read the metrics there; want 127.0.0.1, or allow it");
  }
  addrinfo hints = {};
  hints.ai_flags = AI_PASSIVE;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const std::string port = absl::StrCat(parsed->port);
  if (const int error = getaddrinfo(parsed->host.c_str(), port.c_str(), &hints, &found);
      error != 0) {
    return failed(absl::StatusCode::kInvalidArgument,
                  absl::StrCat("cannot be resolved (", gai_strerror(error), ")"));
  }
  std::unique_ptr<MetricsEndpoint> endpoint(new MetricsEndpoint(metrics));
  endpoint->listener_ = Listen(*found);
  const int error_number = errno;
  freeaddrinfo(found);
  if (endpoint->listener_ < 0) {
    return failed(absl::StatusCode::kFailedPrecondition,
                  absl::StrCat("cannot listen there (",
                               ErrnoText(error_number),
                               "); choose another port, or 0 for a free one"));
  }
  endpoint->port_ = PortOf(endpoint->listener_);
  endpoint->stop_event_ = eventfd(0, EFD_CLOEXEC);
  if (endpoint->stop_event_ < 0) {
    return failed(absl::StatusCode::kUnavailable, absl::StrCat("eventfd: ", ErrnoText(errno)));
  }
  endpoint->thread_ = std::thread(&MetricsEndpoint::Run, endpoint.get());
  return endpoint;
}

MetricsEndpoint::~MetricsEndpoint() {
  if (thread_.joinable()) {
    eventfd_write(stop_event_, 1);
    thread_.join();
  }
  if (listener_ >= 0) close(listener_);
  if (stop_event_ >= 0) close(stop_event_);
}

void MetricsEndpoint::Run() {
  for (;;) {
    if (!IsReady(listener_, POLLIN, stop_event_, absl::InfiniteFuture())) {
      // An hour without a scrape, or the end.
      if (IsReady(stop_event_, POLLIN, -1, absl::InfinitePast())) return;
      continue;
    }
    const int connection = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (connection >= 0) {
      Answer(connection);
      close(connection);
    } else if (errno != EAGAIN && errno != ECONNABORTED) {
      // Out of descriptors: not in a busy loop.
      IsReady(-1, 0, stop_event_, absl::Now() + absl::Seconds(1));
    }
  }
}

void MetricsEndpoint::Answer(int connection) {
  const absl::Time deadline = absl::Now() + kPatience;
  std::string request;
  while (!absl::StrContains(request, "\r\n\r\n")) {
    char piece[1024];
    if (request.size() > kMaxRequestBytes) return;
    if (!IsReady(connection, POLLIN, stop_event_, deadline)) return;
    const ssize_t size = recv(connection, piece, sizeof(piece), 0);
    if (size <= 0) return;
    request.append(piece, static_cast<size_t>(size));
  }
  constexpr char kPlainText[] = "text/plain; charset=utf-8";
  std::string response;
  if (!absl::StartsWith(request, "GET ")) {
    response = Response("405 Method Not Allowed", kPlainText, "want GET /metrics\n");
  } else if (absl::StartsWith(request, "GET /metrics ") ||
             absl::StartsWith(request, "GET /metrics?")) {
    response = Response("200 OK", "text/plain; version=0.0.4; charset=utf-8", metrics_.Text());
  } else {
    response = Response("404 Not Found", kPlainText, "want /metrics\n");
  }
  absl::string_view rest = response;
  while (!rest.empty() && IsReady(connection, POLLOUT, stop_event_, deadline)) {
    const ssize_t size = send(connection, rest.data(), rest.size(), MSG_NOSIGNAL);
    if (size <= 0) return;
    rest.remove_prefix(static_cast<size_t>(size));
  }
}

}  // namespace lightfit
