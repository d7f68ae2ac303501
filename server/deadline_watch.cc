#include "server/deadline_watch.h"

#include <algorithm>
#include <utility>

#include "absl/time/clock.h"

namespace lightfit {
namespace {

constexpr absl::Duration kForEver = absl::Hours(24 * 365);  // longer overflows in wait_for()

}  // namespace

DeadlineWatch::DeadlineWatch() : thread_([this] { Run(); }) {}

DeadlineWatch::~DeadlineWatch() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  wakes_.notify_all();
  thread_.join();
}

void DeadlineWatch::Begin(const void* owner, absl::Duration limit, std::function<void()> on_late) {
  {
    const std::lock_guard lock(mutex_);
    waits_[owner] = {absl::Now() + std::min(limit, kForEver), std::move(on_late)};
  }
  wakes_.notify_all();  // it may be the next
}

void DeadlineWatch::End(const void* owner) {
  const std::lock_guard lock(mutex_);
  waits_.erase(owner);
}

void DeadlineWatch::Run() {
  std::unique_lock lock(mutex_);
  while (!is_ending_) {
    if (waits_.empty()) {
      wakes_.wait(lock);
      continue;
    }
    absl::Time next = absl::InfiniteFuture();
    const absl::Time now = absl::Now();
    for (auto wait = waits_.begin(); wait != waits_.end();) {
      if (wait->second.deadline > now) {
        next = std::min(next, wait->second.deadline);
        ++wait;
        continue;
      }
      wait->second.on_late();
      wait = waits_.erase(wait);
    }
    if (waits_.empty()) continue;
    wakes_.wait_for(lock, absl::ToChronoMicroseconds(next - now));
  }
}

}  // namespace lightfit
