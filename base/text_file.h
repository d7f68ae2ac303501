// base/text_file.h
//
// Whole text files, read with a limit and written in one step.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace lightfit {

// No file of lights, cameras or results comes near this. Bytes.
inline constexpr int64_t kMaxTextFileBytes = int64_t{64} << 20;

// As UTF-8 without a byte order mark: see base/text_encoding.h.
absl::StatusOr<std::string> ReadTextFile(const std::string& path,
                                         int64_t max_bytes = kMaxTextFileBytes);

// As it is, text or not.
absl::StatusOr<std::string> ReadFileBytes(const std::string& path,
                                          int64_t max_bytes = kMaxTextFileBytes);

// Replaces `path` in one step: a reader sees the old file or the new one, whole. On failure the old
// file stays and no temporary file is left.
absl::Status WriteTextFileAtomically(const std::string& path, absl::string_view text);

// `status` with "path: " before its message.
absl::Status InFile(const std::string& path, const absl::Status& status);

}  // namespace lightfit
