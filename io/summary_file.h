// io/summary_file.h
//
// Summary files: what a farm's jobs hand on. About a kilobyte for each light, and 20 bytes for
// each frame, which say which it is.
// In:   SummarySet.
// Out:  a file, the same bytes for the same frames in whatever order and grouping they were added.
//
// Layout, integers little-endian:
//    0  8 bytes  89 4C 46 53 0D 0A 1A 0A   (\x89 L F S, and line ends that text transfers would
//    harm) 8  uint32   version of the format: 1
//   12  uint32   bytes of the payload, to the end of the file
//   16  uint32   CRC-32 of the payload, as zlib's
//   20  payload  lightfit.v1.SummaryFile
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "wire/summary_set.h"

namespace lightfit {

inline constexpr int kSummaryFormatVersion = 1;

// Replaces `path` in one step. `writer` is the program and its version, for messages.
// InvalidArgument when the set could not be read again (sums that are not finite).
absl::Status WriteSummaryFile(const std::string& path,
                              const SummarySet& set,
                              absl::string_view writer);

// Takes nothing on trust: a file that was cut or damaged, that has another version, fields that
// this version does not know, or values that no summary has, is InvalidArgument with the reason.
absl::StatusOr<SummarySet> ReadSummaryFile(const std::string& path);

// The same on the bytes of a file.
absl::StatusOr<std::string> SerializeSummarySet(const SummarySet& set, absl::string_view writer);
absl::StatusOr<SummarySet> ParseSummarySet(absl::string_view bytes);

// Whether the file says that it is one by its first bytes, or by ".summary" at the end of its name.
bool IsSummaryFile(const std::string& path);

// What one light takes in the file, bytes.
int64_t SummaryBytes(const LightSummary& light);

}  // namespace lightfit
