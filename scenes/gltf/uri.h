// scenes/gltf/uri.h
//
// The bytes that a URI of a glTF file names.
// In:   a path; or a URI and the folder of the file that has it: a file beside it, percent-encoded
//       or as it is, or data in base64.
// Out:  the bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "absl/status/statusor.h"

namespace lightfit::gltf {

// At most so many bytes from the beginning of a regular file.
absl::StatusOr<std::string> ReadWhole(const std::filesystem::path& path, int64_t max_bytes);

absl::StatusOr<std::string> ReadUri(const std::string& folder,
                                    const std::string& uri,
                                    int64_t max_bytes);

}  // namespace lightfit::gltf
