// Text is drawn as it is, whatever it holds, and as wide as it is said to be.

#include "picture/text.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "picture/png.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

const TextStyle kStyle = {.size_px = 16, .color = {1, 1, 1}};

class TypefaceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!typeface_.found()) GTEST_SKIP() << "no typeface on this machine (fonts-dejavu-core)";
  }

  // The text on a page of its own.
  Image Drawn(const std::string& text) const {
    Canvas canvas(400, 40, {});
    typeface_.Draw(10, 25, text, kStyle, &canvas);
    const auto png = PngBytes(canvas);
    EXPECT_TRUE(png.ok()) << png.status();
    return canvas.ToImage();
  }

  const Typeface typeface_ = Typeface::Find();
};

float Sum(const Image& image) {
  float sum = 0;
  for (const Rgb& pixel : image.pixels()) sum += pixel.r;
  return sum;
}

bool IsSame(const Image& a, const Image& b) {
  for (size_t i = 0; i < a.pixels().size(); ++i) {
    if (a.pixels()[i].r != b.pixels()[i].r) return false;
  }
  return true;
}

// One character, also such as are none.
std::string Utf8Of(uint32_t character) {
  if (character < 0x80) return std::string(1, static_cast<char>(character));
  const int num_more = character < 0x800 ? 1 : character < 0x10000 ? 2 : 3;
  // The first byte begins with as many ones as there are bytes.
  std::string utf8(1, static_cast<char>(0xff00 >> (num_more + 1) | character >> 6 * num_more));
  for (int i = num_more - 1; i >= 0; --i) {
    utf8.push_back(static_cast<char>(0x80 | (character >> 6 * i & 0x3f)));
  }
  return utf8;
}

TEST_F(TypefaceTest, DrawsWhatItMeasures) {
  const int width = typeface_.Width("read-back", kStyle);
  EXPECT_GT(width, 50);
  EXPECT_LT(width, 120);
  const Image image = Drawn("read-back");
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      if (image.At(x, y).r > 0.1f) {
        ASSERT_GE(x, 9);
        ASSERT_LE(x, 11 + width);
      }
    }
  }
  EXPECT_GT(Sum(image), 100);
}

TEST_F(TypefaceTest, ShortensWhatHasNoRoomAndNothingElse) {
  const std::string text = "a_scene_with_quite_a_long_name_für_alle_\xe2\x98\x83s_of_winter.glb";
  const int width = typeface_.Width(text, kStyle);
  EXPECT_EQ(typeface_.Fitted(text, width, kStyle), text);
  std::string last;
  for (int room = 80; room < width; room += 7) {
    const std::string fitted = typeface_.Fitted(text, room, kStyle);
    EXPECT_LE(typeface_.Width(fitted, kStyle), room) << fitted;
    // One letter more, of some 20 pixels at most, would have no room.
    EXPECT_GT(typeface_.Width(fitted, kStyle), room - 20) << fitted;
    EXPECT_EQ(fitted.front(), 'a');
    EXPECT_EQ(fitted.back(), 'b');
    EXPECT_GE(fitted.size(), last.size());
    last = fitted;
  }
  EXPECT_EQ(typeface_.Fitted(text, 0, kStyle), "a....glb");
}

TEST_F(TypefaceTest, EveryScriptHasItsOwnLetters) {
  const std::vector<std::string> names = {
      "Schlüssel", "Schlussel", "Свет", "Φως", "Ljósið", "Ánh sáng", "אור", "ضوء", "света"};
  for (size_t i = 0; i < names.size(); ++i) {
    EXPECT_GT(Sum(Drawn(names[i])), 30) << names[i];
    for (size_t j = 0; j < i; ++j) EXPECT_FALSE(IsSame(Drawn(names[i]), Drawn(names[j]))) << i << j;
  }
  // One character is one character wide, not one for each byte.
  EXPECT_EQ(typeface_.Width("ü", kStyle), typeface_.Width("u", kStyle));
}

