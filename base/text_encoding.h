// base/text_encoding.h
//
// Text as other systems write it.
// In:   the bytes of a text file: UTF-8, with or without a byte order mark, or UTF-16.
// Out:  the same text as UTF-8 without a mark.
#pragma once

#include <string>

#include "absl/status/statusor.h"

namespace lightfit {

// A mark of UTF-8 is taken off; UTF-16 of either byte order is converted, by its mark or, without
// one, when each of the first two characters is ASCII. Other bytes stay as they are, UTF-8 or not.
// InvalidArgument for UTF-32, and for UTF-16 that is cut or broken.
absl::StatusOr<std::string> DecodeText(std::string bytes);

}  // namespace lightfit
