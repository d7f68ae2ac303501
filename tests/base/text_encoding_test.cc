#include "base/text_encoding.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "base/text_file.h"
#include "tests/io/testing.h"

namespace lightfit {
namespace {

using testing::HasAll;

std::string Utf16(const std::u16string& text, bool is_big) {
  std::string bytes;
  for (const char16_t unit : text) {
    const char high = static_cast<char>(unit >> 8), low = static_cast<char>(unit & 0xFF);
    bytes.push_back(is_big ? high : low);
    bytes.push_back(is_big ? low : high);
  }
  return bytes;
}

TEST(TextEncoding, MarksOfUtf8AreTakenOffOnceAndOtherBytesStay) {
  EXPECT_EQ(DecodeText("\xEF\xBB\xBF{}").value(), "{}");
  EXPECT_EQ(DecodeText("\xEF\xBB\xBF").value(), "");
  EXPECT_EQ(DecodeText("\xEF\xBB\xBF\xEF\xBB\xBF{}").value(), "\xEF\xBB\xBF{}");
  for (const std::string text : {"", "{", "\xEF\xBB", "\xFF", "key \xC3\xA4", "a\xEF\xBB\xBF"}) {
    EXPECT_EQ(DecodeText(text).value(), text);
  }
  const std::string with_nul("a\0b\nc", 5);
  EXPECT_EQ(DecodeText(with_nul).value(), with_nul);
}

TEST(TextEncoding, Utf16IsReadInBothOrdersWithAndWithoutItsMark) {
  const std::u16string wide = u"{\"a\u00E4\u20AC\u7FFF\U0001F4A1\U0010FFFF\": 1}\r\n";
  const std::string narrow = "{\"a\u00E4\u20AC\u7FFF\U0001F4A1\U0010FFFF\": 1}\r\n";
  for (const bool is_big : {false, true}) {
    EXPECT_EQ(DecodeText(Utf16(u"\uFEFF" + wide, is_big)).value(), narrow) << is_big;
    EXPECT_EQ(DecodeText(Utf16(wide, is_big)).value(), narrow) << is_big;
    EXPECT_EQ(DecodeText(Utf16(u"\uFEFF", is_big)).value(), "");
  }
}

TEST(TextEncoding, EveryCharacterOfTheBasicPlaneComesBackFromUtf16) {
  // All of the basic plane but surrogates, decoded again by the definition of UTF-8.
  for (uint32_t code = 1; code < 0x10000; ++code) {
    if (code >= 0xD800 && code < 0xE000) continue;
    const auto decoded = DecodeText(Utf16({0xFEFF, static_cast<char16_t>(code)}, false));
    ASSERT_TRUE(decoded.ok());
    const auto* bytes = reinterpret_cast<const unsigned char*>(decoded->data());
    uint32_t back = bytes[0];
    if (decoded->size() == 2) back = (bytes[0] & 0x1F) << 6 | (bytes[1] & 0x3F);
    if (decoded->size() == 3) {
      back = (bytes[0] & 0x0F) << 12 | (bytes[1] & 0x3F) << 6 | (bytes[2] & 0x3F);
    }
    ASSERT_EQ(back, code);
    ASSERT_EQ(decoded->size(), code < 0x80 ? 1u : code < 0x800 ? 2u : 3u);
  }
}

TEST(TextEncoding, WhatCannotBeReadIsNamedAsWhatItIs) {
  const std::string utf32("\xFF\xFE\0\0{\0\0\0", 8);
  EXPECT_TRUE(HasAll(DecodeText(utf32).status().message(), {"UTF-32", "want UTF-8"}));
  const std::string utf32_big("\0\0\xFE\xFF\0\0\0{", 8);
  EXPECT_TRUE(HasAll(DecodeText(utf32_big).status().message(), {"UTF-32"}));
  EXPECT_TRUE(HasAll(DecodeText("\xFF\xFE{").status().message(), {"UTF-16 of 1 bytes", "UTF-8"}));
  for (const std::u16string& broken :
       {std::u16string{0xFEFF, 0xD800}, {0xFEFF, 0xDC00, 'a'}, {0xFEFF, 0xD800, 'a'}}) {
    for (const bool is_big : {false, true}) {
      EXPECT_TRUE(HasAll(DecodeText(Utf16(broken, is_big)).status().message(),
                         {"half a character at byte 0"}));
    }
  }
}

TEST(TextEncoding, TextFilesAreDecodedAndBytesAreNot) {
  const testing::TemporaryFolder folder;
  const std::string marked = folder.Write("marked.json", "\xEF\xBB\xBF{}");
  EXPECT_EQ(ReadTextFile(marked).value(), "{}");
  EXPECT_EQ(ReadFileBytes(marked).value(), "\xEF\xBB\xBF{}");
  EXPECT_EQ(ReadTextFile(folder.Write("wide.json", Utf16(u"\uFEFF{}", false))).value(), "{}");
  const std::string cut = folder.Write("cut.json", "\xFF\xFE{");
  EXPECT_TRUE(HasAll(ReadTextFile(cut).status().message(), {cut, "UTF-16 of 1 bytes"}));
}

}  // namespace
}  // namespace lightfit
