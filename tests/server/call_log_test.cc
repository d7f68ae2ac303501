#include "server/call_log.h"

#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <random>
#include <thread>
#include <vector>

#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "tests/io/testing.h"

namespace lightfit {
namespace {

using google::protobuf::Struct;
using testing::HasAll;

// The lines of a log, read by protobuf's parser of JSON.
std::vector<Struct> Lines(const std::string& path) {
  std::vector<Struct> lines;
  for (const absl::string_view line :
       absl::StrSplit(testing::Bytes(path), '\n', absl::SkipEmpty())) {
    const auto status = google::protobuf::util::JsonStringToMessage({line.data(), line.size()},
                                                                    &lines.emplace_back());
    EXPECT_TRUE(status.ok()) << status.ToString() << "\n" << line;
  }
  return lines;
}

std::string Text(const Struct& line, const std::string& key) {
  const auto field = line.fields().find(key);
  return field == line.fields().end() ? "(no " + key + ")" : field->second.string_value();
}

double Number(const Struct& line, const std::string& key) {
  const auto field = line.fields().find(key);
  return field == line.fields().end() ? -1.0 : field->second.number_value();
}

CallLog Open(const std::string& path, LogLevel level = LogLevel::kInfo) {
  auto log = CallLog::Open(path, level);
  EXPECT_TRUE(log.ok()) << log.status();
  return *std::move(log);
}

TEST(CallLog, ACallIsOneLineWithItsFigures) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("calls.log");
  CallRecord record;
  record.request_id = "shot 12";
  record.method = "Fit";
  record.peer = "ipv4:10.0.0.7:4711";
  record.lights = 8;
  record.lights_failed = 1;
  record.pixels = 32400;
  record.bytes = int64_t{3} << 32;
  record.queue = absl::Microseconds(125);
  record.decode = absl::Milliseconds(2);
  record.solve = absl::Seconds(3);
  record.total = absl::InfiniteDuration();
  Open(path).Call(record);

  const std::vector<Struct> lines = Lines(path);
  ASSERT_EQ(lines.size(), 1);
  const Struct& line = lines[0];
  EXPECT_EQ(Text(line, "level"), "info");
  EXPECT_EQ(Text(line, "event"), "call");
  EXPECT_EQ(Text(line, "request_id"), "shot 12");
  EXPECT_EQ(Text(line, "method"), "Fit");
  EXPECT_EQ(Text(line, "peer"), "ipv4:10.0.0.7:4711");
  EXPECT_EQ(Text(line, "code"), "OK");
  EXPECT_EQ(Text(line, "message"), "");
  EXPECT_EQ(Number(line, "lights"), 8);
  EXPECT_EQ(Number(line, "lights_failed"), 1);
  EXPECT_EQ(Number(line, "pixels"), 32400);
  EXPECT_EQ(Number(line, "bytes"), 12884901888.0);
  EXPECT_EQ(Number(line, "queue_ms"), 0.125);
  EXPECT_EQ(Number(line, "decode_ms"), 2);
  EXPECT_EQ(Number(line, "solve_ms"), 3000);
  EXPECT_TRUE(line.fields().at("total_ms").has_null_value());
  absl::Time time;
  std::string error;
  ASSERT_TRUE(absl::ParseTime("%Y-%m-%dT%H:%M:%E3SZ", Text(line, "time"), &time, &error)) << error;
  EXPECT_LT(absl::AbsDuration(absl::Now() - time), absl::Hours(1));
  EXPECT_EQ(Text(line, "time").size(), 24);  // 2026-01-31T12:00:00.000Z
}

TEST(CallLog, LevelsTellWhoseFaultItIs) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("calls.log");
  const CallLog log = Open(path);
  const std::pair<absl::StatusCode, std::string> cases[] = {
      {absl::StatusCode::kOk, "info"},
      {absl::StatusCode::kInvalidArgument, "info"},
      {absl::StatusCode::kCancelled, "info"},
      {absl::StatusCode::kResourceExhausted, "warning"},
      {absl::StatusCode::kDeadlineExceeded, "warning"},
      {absl::StatusCode::kUnavailable, "warning"},
      {absl::StatusCode::kInternal, "error"},
      {absl::StatusCode::kUnknown, "error"}};
  for (const auto& [code, level] : cases) {
    CallRecord record;
    record.status = absl::Status(code, "why");
    log.Call(record);
  }
  const std::vector<Struct> lines = Lines(path);
  ASSERT_EQ(lines.size(), std::size(cases));
  for (size_t i = 0; i < lines.size(); ++i) {
    EXPECT_EQ(Text(lines[i], "level"), cases[i].second);
    EXPECT_EQ(Text(lines[i], "code"), absl::StatusCodeToString(cases[i].first));
    EXPECT_EQ(Text(lines[i], "message"), i == 0 ? "" : "why");
  }
}

TEST(CallLog, LinesBelowTheLevelAreLeftOut) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("calls.log");
  const CallLog log = Open(path, LogLevel::kWarning);
  log.Call({});
  log.Event(LogLevel::kDebug, "a", "");
  log.Event(LogLevel::kInfo, "b", "");
  log.Event(LogLevel::kWarning, "c", "");
  log.Event(LogLevel::kError, "d", "");
  const std::vector<Struct> lines = Lines(path);
  ASSERT_EQ(lines.size(), 2);
  EXPECT_EQ(Text(lines[0], "event"), "c");
  EXPECT_EQ(Text(lines[1], "event"), "d");
}

