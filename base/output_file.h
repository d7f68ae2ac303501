// base/output_file.h
//
// Files that a verb writes, checked before the long work. WriteTextFileAtomically() writes them.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace lightfit {

// Whether a file can be created at `path`: its folder exists and is writable, and `path` itself is
// not a folder. `flag` is the option that named it, for the message.
absl::Status CheckWritable(absl::string_view flag, const std::string& path);

// Makes the folder, with those above it, unless it is there; whether files can be created in it.
absl::Status MakeOutputFolder(absl::string_view flag, const std::string& path);

}  // namespace lightfit
