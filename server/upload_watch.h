// server/upload_watch.h
//
// Ends uploads that take too long, so that a sender that stalls or dribbles does not hold memory
// for ever.
// In:   who is uploading, and since when.
// Out:  a call to each that is late, once, from a thread of its own.
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <thread>

#include "absl/time/time.h"

namespace lightfit {

class UploadWatch {
 public:
  explicit UploadWatch(absl::Duration limit);
  ~UploadWatch();

  UploadWatch(const UploadWatch&) = delete;
  UploadWatch& operator=(const UploadWatch&) = delete;

  absl::Duration limit() const { return limit_; }

  // Calls `on_late` unless End() comes within the limit. `owner` tells uploads apart. `on_late`
  // must not call back here.
  void Begin(const void* owner, std::function<void()> on_late);

  // `on_late` is not being called any more, nor will it be. No harm where none has begun.
  void End(const void* owner);

 private:
  struct Upload {
    absl::Time deadline;
    std::function<void()> on_late;
  };
  void Run();

  const absl::Duration limit_;
  std::mutex mutex_;
  std::condition_variable wakes_;
  std::map<const void*, Upload> uploads_;
  bool is_ending_ = false;
  std::thread thread_;
};

}  // namespace lightfit
