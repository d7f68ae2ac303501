#include "calls/message_text.h"

#include <google/protobuf/stubs/common.h>

#include "absl/strings/str_cat.h"

namespace lightfit {

std::string Utf8Text(absl::string_view bytes) {
  std::string buffer(bytes);
  const char* text = google::protobuf::internal::UTF8CoerceToStructurallyValid(
      {bytes.data(), bytes.size()}, buffer.data(), '?');
  return std::string(text, bytes.size());  // the buffer, or `bytes` when nothing is wrong
}

std::string Quoted(absl::string_view name) {
  constexpr size_t kMaxBytes = 64;
  if (name.size() <= kMaxBytes) return absl::StrCat("\"", Utf8Text(name), "\"");
  return absl::StrCat("\"", Utf8Text(name.substr(0, kMaxBytes)), "...\"");
}

void MakeMessagesUtf8(google::protobuf::RepeatedPtrField<v1::LightResult>* lights) {
  for (v1::LightResult& light : *lights) {
    std::string* message = light.mutable_status()->mutable_message();
    *message = Utf8Text(*message);
  }
}

}  // namespace lightfit
