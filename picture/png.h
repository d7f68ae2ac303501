// picture/png.h
//
// A page as a PNG file, 8 bits per channel.
// In:   a Canvas, whose every pixel counts: the same pixels give the same bytes.
// Out:  bytes, or a file that is seen whole or not at all.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "picture/canvas.h"

namespace lightfit {

// Fails where Cairo could not hold the page: more than kMaxCanvasSide pixels along a side, or no
// memory.
absl::StatusOr<std::string> PngBytes(const Canvas& canvas);

// Replaces `path` in one step, see WriteTextFileAtomically(): on failure, such as a full disk, the
// old file stays.
absl::Status WritePng(const Canvas& canvas, const std::string& path);

}  // namespace lightfit
