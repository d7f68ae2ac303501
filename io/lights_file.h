// io/lights_file.h
//
// Lights from JSON files and from the command line.
// In:   {"lights": [{"name": "key", "position": [x, y, z]}, {"name": "sun", "direction": [x, y,
// z]}]},
//       a lightfit.v1.LightList in protobuf JSON (unknown fields are ignored), or "sun=sun:0,0,-1".
// Out:  lights, valid, with distinct names and shadow_bit 0, 1, ... in the order of the file.
//
// Files of lights that move, with "frames", are read by io/frames/light_frames.h and refused here.
//
// Positions are in world units; a direction is the one in which the light travels, of any length.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "geometry/light.h"

namespace lightfit {

absl::StatusOr<std::vector<Light>> ReadLightsFile(const std::string& path);
absl::StatusOr<std::vector<Light>> ParseLightsJson(absl::string_view json);

// "NAME=point:x,y,z" or "NAME=sun:x,y,z". The shadow_bit is 0.
absl::StatusOr<Light> ParseLight(absl::string_view text);

}  // namespace lightfit
