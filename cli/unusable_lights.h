// cli/unusable_lights.h
//
// Entries of a lights file that can be no light, told as lights without a matrix are.
// In:   what the file has.
// Out:  lines on stderr.
#pragma once

#include <vector>

#include "absl/strings/string_view.h"
#include "io/lights_file.h"

namespace lightfit::cli {

// "no matrix for light "env": ..." where `what` is "matrix". Returns how many they are.
int PrintUnusable(const std::vector<ListedLight>& lights, absl::string_view what);

}  // namespace lightfit::cli