// Texts come back as sent, where they are UTF-8.
TEST(CallLog, HostileTextsStayInTheirField) {
  const std::string texts[] = {"\"},{\"level\":\"error\"",
                               "two\nlines\r\n",
                               "back\\slash",
                               "{} {0} %s %v",
                               std::string("nul\0nul", 7),
                               "\x1b[31mred\x7f",
                               "caf\xc3\xa9 \xe2\x82\xac \xf0\x9f\x92\xa1 \xf4\x8f\xbf\xbf"};
  for (const std::string& text : texts) {
    const testing::TemporaryFolder folder;
    const std::string path = folder.File("calls.log");
    CallRecord record;
    record.request_id = record.method = record.peer = text;
    record.status = absl::InvalidArgumentError(text);
    const CallLog log = Open(path);
    log.Call(record);
    log.Event(LogLevel::kInfo, text, text, {{"key " + text, text}});
    const std::vector<Struct> lines = Lines(path);
    ASSERT_EQ(lines.size(), 2);
    for (const char* key : {"request_id", "method", "peer", "message"}) {
      EXPECT_EQ(Text(lines[0], key), text);
    }
    EXPECT_EQ(Text(lines[1], "key " + text), text);
  }
}

TEST(CallLog, BytesThatAreNoUtf8AreReplaced) {
  const std::pair<std::string, std::string> cases[] = {
      {"\xff", "?"},
      {"a\xc3", "a?"},               // cut off
      {"\xc0\xaf", "??"},            // overlong
      {"\xe0\x80\xaf", "???"},       // overlong
      {"\xed\xa0\x80", "???"},       // a surrogate
      {"\xf4\x90\x80\x80", "????"},  // beyond the last character
      {"\xe2\x82z\xc3\xa9", "??z\xc3\xa9"}};
  for (const auto& [bytes, expected] : cases) {
    const testing::TemporaryFolder folder;
    const std::string path = folder.File("calls.log");
    Open(path).Event(LogLevel::kInfo, "e", bytes);
    const std::vector<Struct> lines = Lines(path);
    ASSERT_EQ(lines.size(), 1);
    const std::string text = Text(lines[0], "message");
    EXPECT_EQ(absl::StrReplaceAll(text, {{"\xef\xbf\xbd", "?"}}), expected);
  }
}

TEST(CallLog, RandomBytesGiveValidLines) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("calls.log");
  const CallLog log = Open(path);
  std::mt19937 random(testing::kSeed);
  constexpr int kNumLines = 2000;
  for (int i = 0; i < kNumLines; ++i) {
    std::string bytes(random() % 60, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    log.Event(LogLevel::kInfo, "random", bytes);
  }
  EXPECT_EQ(Lines(path).size(), kNumLines) << "seed " << testing::kSeed;
}

TEST(CallLog, LongTextsAreCut) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("calls.log");
  const CallLog log = Open(path);
  log.Event(LogLevel::kInfo, "e", std::string(kMaxLogTextBytes, 'x'));
  log.Event(LogLevel::kInfo, "e", std::string(10 << 20, 'x'));
  const std::vector<Struct> lines = Lines(path);
  ASSERT_EQ(lines.size(), 2);
  EXPECT_EQ(Text(lines[0], "message"), std::string(kMaxLogTextBytes, 'x'));
  EXPECT_EQ(Text(lines[1], "message"), std::string(kMaxLogTextBytes, 'x') + "...");
}

// Four threads write while the file is renamed and reopened, as log rotation does: every line is in
// one of the files, whole.
TEST(CallLog, RotationLosesNoLine) {
  constexpr int kNumThreads = 4, kNumLines = 500, kNumRotations = 10;
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("calls.log");
  const CallLog log = Open(path);
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < kNumThreads; ++i) {
      threads.emplace_back([&log] {
        for (int line = 0; line < kNumLines; ++line) {
          log.Event(LogLevel::kInfo, "line", std::string(100, 'x'));
        }
      });
    }
    for (int i = 0; i < kNumRotations; ++i) {
      std::filesystem::rename(path, folder.File(std::to_string(i)));
      EXPECT_TRUE(log.Reopen().ok());
      std::this_thread::yield();
    }
  }
  size_t num_lines = Lines(path).size();
  for (int i = 0; i < kNumRotations; ++i) num_lines += Lines(folder.File(std::to_string(i))).size();
  EXPECT_EQ(num_lines, kNumThreads * kNumLines);
}

TEST(CallLog, FilesThatCannotBeOpenedAreNamed) {
  const testing::TemporaryFolder folder;
  EXPECT_TRUE(
      HasAll(CallLog::Open(folder.File("")).status().message(), {folder.File(""), "- for"}));
  EXPECT_TRUE(HasAll(CallLog::Open("").status().message(), {"want a file"}));
  const std::string path = folder.File("calls.log");
  const CallLog log = Open(path);
  std::filesystem::rename(path, folder.File("old"));
  std::filesystem::create_directory(path);
  EXPECT_TRUE(HasAll(log.Reopen().message(), {path}));
  log.Event(LogLevel::kInfo, "still", "here");
  EXPECT_EQ(Lines(folder.File("old")).size(), 1);
}

TEST(CallLog, StandardErrorIsAFileToo) {
  ::testing::internal::CaptureStderr();
  const CallLog log = Open("-");
  log.Event(LogLevel::kInfo, "start", "up");
  EXPECT_TRUE(log.Reopen().ok());
  EXPECT_TRUE(HasAll(::testing::internal::GetCapturedStderr(),
                     {"\"event\":\"start\",\"message\":\"up\"}\n"}));
}

TEST(CallLog, LevelsHaveNames) {
  EXPECT_EQ(*ParseLogLevel("debug"), LogLevel::kDebug);
  EXPECT_EQ(*ParseLogLevel("error"), LogLevel::kError);
  EXPECT_TRUE(HasAll(ParseLogLevel("loud").status().message(), {"\"loud\"", "warning"}));
}

}  // namespace
}  // namespace lightfit
