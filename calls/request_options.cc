#include "calls/request_options.h"

#include <utility>

#include "absl/strings/str_format.h"
#include "wire/options_proto.h"

namespace lightfit {

absl::StatusOr<FitOptions> OptionsOfRequest(const v1::FitOptions& proto) {
  absl::StatusOr<FitOptions> options = FitOptionsFromProto(proto);
  if (!options.ok()) return options.status();
  for (const auto& [field, steps] : {std::pair{"reweighting_rounds", options->reweighting_rounds},
                                     std::pair{"line_search_rounds", options->line_search_rounds},
                                     std::pair{"grid_directions", options->grid_directions}}) {
    if (steps > kMaxSearchSteps) {
      return absl::InvalidArgumentError(
          absl::StrFormat("options.%s = %d, want at most %d", field, steps, kMaxSearchSteps));
    }
  }
  return options;
}

}  // namespace lightfit
