// base/stop.h
//
// How work that somebody asked to stop comes to its end.
// In:   FitOptions::stop, or any std::stop_token.
// Out:  CancelledError.
//
// A token that says stop goes on saying so. Functions without a status may therefore return early
// with anything, as long as whoever returns a status calls CheckStop() after them: what looks
// finished there is finished.
#pragma once

#include <cstddef>
#include <stop_token>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace lightfit {

// CancelledError once `stop` says so, in the name of `subject` ("readback").
absl::Status CheckStop(const std::stop_token& stop, absl::string_view subject);

// For loops over steps of well below a microsecond: looks at the token in every 256th.
inline bool IsStopped(const std::stop_token& stop, size_t step) {
  return step % 256 == 0 && stop.stop_requested();
}

}  // namespace lightfit
