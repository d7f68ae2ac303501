// server/deadline_watch.h
//
// Ends what waits for clients too long: uploads that stall or dribble hold memory, streams without
// frames a place.
// In:   who waits, and how long it may.
// Out:  a call to each that is late, once, from a thread of its own.
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <thread>

#include "absl/time/time.h"

namespace lightfit {

class DeadlineWatch {
 public:
  DeadlineWatch();
  ~DeadlineWatch();

  DeadlineWatch(const DeadlineWatch&) = delete;
  DeadlineWatch& operator=(const DeadlineWatch&) = delete;

  // Calls `on_late` unless End() or another Begin() of this owner comes within the limit. It must
  // not call back here.
  void Begin(const void* owner, absl::Duration limit, std::function<void()> on_late);

  // `on_late` is not being called any more, nor will it be. No harm where none has begun.
  void End(const void* owner);

 private:
  struct Wait {
    absl::Time deadline;
    std::function<void()> on_late;
  };
  void Run();

  std::mutex mutex_;
  std::condition_variable wakes_;
  std::map<const void*, Wait> waits_;
  bool is_ending_ = false;
  std::thread thread_;
};

}  // namespace lightfit
