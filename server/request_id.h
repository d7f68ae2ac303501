// server/request_id.h
//
// The name under which a call stands in the log.
// In:   the client's metadata x-request-id, if any.
// Out:  that, or a random name.
#pragma once

#include <string>

#include "absl/strings/string_view.h"

namespace lightfit {

// The metadata in which clients send a name, and the server returns the one it used.
inline constexpr char kRequestIdKey[] = "x-request-id";

inline constexpr size_t kMaxRequestIdBytes = 128;

// `from_client` where it is 1 to 128 printable ASCII characters; else (empty, too long, bytes that
// a terminal would obey) 16 random hexadecimal digits. Any thread may call this.
std::string RequestId(absl::string_view from_client);

}  // namespace lightfit
