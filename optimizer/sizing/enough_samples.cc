#include "optimizer/sizing/enough_samples.h"

#include "absl/strings/str_format.h"

namespace lightfit {

absl::Status CheckEnoughSamples(const Light& light,
                                const SampleCounts& counts,
                                const FitOptions& options) {
  if (options.search == Search::kFocused || counts.used >= options.samples.min_samples) {
    return absl::OkStatus();
  }
  if (counts.candidates == 0) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "light \"%s\": no shadow boundary among %d receivers: all are lit, or all are shadowed, so "
        "that any size of its map will do. Leave the light out",
        light.name,
        counts.receivers));
  }
  return absl::FailedPreconditionError(absl::StrFormat(
      "light \"%s\": %d usable samples, want at least %d to tell sizes by; of %d boundary pixels "
      "%d "
      "are background, %d at depth discontinuities, %d face away from the light, %d are edge-on. "
      "Use a larger read-back, or leave the light out",
      light.name,
      counts.used,
      options.samples.min_samples,
      counts.candidates,
      counts.background,
      counts.discontinuity,
      counts.facing_away,
      counts.edge_on));
}

}  // namespace lightfit
