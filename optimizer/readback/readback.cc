#include "optimizer/readback/readback.h"

#include <cmath>

#include "absl/strings/str_format.h"
#include "optimizer/readback/fine_cover.h"

namespace lightfit {

absl::Status ValidateReadback(const Readback& readback) {
  if (absl::Status status = ValidateCamera(readback.camera, readback.depth_kind); !status.ok()) {
    return status;
  }
  if (readback.background.has_value()) {
    const float background = *readback.background;
    if (!(background > 0.0F)) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "readback.background = %g, want a depth above 0, or infinity", background));
    }
    if (IsNdc(readback.depth_kind) && std::isfinite(background)) {
      return absl::InvalidArgumentError(
          absl::StrFormat("readback.background = %g: depths of kind %s have their background at "
                          "the far plane, want "
                          "none here",
                          background,
                          DepthKindName(readback.depth_kind)));
    }
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
  const auto check_bits = [&](const char* field, size_t size) {
    if (size == want) return absl::OkStatus();
    return absl::InvalidArgumentError(
        absl::StrFormat("readback.%s: %d words, want %d x %d = %d as in readback.camera",
                        field,
                        size,
                        readback.width(),
                        readback.height(),
                        want));
  };
  if (absl::Status status = check_bits("shadow_bits", readback.shadow_bits.size()); !status.ok()) {
    return status;
  }
  if (!readback.facing_bits.empty()) {
    absl::Status status = check_bits("facing_bits", readback.facing_bits.size());
    if (!status.ok()) return status;
  }
  if (!readback.mapped_bits.empty()) {
    absl::Status status = check_bits("mapped_bits", readback.mapped_bits.size());
    if (!status.ok()) return status;
  }
  return readback.fine_cover != nullptr ? ValidateFineCover(readback) : absl::OkStatus();
}

}  // namespace lightfit
