#include "wire/utf8.h"

#include <google/protobuf/stubs/common.h>

namespace lightfit {

std::string Utf8Text(absl::string_view bytes) {
  std::string buffer(bytes);
  const char* text = google::protobuf::internal::UTF8CoerceToStructurallyValid(
      {bytes.data(), bytes.size()}, buffer.data(), '?');
  return std::string(text, bytes.size());  // the buffer, or `bytes` when nothing is wrong
}

}  // namespace lightfit
