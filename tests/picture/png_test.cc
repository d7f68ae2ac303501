// Pages as bytes and as files.

#include "picture/png.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "picture/text.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

Canvas Page() {
  Canvas canvas(300, 80, HexColor(0x15181d));
  canvas.DrawLine({3.5, 70}, {290.25, 11}, 1.7, HexColor(0x7fd6a0), 0.7f);
  canvas.DrawDot({150, 40}, 9, HexColor(0xff4d2e));
  Typeface::Find().Draw(10, 40, "Schlüssellicht 主光", {.color = {1, 1, 1}}, &canvas);
  return canvas;
}

TEST(Png, TheSamePageGivesTheSameBytes) {
  const auto first = PngBytes(Page()), second = PngBytes(Page());
  ASSERT_TRUE(first.ok()) << first.status();
  EXPECT_THAT(*first, StartsWith("\x89PNG\r\n\x1a\n"));
  EXPECT_TRUE(*first == *second);
}

TEST(Png, ReplacesTheOldFile) {
  const TemporaryFolder folder;
  WriteFile(folder.Path("a.png"), "old");
  ASSERT_TRUE(WritePng(Page(), folder.Path("a.png")).ok());
  EXPECT_EQ(ReadFile(folder.Path("a.png")), *PngBytes(Page()));
  EXPECT_THAT(folder.Files(), ElementsAre("a.png"));
}

TEST(Png, SaysWhyAPageCannotBeWritten) {
  const TemporaryFolder folder;
  const std::string path = folder.Path("a.png");
  const absl::Status too_long = WritePng(Canvas(kMaxCanvasSide + 1, 1, {}), path);
  EXPECT_THAT(std::string(too_long.message()),
              AllOf(StartsWith(path), HasSubstr("32768 x 1 pixels"), HasSubstr("at most 32767")));
  EXPECT_THAT(std::string(WritePng(Page(), folder.Path("no/a.png")).message()),
              AllOf(HasSubstr("no/a.png"), HasSubstr("No such file")));
  EXPECT_THAT(folder.Files(), ElementsAre());
}

}  // namespace
}  // namespace lightfit
