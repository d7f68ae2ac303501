#include "server/call_gate.h"

#include <algorithm>
#include <utility>

namespace lightfit {

CallGate::Entry CallGate::TryEnter(const void* owner, std::function<void()> on_close) {
  const std::lock_guard lock(mutex_);
  if (is_closed_) return Entry::kClosed;
  if (static_cast<int>(inside_.size()) >= max_inside_) return Entry::kFull;
  inside_.emplace(owner, std::move(on_close));
  return Entry::kIn;
}

void CallGate::Leave(const void* owner) {
  const std::lock_guard lock(mutex_);
  inside_.erase(owner);
  if (inside_.empty()) emptied_.notify_all();
}

void CallGate::Close() {
  const std::lock_guard lock(mutex_);
  is_closed_ = true;
  for (auto& [owner, on_close] : inside_) {
    if (on_close) on_close();
    on_close = nullptr;
  }
}

bool CallGate::WaitUntilEmpty(absl::Duration limit) {
  constexpr absl::Duration kForEver = absl::Hours(24 * 365);  // longer overflows in wait_for()
  limit = std::min(limit, kForEver);
  std::unique_lock lock(mutex_);
  return emptied_.wait_for(
      lock, absl::ToChronoMicroseconds(limit), [this] { return inside_.empty(); });
}

int CallGate::num_inside() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(inside_.size());
}

}  // namespace lightfit
