// Numbers, columns and suggestions: what people read in the terminal.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "base/number.h"
#include "base/suggest.h"
#include "base/table.h"

namespace lightfit {
namespace {

TEST(FigureText, HasThreeSignificantDigits) {
  EXPECT_EQ(FigureText(0), "0");
  EXPECT_EQ(FigureText(0.053219), "0.0532");
  EXPECT_EQ(FigureText(0.9996), "1.00");
  EXPECT_EQ(FigureText(1.5), "1.50");
  EXPECT_EQ(FigureText(47.13), "47.1");
  EXPECT_EQ(FigureText(1234.4), "1234");
  EXPECT_EQ(FigureText(23456789), "2.35e+07");
  EXPECT_EQ(FigureText(1e-9), "1.00e-09");
  EXPECT_EQ(FigureText(-2.345), "-2.35");
  EXPECT_EQ(FigureText(std::numeric_limits<double>::infinity()), "inf");
}

TEST(Table, AlignsColumnsUnderTheirGroups) {
  Table table;
  table.AddColumn("", "light");
  table.AddColumn("energy", "before");
  table.AddColumn("energy", "after");
  table.AddColumn("time", "ms");
  table.AddRow({"sun", "123.4", "1", "2"});
  table.AddRow({"a long name", "no matrix, see below"});
  EXPECT_EQ(table.Text(),
            "                   energy       time\n"
            "light          before  after      ms\n"
            "sun             123.4      1       2\n"
            "a long name    no matrix, see below\n");
}

TEST(Shortened, KeepsBothEndsOfALongName) {
  EXPECT_EQ(Shortened("key", 12), "key");
  EXPECT_EQ(Shortened("twelve chars", 12), "twelve chars");
  EXPECT_EQ(Shortened("collection|street|lamp.001", 12), "col...mp.001");
  EXPECT_EQ(Shortened("Lämpchen über der Tür ÄÖÜ", 12), "Läm...ür ÄÖÜ");
}

TEST(Table, ShortensLongNamesInRowsOfFigures) {
  Table table;
  table.AddColumn("", "light");
  table.AddColumn("", "n");
  const std::string name = std::string(30, 'a') + std::string(30, 'b');
  table.AddRow({name, "1"});
  table.AddRow({"sun", "2"});
  const std::string shortened = std::string(12, 'a') + "..." + std::string(25, 'b');
  EXPECT_EQ(table.Text(),
            "\nlight" + std::string(35, ' ') + "  n\n" + shortened + "  1\nsun" +
                std::string(37, ' ') + "  2\n");
}

TEST(Table, CountsCharactersNotBytes) {
  Table table;
  table.AddColumn("", "name");
  table.AddColumn("", "n");
  table.AddRow({"Ö", "1"});
  table.AddRow({"ab", "22"});
  EXPECT_EQ(table.Text(), "\nname   n\nÖ      1\nab    22\n");
}

TEST(DidYouMean, OffersOnlyCloseWords) {
  const std::vector<std::string> choices = {"sun", "key", "rim"};
  EXPECT_EQ(DidYouMean("Sun", choices), "; did you mean \"sun\"?");
  EXPECT_EQ(DidYouMean("kay", choices), "; did you mean \"key\"?");
  EXPECT_EQ(DidYouMean("lantern", choices), "");
  EXPECT_EQ(DidYouMean("sun", {}), "");
  EXPECT_EQ(DidYouMean("fti", {"fit", "shot"}), "; did you mean \"fit\"?");
  EXPECT_EQ(DidYouMean("depth", {"depth-kind", "depth-channel", "map"}),
            "; did you mean \"depth-kind\" or \"depth-channel\"?");
  EXPECT_EQ(DidYouMean("near-clip", {"x"}), "");
}

}  // namespace
}  // namespace lightfit
