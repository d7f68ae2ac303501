// wire/utf8.h
//
// Words from outside that go into messages.
// In:   bytes of any kind: names in files, what libraries quote of them.
// Out:  UTF-8, as strings of the schema must be.
#pragma once

#include <string>

#include "absl/strings/string_view.h"

namespace lightfit {

// Bytes that are not UTF-8 become '?'.
std::string Utf8Text(absl::string_view bytes);

}  // namespace lightfit
