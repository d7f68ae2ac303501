#include "base/stop.h"

#include <utility>

#include "absl/strings/str_format.h"

namespace lightfit {

namespace {

thread_local const StopScope* innermost = nullptr;

}  // namespace

StopScope::StopScope(std::stop_token stop) : stop_(std::move(stop)), outer_(innermost) {
  innermost = this;
}

StopScope::~StopScope() { innermost = outer_; }

bool StopRequested() {
  for (const StopScope* scope = innermost; scope != nullptr; scope = scope->outer_) {
    if (scope->stop_.stop_requested()) return true;
  }
  return false;
}

bool StopPossible() {
  for (const StopScope* scope = innermost; scope != nullptr; scope = scope->outer_) {
    if (scope->stop_.stop_possible()) return true;
  }
  return false;
}

absl::Status CheckStop(absl::string_view subject) {
  if (!StopRequested()) return absl::OkStatus();
  return absl::CancelledError(absl::StrFormat("%s: stopped before the work was done", subject));
}

}  // namespace lightfit
