#include "server/upload_watch.h"

#include <algorithm>
#include <utility>

#include "absl/time/clock.h"

namespace lightfit {
namespace {

constexpr absl::Duration kForEver = absl::Hours(24 * 365);  // longer overflows in wait_for()

}  // namespace

UploadWatch::UploadWatch(absl::Duration limit)
    : limit_(std::min(limit, kForEver)), thread_([this] { Run(); }) {}

UploadWatch::~UploadWatch() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  wakes_.notify_all();
  thread_.join();
}

void UploadWatch::Begin(const void* owner, std::function<void()> on_late) {
  const std::lock_guard lock(mutex_);
  uploads_[owner] = {absl::Now() + limit_, std::move(on_late)};
  // The thread sleeps longer than that only while there is nothing to watch.
  if (uploads_.size() == 1) wakes_.notify_all();
}

void UploadWatch::End(const void* owner) {
  const std::lock_guard lock(mutex_);
  uploads_.erase(owner);
}

void UploadWatch::Run() {
  std::unique_lock lock(mutex_);
  while (!is_ending_) {
    if (uploads_.empty()) {
      wakes_.wait(lock);
      continue;
    }
    absl::Time next = absl::InfiniteFuture();
    const absl::Time now = absl::Now();
    for (auto upload = uploads_.begin(); upload != uploads_.end();) {
      if (upload->second.deadline > now) {
        next = std::min(next, upload->second.deadline);
        ++upload;
        continue;
      }
      upload->second.on_late();
      upload = uploads_.erase(upload);
    }
    if (uploads_.empty()) continue;
    wakes_.wait_for(lock, absl::ToChronoMicroseconds(next - now));
  }
}

}  // namespace lightfit
