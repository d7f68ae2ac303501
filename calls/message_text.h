// calls/message_text.h
//
// Words of messages that quote what came from outside.
// In:   bytes of any kind and length: names of lights.
// Out:  UTF-8, short enough for a status.
#pragma once

#include <string>

#include "absl/strings/string_view.h"

namespace lightfit {

// Utf8Text() in quotes, and without what goes beyond 64 bytes.
std::string Quoted(absl::string_view name);

}  // namespace lightfit
