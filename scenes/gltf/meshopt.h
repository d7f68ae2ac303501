// scenes/gltf/meshopt.h
//
// Buffer views under EXT_meshopt_compression. The one place that knows meshoptimizer.
// In:   what the extension states, and the packed bytes.
// Out:  count * stride bytes.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace lightfit::gltf {

struct MeshoptLayout {
  std::string mode;    // ATTRIBUTES, TRIANGLES, INDICES
  std::string filter;  // NONE or "", OCTAHEDRAL, QUATERNION, EXPONENTIAL
  int64_t count = 0;
  int64_t stride = 0;  // bytes
};

// InvalidArgument for a layout that the extension does not allow, and before memory is taken when
// so few bytes cannot hold so much.
absl::StatusOr<std::string> DecodeMeshopt(const MeshoptLayout& layout, absl::string_view packed);

}  // namespace lightfit::gltf
