#include "server/metrics_endpoint.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>

#include "absl/strings/str_cat.h"
#include "tests/io/testing.h"

namespace lightfit {
namespace {

using testing::HasAll;

// A connection to 127.0.0.1:port.
int Connect(int port) {
  const int file = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in name = {};
  name.sin_family = AF_INET;
  name.sin_port = htons(static_cast<uint16_t>(port));
  name.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(connect(file, reinterpret_cast<const sockaddr*>(&name), sizeof(name)), 0);
  return file;
}

// All that comes back for `request`.
std::string Send(int port, const std::string& request) {
  const int file = Connect(port);
  EXPECT_EQ(write(file, request.data(), request.size()), static_cast<ssize_t>(request.size()));
  std::string response;
  char piece[4096];
  for (ssize_t size; (size = read(file, piece, sizeof(piece))) > 0;) response.append(piece, size);
  close(file);
  return response;
}

// What a browser would get from http://127.0.0.1:port/path.
std::string Get(int port, const std::string& path) {
  return Send(port, absl::StrCat("GET ", path, " HTTP/1.1\r\nHost: localhost\r\n\r\n"));
}

TEST(MetricsEndpoint, ServesTheTextOnAFreePort) {
  Metrics metrics("1.2.3", 0);
  metrics.AddPixels(42);
  const auto endpoint = MetricsEndpoint::Start("127.0.0.1:0", metrics);
  ASSERT_TRUE(endpoint.ok()) << endpoint.status();
  ASSERT_GT((*endpoint)->port(), 0);
  const std::string response = Get((*endpoint)->port(), "/metrics");
  EXPECT_TRUE(
      HasAll(response, {"HTTP/1.1 200", "text/plain", "# TYPE lightfit_pixels_total counter"}));
  EXPECT_TRUE(HasAll(response, {"\nlightfit_pixels_total 42\n"}));
  metrics.AddPixels(1);
  EXPECT_TRUE(HasAll(Get((*endpoint)->port(), "/metrics?name[]=x"), {"lightfit_pixels_total 43"}));
}

TEST(MetricsEndpoint, OtherRequestsGetAnErrorOrNothing) {
  const Metrics metrics("1", 0);
  const auto endpoint = MetricsEndpoint::Start("127.0.0.1:0", metrics);
  ASSERT_TRUE(endpoint.ok()) << endpoint.status();
  const int port = (*endpoint)->port();
  for (const std::string path : {"/", "/metricsx", "/../../etc/passwd", "http://a/metrics"}) {
    EXPECT_TRUE(HasAll(Get(port, path), {"HTTP/1.1 404", "want /metrics"})) << path;
  }
  EXPECT_TRUE(HasAll(Send(port, "DELETE /metrics HTTP/1.1\r\n\r\n"), {"HTTP/1.1 405"}));
  EXPECT_TRUE(HasAll(Send(port, std::string("\0\xff\r\n\r\n", 6)), {"HTTP/1.1 405"}));
  EXPECT_EQ(Send(port, "GET /" + std::string(9000, 'a')), "");
  EXPECT_TRUE(HasAll(Get(port, "/metrics"), {"HTTP/1.1 200"}));
}

// Connections that say nothing delay the scrape; they neither block it nor the end.
TEST(MetricsEndpoint, SilentConnectionsHoldNothingUp) {
  const Metrics metrics("1", 0);
  auto endpoint = MetricsEndpoint::Start("127.0.0.1:0", metrics);
  ASSERT_TRUE(endpoint.ok()) << endpoint.status();
  const int before = Connect((*endpoint)->port());
  EXPECT_TRUE(HasAll(Get((*endpoint)->port(), "/metrics"), {"HTTP/1.1 200"}));
  const int after = Connect((*endpoint)->port());
  endpoint->reset();
  close(before);
  close(after);
}

TEST(MetricsEndpoint, FailsWhereItCannotListen) {
  const Metrics metrics("1", 0);
  const auto first = MetricsEndpoint::Start("localhost:0", metrics);
  ASSERT_TRUE(first.ok()) << first.status();
  const std::string taken = absl::StrCat("127.0.0.1:", (*first)->port());
  const auto second = MetricsEndpoint::Start(taken, metrics);
  EXPECT_EQ(second.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_TRUE(HasAll(second.status().message(), {taken, "in use", "0 for a free one"}));

  const auto message = [&metrics](const std::string& address) {
    return std::string(MetricsEndpoint::Start(address, metrics).status().message());
  };
  EXPECT_TRUE(HasAll(message("0.0.0.0:0"), {"other machines", "127.0.0.1"}));
  EXPECT_TRUE(HasAll(message("9471"), {"metrics address \"9471\"", "no port"}));
  EXPECT_TRUE(HasAll(message("unix:/run/a"), {"want host:port"}));
  EXPECT_TRUE(MetricsEndpoint::Start("0.0.0.0:0", metrics, /*allow_other_machines=*/true).ok());
}

}  // namespace
}  // namespace lightfit