TEST_F(TypefaceTest, ACombiningMarkIsDrawnOverItsLetter) {
  EXPECT_EQ(typeface_.Width("e\u0301clair", kStyle), typeface_.Width("eclair", kStyle));
  EXPECT_GT(Sum(Drawn("e\u0301clair")), Sum(Drawn("eclair")));
}

TEST_F(TypefaceTest, CharactersThatItLacksAreBoxes) {
  EXPECT_GT(Sum(Drawn("主光")), 10);
  EXPECT_GT(typeface_.Width("主光", kStyle), typeface_.Width("主", kStyle));
  EXPECT_GT(Sum(Drawn("\U0001f4a1")), 5);
}

TEST_F(TypefaceTest, WhatIsNoTextIsAQuestionMark) {
  using std::string_literals::operator""s;
  // Not UTF-8; surrogates; no characters; controls.
  for (const std::string& bad : {"\xff"s,
                                 "\xfc"s,
                                 "\x80"s,
                                 "\uffff"s,
                                 "\ufdd0"s,
                                 "\ufdef"s,
                                 "\U0001fffe"s,
                                 "\U0010ffff"s,
                                 "\n"s,
                                 "\0"s,
                                 "\x7f"s}) {
    EXPECT_TRUE(IsSame(Drawn("a" + bad + "b"), Drawn("a?b"))) << testing::PrintToString(bad);
  }
  EXPECT_GT(Sum(Drawn("\xed\xa0\x80")), 0);
  EXPECT_GT(Sum(Drawn("\xe2\x82")), 0);
}

TEST_F(TypefaceTest, EveryCharacterAndAnyBytesLeaveThePageWhole) {
  Canvas canvas(400, 40, {});
  for (uint32_t character = 1; character < 0x110000; character += character < 0x3000 ? 1 : 7) {
    const std::string utf8 = Utf8Of(character);
    typeface_.Draw(10, 25, utf8, kStyle, &canvas);
  }
  std::mt19937 random(3);
  for (int i = 0; i < 5000; ++i) {
    std::string bytes(random() % 12, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    typeface_.Draw(10, 25, bytes, kStyle, &canvas);
    EXPECT_GE(typeface_.Width(bytes, kStyle), 0);
  }
  const auto png = PngBytes(canvas);
  EXPECT_TRUE(png.ok()) << png.status();
  EXPECT_GT(typeface_.Width("still", kStyle), 0);
}

// Whatever the user's fontconfig says: a machine without one draws the same.
TEST_F(TypefaceTest, NeedsNoFontconfig) {
  const Image before = Drawn("Schlüssel");
  setenv("FONTCONFIG_FILE", "/nowhere", 1);  // NOLINT(concurrency-mt-unsafe)
  const Typeface again = Typeface::Find();
  unsetenv("FONTCONFIG_FILE");  // NOLINT(concurrency-mt-unsafe)
  Canvas canvas(400, 40, {});
  again.Draw(10, 25, "Schlüssel", kStyle, &canvas);
  EXPECT_TRUE(IsSame(canvas.ToImage(), before));
}

TEST_F(TypefaceTest, PassesOverAFileThatIsNoFont) {
  const TemporaryFolder folder;
  WriteFile(folder.Path("a.ttf"), "not a font");
  setenv("LIGHTFIT_FONT", folder.Path("a.ttf").c_str(), 1);  // NOLINT(concurrency-mt-unsafe)
  const Typeface typeface = Typeface::Find();
  unsetenv("LIGHTFIT_FONT");  // NOLINT(concurrency-mt-unsafe)
  ASSERT_TRUE(typeface.found());
  EXPECT_EQ(typeface.Width("sun", kStyle), typeface_.Width("sun", kStyle));
}

TEST(Typeface, WithoutOneThereIsNoText) {
  Canvas canvas(100, 40, {});
  Typeface().Draw(10, 25, "sun", kStyle, &canvas);
  EXPECT_EQ(Sum(canvas.ToImage()), 0);
  EXPECT_EQ(Typeface().Width("sun", kStyle), 0);
}

}  // namespace
}  // namespace lightfit
