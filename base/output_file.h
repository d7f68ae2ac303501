// base/output_file.h
//
// Files that a verb writes: checked before the long work, seen only when complete.
#pragma once

#include <functional>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace lightfit {

// Whether a file can be created at `path`: its folder exists and is writable, and `path` itself is
// not a folder. `flag` is the option that named it, for the message.
absl::Status CheckWritable(absl::string_view flag, const std::string& path);

// Calls `write` with a temporary name beside `path` and renames the result to `path`. On failure
// the temporary file is removed and whatever was at `path` stays as it was.
absl::Status WriteThroughTemporary(const std::string& path,
                                   const std::function<absl::Status(const std::string&)>& write);

}  // namespace lightfit
