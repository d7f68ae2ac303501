// io/readback_exr_write.h
//
// Read-backs as OpenEXR files, such as ReadReadbackExr() reads with its default options.
// In:   a Readback with depth of kind kCameraZ, the lights of its shadow bits.
// Out:  one file: depth as "Z" (float); per light "shadow.NAME" (half, 1 where blocked, else 0),
//       likewise "facing.NAME" and "mapped.NAME" where the read-back knows them.
//
// The camera goes into worldToCamera and worldToNDC, as the OpenEXR standard has them. These are
// single precision, which moves a camera 400 metres from the origin by 0.03 mm, so it stands there
// a second time in double precision, for our own reader: it gets the camera as it was. The lights
// stand in the header, too (io/header_lights.h).
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/types/span.h"
#include "geometry/light.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

// Replaces what is at `path` in one step. InvalidArgument for a read-back or lights that cannot be
// used, and for a camera with skewed pixels, which the attributes cannot express.
absl::Status WriteReadbackExr(const std::string& path,
                              const Readback& readback,
                              absl::Span<const Light> lights);

}  // namespace lightfit
