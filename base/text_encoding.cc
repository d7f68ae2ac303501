#include "base/text_encoding.h"

#include <cstddef>
#include <cstdint>

#include "absl/strings/match.h"
#include "absl/strings/str_format.h"
#include "absl/strings/string_view.h"

namespace lightfit {

namespace {

constexpr absl::string_view kUtf8Mark("\xEF\xBB\xBF", 3);
constexpr absl::string_view kUtf16LittleMark("\xFF\xFE", 2);
constexpr absl::string_view kUtf16BigMark("\xFE\xFF", 2);
constexpr absl::string_view kUtf32LittleMark("\xFF\xFE\0\0", 4);
constexpr absl::string_view kUtf32BigMark("\0\0\xFE\xFF", 4);

void AppendUtf8(uint32_t code, std::string* text) {
  const auto append = [text](uint32_t byte) { text->push_back(static_cast<char>(byte)); };
  if (code < 0x80) return append(code);
  if (code < 0x800) {
    append(0xC0 | code >> 6);
  } else if (code < 0x10000) {
    append(0xE0 | code >> 12);
    append(0x80 | (code >> 6 & 0x3F));
  } else {
    append(0xF0 | code >> 18);
    append(0x80 | (code >> 12 & 0x3F));
    append(0x80 | (code >> 6 & 0x3F));
  }
  append(0x80 | (code & 0x3F));
}

absl::StatusOr<std::string> Utf8FromUtf16(absl::string_view bytes, bool is_big) {
  if (bytes.size() % 2 != 0) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "is UTF-16 of %d bytes, want an even number; is the file cut? Save it as UTF-8",
        bytes.size()));
  }
  const auto unit = [bytes, is_big](size_t i) {
    const auto first = static_cast<unsigned char>(bytes[i]);
    const auto second = static_cast<unsigned char>(bytes[i + 1]);
    return static_cast<uint32_t>(is_big ? first << 8 | second : second << 8 | first);
  };
  std::string text;
  text.reserve(bytes.size() / 2);
  for (size_t i = 0; i < bytes.size(); i += 2) {
    uint32_t code = unit(i);
    if (code >= 0xD800 && code < 0xE000) {
      const uint32_t low = code < 0xDC00 && i + 2 < bytes.size() ? unit(i + 2) : 0;
      if (low < 0xDC00 || low >= 0xE000) {
        return absl::InvalidArgumentError(
            absl::StrFormat("is UTF-16 with half a character at byte %d; save it as UTF-8", i));
      }
      code = 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00);
      i += 2;
    }
    AppendUtf8(code, &text);
  }
  return text;
}

bool IsAscii(char c) { return c > 0; }

}  // namespace

absl::StatusOr<std::string> DecodeText(std::string bytes) {
  const absl::string_view view(bytes);
  if (absl::StartsWith(view, kUtf32LittleMark) || absl::StartsWith(view, kUtf32BigMark)) {
    return absl::InvalidArgumentError("is UTF-32, want UTF-8");
  }
  if (absl::StartsWith(view, kUtf8Mark)) {
    bytes.erase(0, kUtf8Mark.size());
    return bytes;
  }
  if (absl::StartsWith(view, kUtf16LittleMark)) return Utf8FromUtf16(view.substr(2), false);
  if (absl::StartsWith(view, kUtf16BigMark)) return Utf8FromUtf16(view.substr(2), true);
  if (view.size() >= 4) {
    if (IsAscii(view[0]) && view[1] == 0 && IsAscii(view[2]) && view[3] == 0) {
      return Utf8FromUtf16(view, false);
    }
    if (view[0] == 0 && IsAscii(view[1]) && view[2] == 0 && IsAscii(view[3])) {
      return Utf8FromUtf16(view, true);
    }
  }
  return bytes;
}

}  // namespace lightfit
