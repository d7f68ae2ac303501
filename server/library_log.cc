#include "server/library_log.h"

#include <google/protobuf/stubs/logging.h>
#include <grpc/support/log.h>

#include <mutex>
#include <string>

namespace lightfit {
namespace {

// The libraries have one function for all their messages, without an argument of ours.
std::mutex mutex;
const CallLog* current = nullptr;

void Write(LogLevel level, const char* event, const std::string& message) {
  const std::lock_guard lock(mutex);
  if (current != nullptr) current->Event(level, event, message);
}

void WriteForGrpc(gpr_log_func_args* args) {
  const LogLevel level = args->severity == GPR_LOG_SEVERITY_ERROR  ? LogLevel::kWarning
                         : args->severity == GPR_LOG_SEVERITY_INFO ? LogLevel::kInfo
                                                                   : LogLevel::kDebug;
  Write(level, "grpc", args->message);
}

// It reports what is wrong with clients' messages, which must not wake anybody.
void WriteForProtobuf(google::protobuf::LogLevel level,
                      const char* /*file*/,
                      int /*line*/,
                      const std::string& message) {
  Write(level == google::protobuf::LOGLEVEL_FATAL ? LogLevel::kError : LogLevel::kInfo,
        "protobuf",
        message);
}

}  // namespace

LibraryLogRoute::LibraryLogRoute(const CallLog* log) : log_(log) {
  const std::lock_guard lock(mutex);
  current = log;
  gpr_set_log_function(&WriteForGrpc);
  google::protobuf::SetLogHandler(&WriteForProtobuf);
}

LibraryLogRoute::~LibraryLogRoute() {
  const std::lock_guard lock(mutex);
  if (current == log_) current = nullptr;
}

}  // namespace lightfit
