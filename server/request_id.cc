#include "server/request_id.h"

#include <algorithm>
#include <random>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"

namespace lightfit {

std::string RequestId(absl::string_view from_client) {
  const bool is_usable = !from_client.empty() && from_client.size() <= kMaxRequestIdBytes &&
                         std::all_of(from_client.begin(), from_client.end(), [](unsigned char c) {
                           return absl::ascii_isprint(c);
                         });
  if (is_usable) return std::string(from_client);
  thread_local std::random_device random;  // two draws of 32 bits
  return absl::StrCat(absl::Hex(random(), absl::kZeroPad8), absl::Hex(random(), absl::kZeroPad8));
}

}  // namespace lightfit
