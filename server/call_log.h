// server/call_log.h
//
// The server's log: a JSON object on each line.
// In:   finished calls, and events of the server itself.
// Out:  lines in a file or on stderr, whole whatever threads write, valid JSON whatever clients
//       send: control characters are escaped, bytes that are no UTF-8 replaced, long texts cut.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"

namespace spdlog {
class logger;
}

namespace lightfit {

enum class LogLevel { kDebug, kInfo, kWarning, kError };

// "debug", "info", "warning", "error".
absl::StatusOr<LogLevel> ParseLogLevel(absl::string_view name);

// Texts longer than this are cut, with "..." in place of the rest.
inline constexpr size_t kMaxLogTextBytes = 1024;

// A line {"time", "level", "event": "call", ...}; names in the line as here, status as "code" and
// "message", durations as "queue_ms", ..., milliseconds.
struct CallRecord {
  std::string request_id;
  std::string method;
  std::string peer;
  absl::Status status;
  int64_t lights = 0;
  int64_t lights_failed = 0;
  int64_t pixels = 0;
  int64_t bytes = 0;  // of the request
  absl::Duration queue, decode, solve, total;
};

class CallLog {
 public:
  // `path` is "-" for stderr, or a file, which is appended to. Lines below `level` are left out.
  static absl::StatusOr<CallLog> Open(const std::string& path, LogLevel level = LogLevel::kInfo);

  // info; warning when the server could not keep up (RESOURCE_EXHAUSTED, UNAVAILABLE,
  // DEADLINE_EXCEEDED, ABORTED); error when it is the server's fault (INTERNAL, UNKNOWN,
  // DATA_LOSS). What clients do wrong is info: it must not wake anybody.
  void Call(const CallRecord& record) const;

  // A line {"time", "level", "event", "message", ...} with `values` after it.
  using KeyValues = std::vector<std::pair<std::string, std::string>>;
  void Event(LogLevel level,
             absl::string_view event,
             absl::string_view message,
             const KeyValues& values = {}) const;

  // Opens the file anew, as after its rotation; nothing for stderr. On failure the old file stays
  // in use. Takes locks and allocates: not from within a signal handler.
  absl::Status Reopen() const;

 private:
  CallLog(std::string path, std::shared_ptr<spdlog::logger> logger)
      : path_(std::move(path)), logger_(std::move(logger)) {}

  void Write(LogLevel level, const std::string& line) const;

  std::string path_;
  std::shared_ptr<spdlog::logger> logger_;
};

}  // namespace lightfit
