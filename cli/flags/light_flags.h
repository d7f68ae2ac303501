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
#include "io/lights_file.h"

namespace CLI {
class App;
}

namespace lightfit::cli {

struct LightFlags {
  std::string path;
  std::vector<Light> extra;  // --light; replace those of the file by name
};

// Declares the options on `app`, to be parsed into `flags`, which must stay where it is.
void DeclareLightFlags(CLI::App* app, LightFlags* flags, const std::string& group);

// Those of the file, then those of --light, in that order; maybe none. One of --light replaces
// those of the file that have its name, whatever is wrong with them. As many as there are, each
// with a status; shadow_bit is the number in this list.
absl::StatusOr<std::vector<ListedLight>> ListLights(const LightFlags& flags);

// Those of them that can be used; there are at most kMaxLights.
absl::StatusOr<std::vector<Light>> ReadLights(const LightFlags& flags);

}  // namespace lightfit::cli
