// io/fine_cover_exr.h
//
// A finer image of a read-back's view, for the map's cover alone.
// In:   an EXR file as of io/readback_exr.h, the lights, the read-back that it shows finer.
// Out:  FineCoverFile, owned.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/light.h"
#include "io/readback_exr.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

struct FineCoverFile {
  int columns = 0, rows = 0;
  std::vector<float> depth;
  // Lit where facing channels are known; lights without one have no bit.
  std::vector<uint32_t> shadow_bits, lit_bits;
  uint32_t lit_lights = 0;  // of those that have one

  // Refers to this object's buffers.
  FineCover View() const;
};

// Reads it as a read-back of the same kind, lights and channels, and with the read-back's camera.
// InvalidArgument when it is not larger, or a camera in its own header sees another view. A light
// without channels here has nothing in the finer cover.
absl::StatusOr<FineCoverFile> ReadFineCoverExr(const std::string& path,
                                               absl::Span<const Light> lights,
                                               const ReadbackExrOptions& options,
                                               const ReadbackFile& readback);

}  // namespace lightfit
