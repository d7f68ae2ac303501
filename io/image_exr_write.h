// io/image_exr_write.h
//
// Images over the pixels of a camera as one OpenEXR file: footprints, wrong pixels.
// In:   the camera, an image for each channel.
// Out:  one file with a channel for each image, without loss, and the camera in worldToCamera and
//       worldToNDC, as io/readback_exr_write.h has it.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/types/span.h"
#include "geometry/camera.h"

namespace lightfit {

struct ExrImage {
  std::string channel;        // "LAYER.NAME"
  std::vector<float> values;  // row-major, top row first, finite
  bool is_mask = false;       // 0 and 1 alone: stored as half
};

// Replaces what is at `path` in one step. InvalidArgument for channels that share a name, have none
// or one too long, for images of another size than the camera's and values that are not finite, and
// for a camera with skewed pixels, which the attributes cannot express.
absl::Status WriteImageExr(const std::string& path,
                           const Camera& camera,
                           absl::Span<const ExrImage> images);

}  // namespace lightfit
