#include "calls/message_text.h"

#include "absl/strings/str_cat.h"
#include "wire/utf8.h"

namespace lightfit {

std::string Quoted(absl::string_view name) {
  constexpr size_t kMaxBytes = 64;
  if (name.size() <= kMaxBytes) return absl::StrCat("\"", Utf8Text(name), "\"");
  return absl::StrCat("\"", Utf8Text(name.substr(0, kMaxBytes)), "...\"");
}

}  // namespace lightfit
