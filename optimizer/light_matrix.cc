#include "optimizer/light_matrix.h"

#include "absl/strings/str_format.h"
#include "absl/strings/string_view.h"

namespace lightfit {

std::string LightMatrix::BriefReport() const {
  return absl::StrFormat("%s: %dx%d, energy %.6g (start %.6g), rms %.4g px, worst %.4g px, %s",
                         absl::string_view(light_name),
                         map.width,
                         map.height,
                         figures.energy,
                         search.energy_start,
                         figures.footprint.rms,
                         figures.footprint.worst,
                         StopReasonName(search.stop_reason));
}

}  // namespace lightfit
