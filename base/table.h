// base/table.h
//
// Text in columns, for a terminal.
#pragma once

#include <string>
#include <vector>

namespace lightfit {

// The first column is flush left, the others flush right. Widths count UTF-8 characters.
class Table {
 public:
  // Columns with the same non-empty group, side by side, share a heading above their own, in
  // the middle.
  void AddColumn(const std::string& group, const std::string& name);

  // One cell per column; fewer cells than columns let the last one run on to the right.
  void AddRow(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }

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
