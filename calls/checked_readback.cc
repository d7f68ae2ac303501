#include "calls/checked_readback.h"

#include <cmath>
#include <utility>

#include "geometry/camera.h"
#include "io/notes/readback_warnings.h"
#include "wire/utf8.h"

namespace lightfit {

void CheckedReadback::PutInto(v1::ReadbackInfo* info) const {
  for (const std::string& warning : warnings) info->add_warnings(Utf8Text(warning));
  if (readback.background.has_value() && std::isfinite(*readback.background)) {
    info->set_background(*readback.background);
  }
}

CheckedReadback CheckReadback(const Readback& readback,
                              const std::vector<RequestLight>& lights,
                              bool is_tracked) {
  CheckedReadback checked = {readback, {}};
  if (!ValidateReadback(readback).ok()) return checked;
  std::vector<Light> usable;
  for (const RequestLight& light : lights) {
    if (light.status.ok()) usable.push_back(light.light);
  }
  std::vector<ReadbackWarning> warnings =
      is_tracked ? BackgroundWarnings(usable, WarningWords::kCall, &checked.readback)
                 : PixelWarnings(usable, WarningWords::kCall, &checked.readback);
  for (ReadbackWarning& warning : warnings) checked.warnings.push_back(std::move(warning.text));
  return checked;
}

}  // namespace lightfit
