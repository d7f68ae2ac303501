// server/call_gate.h
//
// Who may come in, and who is in: what a drain waits for.
// In:   every call, when it begins and when it is over.
// Out:  whether it may begin; a word to those inside when the gate closes; when all are over.
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>

#include "absl/time/time.h"

namespace lightfit {

class CallGate {
 public:
  enum class Entry { kIn, kFull, kClosed };

  // At most so many at a time.
  explicit CallGate(int max_inside) : max_inside_(max_inside) {}

  // Who is let in must leave. `owner` tells calls apart; `on_close`, which may be empty, is called
  // once when the gate closes before owner leaves, and must not call back here.
  Entry TryEnter(const void* owner, std::function<void()> on_close);
  void Leave(const void* owner);

  // From now on nobody enters.
  void Close();

  // False when some were still inside after `limit`.
  bool WaitUntilEmpty(absl::Duration limit);

  int num_inside() const;

 private:
  const int max_inside_;
  mutable std::mutex mutex_;
  std::condition_variable emptied_;
  std::map<const void*, std::function<void()>> inside_;
  bool is_closed_ = false;
};

}  // namespace lightfit
