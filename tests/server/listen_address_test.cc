#include "server/listen_address.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>

#include "tests/io/testing.h"

namespace lightfit {
namespace {

using testing::HasAll;

struct Expected {
  std::string text, target, host;
  int port;
  bool is_loopback;
};

TEST(ListenAddress, HostsAndPortsAreTakenApart) {
  const Expected cases[] = {
      {"127.0.0.1:50071", "127.0.0.1:50071", "127.0.0.1", 50071, true},
      {"127.8.9.10:1", "127.8.9.10:1", "127.8.9.10", 1, true},
      {"localhost:50071", "localhost:50071", "localhost", 50071, true},
      {"[::1]:0", "[::1]:0", "::1", 0, true},
      {"[::ffff:127.0.0.1]:7", "[::ffff:127.0.0.1]:7", "::ffff:127.0.0.1", 7, true},
      {"0.0.0.0:50071", "0.0.0.0:50071", "0.0.0.0", 50071, false},
      {"[::]:65535", "[::]:65535", "::", 65535, false},
      {"192.168.0.7:80", "192.168.0.7:80", "192.168.0.7", 80, false},
      {"[::ffff:10.0.0.1]:7", "[::ffff:10.0.0.1]:7", "::ffff:10.0.0.1", 7, false},
      {"farm-7.studio:50071", "farm-7.studio:50071", "farm-7.studio", 50071, false},
      {"localhost.evil.com:1", "localhost.evil.com:1", "localhost.evil.com", 1, false},
  };
  for (const Expected& expected : cases) {
    const auto address = ParseListenAddress(expected.text);
    ASSERT_TRUE(address.ok()) << address.status();
    EXPECT_EQ(address->target, expected.target);
    EXPECT_EQ(address->host, expected.host);
    EXPECT_EQ(address->port, expected.port);
    EXPECT_EQ(address->is_loopback, expected.is_loopback) << expected.text;
    EXPECT_FALSE(address->is_unix);
  }
}

TEST(ListenAddress, UnixSocketsAreAbsolutePaths) {
  const std::string longest = "/" + std::string(106, 'a');
  for (const std::string& path : {std::string("/run/light fit.sock"), longest}) {
    const auto address = ParseListenAddress("unix:" + path);
    ASSERT_TRUE(address.ok()) << address.status();
    EXPECT_EQ(address->path, path);
    EXPECT_EQ(address->target, "unix:" + path);
    EXPECT_TRUE(address->is_unix);
    EXPECT_TRUE(address->is_loopback);
  }
  EXPECT_EQ(ParseListenAddress("unix:///run/a")->path, "/run/a");
}

TEST(ListenAddress, MistakesAreNamed) {
  const auto message = [](const std::string& text) {
    return std::string(ParseListenAddress(text).status().message());
  };
  EXPECT_TRUE(HasAll(message(""), {"address \"\"", "no port", "127.0.0.1:50071"}));
  EXPECT_TRUE(HasAll(message("127.0.0.1"), {"no port"}));
  EXPECT_TRUE(HasAll(message("[::1]"), {"no port"}));
  EXPECT_TRUE(HasAll(message(":50071"), {"no host", "127.0.0.1", "0.0.0.0"}));
  EXPECT_TRUE(HasAll(message("*:50071"), {"no host"}));
  EXPECT_TRUE(HasAll(message("::1:50071"), {"brackets", "[::1]:port"}));
  EXPECT_TRUE(HasAll(message("[localhost]:1"), {"no IP address"}));
  EXPECT_TRUE(HasAll(message("[::1:50071"), {"brackets"}));
  EXPECT_TRUE(HasAll(message("http://localhost:1"), {"no host name"}));
  for (const std::string port : {"", "65536", "-1", "+1", " 1", "1x", "99999999999", "0x10"}) {
    EXPECT_TRUE(HasAll(message("localhost:" + port), {"port = \"" + port + "\"", "65535"}));
  }
  EXPECT_TRUE(HasAll(message("unix:lightfit.sock"), {"absolute", "unix:/run/lightfit.sock"}));
  EXPECT_TRUE(HasAll(message("unix:"), {"absolute"}));
  EXPECT_TRUE(HasAll(message("unix:/" + std::string(107, 'a')), {"108 bytes", "at most 107"}));
  EXPECT_TRUE(HasAll(message(std::string("unix:/a\0b", 9)), {"control characters"}));
}

// A unix socket at `path`; with `listens`, as a running server has it, else as a killed one leaves
// it.
class Socket {
 public:
  Socket(const std::string& path, bool listens) : file_(socket(AF_UNIX, SOCK_STREAM, 0)) {
    sockaddr_un name = {};
    name.sun_family = AF_UNIX;
    std::memcpy(name.sun_path, path.data(), path.size());
    EXPECT_EQ(bind(file_, reinterpret_cast<const sockaddr*>(&name), sizeof(name)), 0);
    if (listens) {
      EXPECT_EQ(listen(file_, 1), 0);
    }
  }
  ~Socket() { close(file_); }

 private:
  int file_;
};

TEST(ListenAddress, StaleSocketsMakeWay) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("s");
  EXPECT_TRUE(PrepareUnixSocket(path).ok());
  { const Socket killed(path, /*listens=*/true); }
  ASSERT_TRUE(std::filesystem::is_socket(path));
  EXPECT_TRUE(PrepareUnixSocket(path).ok());
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(ListenAddress, RunningServersAndFilesStay) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("s");
  const Socket server(path, /*listens=*/true);
  // Each look takes a place in the queue of connections, until it is full.
  for (int i = 0; i < 5; ++i) {
    EXPECT_TRUE(HasAll(PrepareUnixSocket(path).message(), {path, "another server listens"}));
  }
  EXPECT_TRUE(std::filesystem::is_socket(path));

  const std::string file = folder.Write("f", "text");
  EXPECT_TRUE(HasAll(PrepareUnixSocket(file).message(), {file, "no socket"}));
  EXPECT_EQ(testing::Bytes(file), "text");
  EXPECT_TRUE(HasAll(PrepareUnixSocket(folder.File("")).message(), {"no socket"}));
  std::filesystem::create_symlink(path, folder.File("link"));
  EXPECT_TRUE(HasAll(PrepareUnixSocket(folder.File("link")).message(), {"no socket"}));
  EXPECT_TRUE(HasAll(PrepareUnixSocket(folder.File("none/s")).message(),
                     {folder.File("none"), "create it"}));
}

}  // namespace
}  // namespace lightfit
