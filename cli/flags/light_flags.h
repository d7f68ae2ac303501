// cli/flags/light_flags.h
//
// --lights FILE and --light NAME=..., which every verb that knows lights has.
// In:   words; a wrong one is refused while parsing (exit code 1).
// Out:  LightFlags, and the lights that they name.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "geometry/light.h"

namespace CLI {
class App;
}

namespace lightfit::cli {

struct LightFlags {
  std::string path;
  std::string json;          // not empty: instead of what is in that file, where lights move
  std::vector<Light> extra;  // --light; replace those of the file by name
};

// Declares the options on `app`, to be parsed into `flags`, which must stay where it is.
void DeclareLightFlags(CLI::App* app, LightFlags* flags, const std::string& group);

// Those of the file, then those of --light, with shadow bits in that order; maybe none. Valid, with
// distinct names, at most kMaxLights.
absl::StatusOr<std::vector<Light>> ReadLights(const LightFlags& flags);

}  // namespace lightfit::cli
