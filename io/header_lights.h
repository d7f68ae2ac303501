// io/header_lights.h
//
// The lights that an EXR read-back was rendered with, as its header has them.
// In:   lights; or a file.
// Out:  the attribute "lightfit.lights", a string: lightfit.v1.LightList in JSON, as a lights file
//       has it; or the lights of it.
//
// `lightfit render` and examples/blender write it. It is the renderer's word for the frame: lights
// that move differ from one frame to the next.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "geometry/light.h"

namespace lightfit {

inline constexpr absl::string_view kLightsAttribute = "lightfit.lights";

// The value of the attribute. InvalidArgument for names that are not UTF-8.
absl::StatusOr<std::string> LightsForHeader(absl::Span<const Light> lights);

// Valid, shadow_bit 0, 1, ... in order; nothing where no part of the file has the attribute.
// InvalidArgument where it cannot be understood. No pixel is read.
absl::StatusOr<std::optional<std::vector<Light>>> LightsFromHeader(const std::string& path);

}  // namespace lightfit

namespace lightfit::internal {

class ExrInput;

// As above, of a file that is open: the attribute of `part`, else of the first part that has it.
absl::StatusOr<std::optional<std::vector<Light>>> LightsFromHeader(const ExrInput& exr, int part);

}  // namespace lightfit::internal
