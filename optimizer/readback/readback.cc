#include "optimizer/readback/readback.h"

#include "absl/strings/str_format.h"

namespace lightfit {

absl::Status ValidateReadback(const Readback& readback) {
  if (absl::Status status = ValidateCamera(readback.camera, readback.depth_kind); !status.ok()) {
    return status;
  }
  const size_t want = static_cast<size_t>(readback.width()) * readback.height();
  if (readback.depth.size() != want) {
    return absl::InvalidArgumentError(
        absl::StrFormat("readback.depth: %d values, want %d x %d = %d as in readback.camera",
                        readback.depth.size(),
                        readback.width(),
                        readback.height(),
                        want));
  }
  if (readback.shadow_bits.size() != want) {
    return absl::InvalidArgumentError(
        absl::StrFormat("readback.shadow_bits: %d words, want %d x %d = %d as in readback.camera",
                        readback.shadow_bits.size(),
                        readback.width(),
                        readback.height(),
                        want));
  }
  return absl::OkStatus();
}

}  // namespace lightfit
