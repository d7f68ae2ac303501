#include "base/table.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"

namespace lightfit {
namespace {

constexpr size_t kGap = 2;
constexpr size_t kGroupGap = 4;
constexpr size_t kMaxNameCharacters = 40;

// Characters of UTF-8 text: all bytes but the continuation bytes 10xxxxxx.
bool BeginsCharacter(char byte) { return (byte & 0xc0) != 0x80; }

size_t Length(absl::string_view text) {
  return std::count_if(text.begin(), text.end(), &BeginsCharacter);
}

std::string Spaces(size_t wanted, size_t have) {
  return std::string(wanted > have ? wanted - have : 0, ' ');
}

std::string Line(std::string text) {
  absl::StripTrailingAsciiWhitespace(&text);
  return absl::StrCat(text, "\n");
}

}  // namespace

std::string Shortened(absl::string_view text, size_t max_characters) {
  constexpr char kGone[] = "...";
  const size_t length = Length(text);
  if (length <= max_characters) return std::string(text);
  const size_t kept = std::max<size_t>(max_characters, 8) - std::strlen(kGone);
  const size_t at_begin = kept / 3, at_end = kept - at_begin;
  std::string shortened;
  size_t character = 0;
  for (const char byte : text) {
    character += BeginsCharacter(byte) ? 1 : 0;
    if (character == at_begin + 1 && BeginsCharacter(byte)) shortened += kGone;
    if (character <= at_begin || character > length - at_end) shortened += byte;
  }
  return shortened;
}

void Table::AddRow(std::vector<std::string> cells) {
  if (cells.size() > 1) cells.front() = Shortened(cells.front(), kMaxNameCharacters);
  rows_.push_back(std::move(cells));
}

void Table::AddColumn(const std::string& group, const std::string& name) {
  columns_.push_back({group, name});
}

// Including the gap to the left.
std::vector<size_t> Table::Widths() const {
  std::vector<size_t> widths;
  for (size_t i = 0; i < columns_.size(); ++i) {
    size_t width = Length(columns_[i].name);
    for (const std::vector<std::string>& row : rows_) {
      const bool runs_on = i + 1 == row.size() && row.size() < columns_.size();
      if (i < row.size() && !runs_on) width = std::max(width, Length(row[i]));
    }
    const bool starts_group = i > 0 && columns_[i].group != columns_[i - 1].group;
    widths.push_back(i == 0 ? width : width + (starts_group ? kGroupGap : kGap));
  }
  // A group's heading may be wider than its columns: the first of them makes room.
  for (size_t first = 0; first < columns_.size();) {
    size_t end = first, width = 0;
    while (end < columns_.size() && columns_[end].group == columns_[first].group) {
      width += widths[end++];
    }
    const size_t wanted = Length(columns_[first].group) + (first == 0 ? 0 : kGroupGap);
    if (width < wanted) widths[first] += wanted - width;
    first = end;
  }
  return widths;
}

std::string Table::GroupLine(const std::vector<size_t>& widths) const {
  std::string line;
  for (size_t first = 0; first < columns_.size();) {
    size_t end = first, width = 0;
    while (end < columns_.size() && columns_[end].group == columns_[first].group) {
      width += widths[end++];
    }
    const std::string& group = columns_[first].group;
    const size_t gap = first == 0 ? 0 : kGroupGap;
    const size_t after = (width - gap - Length(group)) / 2;
    absl::StrAppend(&line, Spaces(width - after, Length(group)), group, Spaces(after, 0));
    first = end;
  }
  return line;
}

std::string Table::Text() const {
  const std::vector<size_t> widths = Widths();
  std::string text = Line(GroupLine(widths));
  std::vector<std::string> names;
  for (const Column& column : columns_) names.push_back(column.name);
  const auto append_row = [&](const std::vector<std::string>& row) {
    std::string line;
    for (size_t i = 0; i < row.size(); ++i) {
      const bool runs_on = i + 1 == row.size() && row.size() < columns_.size();
      if (i == 0) {
        absl::StrAppend(&line, row[i], Spaces(widths[i], Length(row[i])));
      } else if (runs_on) {
        absl::StrAppend(&line, "    ", row[i]);
      } else {
        absl::StrAppend(&line, Spaces(widths[i], Length(row[i])), row[i]);
      }
    }
    text += Line(line);
  };
  append_row(names);
  for (const std::vector<std::string>& row : rows_) append_row(row);
  return text;
}

}  // namespace lightfit
