#include "optimizer/light_matrix.h"

#include "absl/strings/str_format.h"
#include "absl/strings/string_view.h"

namespace lightfit {

std::string LightMatrix::BriefReport() const {
  return absl::StrFormat("%s: %dx%d, energy %.6g (start %.6g), rms %.4g px, worst %.4g px, %s",
                         absl::string_view(light_name),
                         map.width,
                         map.height,
                         energy,
                         energy_start,
                         footprint.rms,
                         footprint.worst,
                         StopReasonName(stop_reason));
}

}  // namespace lightfit
