// base/table.h
//
// Text in columns, for a terminal.
#pragma once

#include <string>
#include <vector>

#include "absl/strings/string_view.h"

namespace lightfit {

// At most so many characters of it: of a longer one the beginning, "...", and the end, in which
// names that a program makes differ. At least 8.
std::string Shortened(absl::string_view text, size_t max_characters);

// The first column is flush left, the others flush right. Widths count UTF-8 characters.
class Table {
 public:
  // Columns with the same non-empty group, side by side, share a heading above their own, in
  // the middle.
  void AddColumn(const std::string& group, const std::string& name);

  // One cell per column; fewer cells than columns let the last one run on to the right. A long name
  // in the first does not push the others out of sight: it is shortened.
  void AddRow(std::vector<std::string> cells);

  // Two lines of headings, then the rows; every line ends in a newline, none in a space.
  std::string Text() const;

 private:
  struct Column {
    std::string group, name;
  };

  std::vector<size_t> Widths() const;
  std::string GroupLine(const std::vector<size_t>& widths) const;

  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace lightfit
