// io/lights_file.h
//
// Lights from JSON files and from the command line.
// In:   {"lights": [{"name": "key", "position": [x, y, z]}, ...]}, lightfit.v1.Light in protobuf
//       JSON (unknown fields are ignored), or "sun=sun:0,0,-1".
//       Of a .glb or .gltf file its KHR_lights_punctual (scenes/gltf_view.h).
// Out:  lights with shadow_bit 0, 1, ... in the order of the file, and why some are of no use.
//
// Positions are in world units; a direction is the one in which the light travels, of any length.
// Files list whole scenes: a light may say what it is in "type" or "kind", in the words of any
// renderer ("SPOT", "distant_light", "PxrDomeLight"). With a position and a direction it is a spot,
// whose shadow map needs the position alone, unless its type says sun. What has no single point or
// direction, a dome or an area, fails alone.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "geometry/light.h"

namespace lightfit {

// An entry of a lights file: a light to use, or why it is none. Its name may be empty or another's
// then; its number in the file says which it is.
struct ListedLight {
  Light light;
  absl::Status status;
};

// As many as the file has. Fails as a whole only where the file is not such a list, or it is empty.
// Of lights that share a name the first is good.
absl::StatusOr<std::vector<ListedLight>> ReadLightList(const std::string& path);
absl::StatusOr<std::vector<ListedLight>> ParseLightList(absl::string_view json);

// The same where every light must be good, and there are at most kMaxLights.
absl::StatusOr<std::vector<Light>> ReadLightsFile(const std::string& path);
absl::StatusOr<std::vector<Light>> ParseLightsJson(absl::string_view json);

// "NAME=point:x,y,z" or "NAME=sun:x,y,z". The shadow_bit is 0.
absl::StatusOr<Light> ParseLight(absl::string_view text);

}  // namespace lightfit
