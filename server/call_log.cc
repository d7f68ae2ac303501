#include "server/call_log.h"

#include <spdlog/logger.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/dist_sink.h>
#include <spdlog/sinks/stdout_sinks.h>

#include <cmath>
#include <exception>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace lightfit {
namespace {

using Sinks = spdlog::sinks::dist_sink_mt;  // its contents can be swapped between two lines

spdlog::level::level_enum SpdlogLevel(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return spdlog::level::debug;
    case LogLevel::kInfo:
      return spdlog::level::info;
    case LogLevel::kWarning:
      return spdlog::level::warn;
    case LogLevel::kError:
      return spdlog::level::err;
  }
  return spdlog::level::err;
}

absl::string_view LevelName(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return "debug";
    case LogLevel::kInfo:
      return "info";
    case LogLevel::kWarning:
      return "warning";
    case LogLevel::kError:
      return "error";
  }
  return "error";
}

LogLevel LevelOf(absl::StatusCode code) {
  switch (code) {
    case absl::StatusCode::kInternal:
    case absl::StatusCode::kUnknown:
    case absl::StatusCode::kDataLoss:
      return LogLevel::kError;
    case absl::StatusCode::kResourceExhausted:
    case absl::StatusCode::kUnavailable:
    case absl::StatusCode::kDeadlineExceeded:
    case absl::StatusCode::kAborted:
      return LogLevel::kWarning;
    default:
      return LogLevel::kInfo;
  }
}

// Bytes of the UTF-8 character that `text` begins with, 0 where there is none: a stray or missing
// continuation, an overlong form, a surrogate, beyond U+10FFFF (Unicode 15, table 3-7).
size_t Utf8Length(absl::string_view text) {
  const auto byte = [text](size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return 0;
  const unsigned char least = first == 0xE0 ? 0xA0 : first == 0xF0 ? 0x90 : 0x80;
  const unsigned char most = first == 0xED ? 0x9F : first == 0xF4 ? 0x8F : 0xBF;
  if (byte(1) < least || byte(1) > most) return 0;
  for (size_t i = 2; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  return length;
}

void AppendJsonString(absl::string_view text, std::string* json) {
  const bool is_cut = text.size() > kMaxLogTextBytes;
  if (is_cut) text = text.substr(0, kMaxLogTextBytes);
  json->push_back('"');
  while (!text.empty()) {
    const size_t length = Utf8Length(text);
    const unsigned char first = text[0];
    if (length == 0) {
      absl::StrAppend(json, "\\ufffd");
    } else if (first == '"' || first == '\\') {
      json->push_back('\\');
      json->push_back(text[0]);
    } else if (first < 0x20 || first == 0x7F) {
      absl::StrAppendFormat(json, "\\u%04x", first);
    } else {
      json->append(text.data(), length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  if (is_cut) absl::StrAppend(json, "...");
  json->push_back('"');
}

// A JSON object under construction; keys are written in the order of the calls.
class Line {
 public:
  Line(LogLevel level, absl::string_view event) {
    Text("time", absl::FormatTime("%Y-%m-%dT%H:%M:%E3SZ", absl::Now(), absl::UTCTimeZone()));
    Text("level", LevelName(level));
    Text("event", event);
  }

  void Text(absl::string_view key, absl::string_view value) {
    Key(key);
    AppendJsonString(value, &json_);
  }

  void Number(absl::string_view key, int64_t value) {
    Key(key);
    absl::StrAppend(&json_, value);
  }

  void Milliseconds(absl::string_view key, absl::Duration duration) {
    Key(key);
    const double value_ms = absl::ToDoubleMilliseconds(duration);
    // JSON has no infinity.
    absl::StrAppend(&json_, std::isfinite(value_ms) ? absl::StrFormat("%.3f", value_ms) : "null");
  }

  std::string Finish() && { return std::move(json_) + "}"; }

 private:
  void Key(absl::string_view key) {
    json_.push_back(json_.empty() ? '{' : ',');
    AppendJsonString(key, &json_);
    json_.push_back(':');
  }

  std::string json_;
};

// spdlog throws what it cannot open.
absl::StatusOr<spdlog::sink_ptr> OpenSink(const std::string& path) {
  try {
    spdlog::sink_ptr sink;
    if (path == "-") {
      sink = std::make_shared<spdlog::sinks::stderr_sink_mt>();
    } else {
      sink = std::make_shared<spdlog::sinks::basic_file_sink_mt>(path);
    }
    sink->set_pattern("%v");
    return sink;
  } catch (const std::exception& error) {
    return absl::InvalidArgumentError(absl::StrCat(
        "log ", path, ": ", error.what(), "; want a file that can be written, or - for stderr"));
  }
}

}  // namespace

absl::StatusOr<LogLevel> ParseLogLevel(absl::string_view name) {
  for (const LogLevel level :
       {LogLevel::kDebug, LogLevel::kInfo, LogLevel::kWarning, LogLevel::kError}) {
    if (name == LevelName(level)) return level;
  }
  return absl::InvalidArgumentError(
      absl::StrCat("log level = \"", name, "\", want debug, info, warning or error"));
}

absl::StatusOr<CallLog> CallLog::Open(const std::string& path, LogLevel level) {
  if (path.empty()) return absl::InvalidArgumentError("log \"\": want a file, or - for stderr");
  absl::StatusOr<spdlog::sink_ptr> sink = OpenSink(path);
  if (!sink.ok()) return sink.status();
  auto sinks = std::make_shared<Sinks>(std::vector<spdlog::sink_ptr>{*std::move(sink)});
  auto logger = std::make_shared<spdlog::logger>("lightfit", std::move(sinks));
  logger->set_level(SpdlogLevel(level));
  logger->flush_on(spdlog::level::debug);  // a killed server leaves its last line
  return CallLog(path, std::move(logger));
}

void CallLog::Call(const CallRecord& record) const {
  const LogLevel level = LevelOf(record.status.code());
  if (!logger_->should_log(SpdlogLevel(level))) return;
  Line line(level, "call");
  line.Text("request_id", record.request_id);
  line.Text("method", record.method);
  line.Text("peer", record.peer);
  line.Text("code", absl::StatusCodeToString(record.status.code()));
  line.Text("message", record.status.message());
  line.Number("lights", record.lights);
  line.Number("lights_failed", record.lights_failed);
  line.Number("pixels", record.pixels);
  line.Number("bytes", record.bytes);
  line.Milliseconds("queue_ms", record.queue);
  line.Milliseconds("decode_ms", record.decode);
  line.Milliseconds("solve_ms", record.solve);
  line.Milliseconds("total_ms", record.total);
  Write(level, std::move(line).Finish());
}

void CallLog::Event(LogLevel level,
                    absl::string_view event,
                    absl::string_view message,
                    const KeyValues& values) const {
  if (!logger_->should_log(SpdlogLevel(level))) return;
  Line line(level, event);
  line.Text("message", message);
  for (const auto& [key, value] : values) line.Text(key, value);
  Write(level, std::move(line).Finish());
}

void CallLog::Write(LogLevel level, const std::string& line) const {
  logger_->log(SpdlogLevel(level), spdlog::string_view_t(line));
}

absl::Status CallLog::Reopen() const {
  if (path_ == "-") return absl::OkStatus();
  absl::StatusOr<spdlog::sink_ptr> sink = OpenSink(path_);
  if (!sink.ok()) return sink.status();
  static_cast<Sinks&>(*logger_->sinks()[0]).set_sinks({*std::move(sink)});
  return absl::OkStatus();
}

}  // namespace lightfit
