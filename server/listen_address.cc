#include "server/listen_address.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"

namespace lightfit {
namespace {

// sun_path holds the end of the string too.
constexpr size_t kMaxUnixPathBytes = sizeof(sockaddr_un::sun_path) - 1;

absl::Status Wrong(absl::string_view text, absl::string_view why) {
  return absl::InvalidArgumentError(absl::StrCat("address \"", text, "\": ", why));
}

absl::StatusOr<ListenAddress> ParseUnixAddress(absl::string_view text, absl::string_view path) {
  // unix:///run/x is how URIs write unix:/run/x.
  if (absl::StartsWith(path, "///")) path.remove_prefix(2);
  if (path.empty() || path[0] != '/') {
    return Wrong(text, "the path of a unix socket is absolute, as in unix:/run/lightfit.sock");
  }
  if (path.size() > kMaxUnixPathBytes) {
    return Wrong(text,
                 absl::StrCat("the path has ",
                              path.size(),
                              " bytes, a unix socket takes at most ",
                              kMaxUnixPathBytes,
                              "; choose a shorter one"));
  }
  if (std::any_of(
          path.begin(), path.end(), [](unsigned char c) { return absl::ascii_iscntrl(c); })) {
    return Wrong(text, "the path has control characters");
  }
  ListenAddress address;
  address.is_unix = true;
  address.is_loopback = true;
  address.path = std::string(path);
  address.target = absl::StrCat("unix:", path);
  return address;
}

bool IsHostName(absl::string_view host) {
  return std::all_of(host.begin(), host.end(), [](unsigned char c) {
    return absl::ascii_isalnum(c) || c == '.' || c == '-' || c == '_';
  });
}

// 127/8, ::1, ::ffff:127/104 and the name localhost.
bool IsLoopback(const std::string& host) {
  in_addr v4;
  if (inet_pton(AF_INET, host.c_str(), &v4) == 1) return ntohl(v4.s_addr) >> 24 == 127;
  in6_addr v6;
  if (inet_pton(AF_INET6, host.c_str(), &v6) == 1) {
    return IN6_IS_ADDR_LOOPBACK(&v6) || (IN6_IS_ADDR_V4MAPPED(&v6) && v6.s6_addr[12] == 127);
  }
  return absl::AsciiStrToLower(host) == "localhost";
}

// A path that connects somewhere has a server. ENOENT where nothing is.
int ConnectError(const std::string& path) {
  const int socket_file = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (socket_file < 0) return errno;
  sockaddr_un name = {};
  name.sun_family = AF_UNIX;
  std::memcpy(name.sun_path, path.data(), std::min(path.size(), kMaxUnixPathBytes));
  const int result = connect(socket_file, reinterpret_cast<const sockaddr*>(&name), sizeof(name));
  const int error_number = result == 0 ? 0 : errno;
  close(socket_file);
  return error_number;
}

absl::Status InTheWay(const std::string& path, absl::string_view why) {
  return absl::FailedPreconditionError(absl::StrCat("unix socket ", path, ": ", why));
}

std::string ErrnoText(int error_number) {
  return std::error_code(error_number, std::generic_category()).message();
}

}  // namespace

absl::StatusOr<ListenAddress> ParseListenAddress(absl::string_view text) {
  absl::string_view rest = text;
  if (absl::ConsumePrefix(&rest, "unix:")) return ParseUnixAddress(text, rest);

  const size_t colon = text.rfind(':');
  const size_t bracket = text.rfind(']');
  if (colon == absl::string_view::npos || (bracket != absl::string_view::npos && colon < bracket)) {
    return Wrong(text, "has no port; want host:port, as in 127.0.0.1:50071, or unix:/path");
  }
  absl::string_view host = text.substr(0, colon);
  const absl::string_view port_text = text.substr(colon + 1);
  const bool has_brackets = absl::ConsumePrefix(&host, "[") && absl::ConsumeSuffix(&host, "]");
  if (host.empty() || host == "*") {
    return Wrong(text, "has no host; 127.0.0.1 is this machine alone, 0.0.0.0 all its networks");
  }

  ListenAddress address;
  address.host = std::string(host);
  in6_addr v6;
  const bool is_v6 = inet_pton(AF_INET6, address.host.c_str(), &v6) == 1;
  if (is_v6 && !has_brackets) {
    return Wrong(text, absl::StrCat("want brackets around an IPv6 address: [", host, "]:port"));
  }
  if (has_brackets ? !is_v6 : !IsHostName(host)) {
    return Wrong(text, absl::StrCat("\"", host, "\" is no host name and no IP address"));
  }
  uint32_t port = 0;
  // SimpleAtoi alone would take "+1" and " 1".
  const bool is_number = std::all_of(
      port_text.begin(), port_text.end(), [](unsigned char c) { return absl::ascii_isdigit(c); });
  if (!is_number || !absl::SimpleAtoi(port_text, &port) || port > 65535) {
    return Wrong(text,
                 absl::StrCat("port = \"", port_text, "\", want 1 ... 65535, or 0 for a free one"));
  }
  address.port = static_cast<int>(port);
  address.is_loopback = IsLoopback(address.host);
  address.target = is_v6 ? absl::StrCat("[", host, "]:", port) : absl::StrCat(host, ":", port);
  return address;
}

absl::Status PrepareUnixSocket(const std::string& path) {
  struct stat file = {};
  if (lstat(path.c_str(), &file) != 0) {
    const int error_number = errno;
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    std::error_code error;
    if (error_number == ENOENT && std::filesystem::is_directory(folder, error)) {
      return absl::OkStatus();
    }
    return InTheWay(path,
                    absl::StrCat("the folder ",
                                 folder.string(),
                                 " cannot be used (",
                                 ErrnoText(error_number),
                                 "); create it or choose another"));
  }
  if (!S_ISSOCK(file.st_mode)) {
    return InTheWay(path, "there is a file that is no socket; move it away or choose another path");
  }
  const int connect_error = ConnectError(path);
  if (connect_error == 0 || connect_error == EAGAIN) {  // EAGAIN: its queue is full
    return InTheWay(path, "another server listens there; stop it or choose another path");
  }
  if (connect_error == ENOENT) return absl::OkStatus();  // gone meanwhile
  if (connect_error != ECONNREFUSED) {
    return InTheWay(path,
                    absl::StrCat("cannot tell whether a server listens there (",
                                 ErrnoText(connect_error),
                                 "); choose another path"));
  }
  if (unlink(path.c_str()) != 0 && errno != ENOENT) {
    return InTheWay(path,
                    absl::StrCat("is left from a server that is gone and cannot be removed (",
                                 ErrnoText(errno),
                                 "); remove it or choose another path"));
  }
  return absl::OkStatus();
}

}  // namespace lightfit
