#include "base/stop.h"

#include "absl/strings/str_format.h"

namespace lightfit {

absl::Status CheckStop(const std::stop_token& stop, absl::string_view subject) {
  if (!stop.stop_requested()) return absl::OkStatus();
  return absl::CancelledError(
      absl::StrFormat("%s: stopped before the work was done (options.stop)", subject));
}

}  // namespace lightfit
