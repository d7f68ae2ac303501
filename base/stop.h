// base/stop.h
//
// How work that somebody asked to stop comes to its end.
// In:   a StopScope around the work, with any std::stop_token.
// Out:  CancelledError.
//
// A token that says stop goes on saying so. Functions without a status may therefore return early
// with anything, as long as whoever returns a status calls CheckStop() after them: what looks
// finished there is finished. So no signature carries a token, as none carries an allocator
// (base/scratch.h).
#pragma once

#include <cstddef>
#include <stop_token>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace lightfit {

// While it lives, what this thread does ends with CancelledError once `stop` says so, within a
// fraction of a millisecond of search or a few rows of pixels. What comes to its end is the same
// with and without. Scopes nest: any of them stops what is inside of it. Threads that are started
// inside need scopes of their own.
class StopScope {
 public:
  explicit StopScope(std::stop_token stop);
  ~StopScope();
  StopScope(const StopScope&) = delete;
  StopScope& operator=(const StopScope&) = delete;

 private:
  friend bool StopRequested();
  friend bool StopPossible();

  std::stop_token stop_;
  const StopScope* outer_;
};

// Whether a scope of this thread says stop; whether one ever can.
bool StopRequested();
bool StopPossible();

// CancelledError once StopRequested(), in the name of `subject` ("readback").
absl::Status CheckStop(absl::string_view subject);

// For loops over steps of well below a microsecond: looks in every 256th.
inline bool IsStopped(size_t step) { return step % 256 == 0 && StopRequested(); }

}  // namespace lightfit
