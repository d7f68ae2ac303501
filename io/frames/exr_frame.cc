#include "io/frames/exr_frame.h"

#include <string>
#include <vector>

#include "io/exr/input.h"
#include "io/readback_exr.h"

namespace lightfit {

std::optional<FrameNumber> FrameOfExr(const std::string& path) {
  const auto exr = internal::ExrInput::Open(path, ReadbackExrOptions().max_pixels);
  if (!exr.ok()) return std::nullopt;
  std::optional<FrameNumber> found;
  for (int part = 0; part < exr->num_parts(); ++part) {
    const std::optional<FrameNumber> own = exr->FrameAttribute(part);
    if (!own.has_value()) continue;
    if (found.has_value() && *found != *own) return std::nullopt;
    found = own;
  }
  return found;
}

}  // namespace lightfit
