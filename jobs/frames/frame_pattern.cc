#include "jobs/frames/frame_pattern.h"

#include <fnmatch.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "jobs/frames/natural_order.h"
#include "wire/utf8.h"

namespace lightfit {
namespace {

struct Piece {
  enum class Kind { kText, kAny, kOne, kNumber };
  Kind kind = Kind::kText;
  std::string text;             // kText; kOne: "?" or "[...]"
  size_t num_digits = 1;        // kNumber: at least
  bool may_be_between = false;  // kNumber: $FF
};

// Takes the digits at the front.
size_t TakeWidth(absl::string_view* text) {
  size_t end = 0;
  while (end < text->size() && absl::ascii_isdigit((*text)[end])) ++end;
  int width = 1;
  if (end > 0 && !absl::SimpleAtoi(text->substr(0, end), &width)) width = 1;
  text->remove_prefix(end);
  return static_cast<size_t>(std::clamp(width, 1, 12));
}

bool ConsumeIgnoringCase(absl::string_view* text, absl::string_view prefix) {
  if (!absl::StartsWithIgnoreCase(*text, prefix)) return false;
  text->remove_prefix(prefix.size());
  return true;
}

// A mark of a frame number at the front of `text`, which is taken off then.
std::optional<Piece> TakeNumber(absl::string_view* text) {
  Piece piece;
  piece.kind = Piece::Kind::kNumber;
  const char first = text->front();
  if (first == '#' || first == '@') {
    piece.num_digits = 0;
    while (!text->empty() && text->front() == first) {
      text->remove_prefix(1);
      ++piece.num_digits;
    }
    return piece;
  }
  absl::string_view rest = *text;
  const auto done = [&]() -> std::optional<Piece> {
    *text = rest;
    return piece;
  };
  if (absl::ConsumePrefix(&rest, "%")) {
    piece.num_digits = TakeWidth(&rest);
    if (absl::ConsumePrefix(&rest, "d") || absl::ConsumePrefix(&rest, "i")) return done();
  } else if (absl::ConsumePrefix(&rest, "$FF")) {
    piece.may_be_between = true;
    piece.num_digits = TakeWidth(&rest);
    return done();
  } else if (absl::ConsumePrefix(&rest, "$F")) {
    piece.num_digits = TakeWidth(&rest);
    return done();
  } else if (absl::ConsumePrefix(&rest, "${F")) {
    piece.may_be_between = absl::ConsumePrefix(&rest, "F");
    piece.num_digits = TakeWidth(&rest);
    if (absl::ConsumePrefix(&rest, "}")) return done();
  } else if (ConsumeIgnoringCase(&rest, "<UDIM>")) {
    piece.num_digits = 4;
    return done();
  } else if (ConsumeIgnoringCase(&rest, "<frame") || ConsumeIgnoringCase(&rest, "<f")) {
    piece.num_digits = TakeWidth(&rest);
    if (absl::ConsumePrefix(&rest, ">")) return done();
  } else if (ConsumeIgnoringCase(&rest, "{frame")) {
    if (absl::ConsumePrefix(&rest, ":")) {
      piece.num_digits = TakeWidth(&rest);
      absl::ConsumePrefix(&rest, "d");
    }
    if (absl::ConsumePrefix(&rest, "}")) return done();
  }
  return std::nullopt;
}

std::vector<Piece> PiecesOf(absl::string_view pattern) {
  std::vector<Piece> pieces;
  while (!pattern.empty()) {
    if (std::optional<Piece> number = TakeNumber(&pattern)) {
      pieces.push_back(*std::move(number));
      continue;
    }
    const char c = pattern.front();
    size_t length = 1;
    Piece piece;
    if (c == '*') {
      piece.kind = Piece::Kind::kAny;
    } else if (c == '?') {
      piece.kind = Piece::Kind::kOne;
    } else if (const size_t end = pattern.find(']', 2);
               c == '[' && end != absl::string_view::npos) {
      piece.kind = Piece::Kind::kOne;
      length = end + 1;
    }
    piece.text = std::string(pattern.substr(0, length));
    pattern.remove_prefix(length);
    if (piece.kind == Piece::Kind::kText && !pieces.empty() &&
        pieces.back().kind == Piece::Kind::kText) {
      pieces.back().text += piece.text;
    } else {
      pieces.push_back(std::move(piece));
    }
  }
  return pieces;
}

bool HasMarks(absl::string_view pattern) {
  for (const Piece& piece : PiecesOf(pattern)) {
    if (piece.kind != Piece::Kind::kText) return true;
  }
  return false;
}

// Whether digits so written are as the piece wants them.
bool IsNumber(const Piece& piece, absl::string_view text) {
  const std::optional<FrameNumber> number = ParseFrameNumber(text);
  if (!number.has_value()) return false;
  const size_t point = text.find('.');
  if (point != absl::string_view::npos && !piece.may_be_between) return false;
  const absl::string_view whole = text.substr(0, point);
  const absl::string_view digits = absl::StripPrefix(whole, "-");
  if (whole.size() < piece.num_digits) return false;
  return digits.size() <= piece.num_digits || digits.front() != '0' || piece.num_digits == 1;
}

// Whether the pieces from `at` on are the whole name; the number is kept.
bool Matches(const std::vector<Piece>& pieces,
             size_t at,
             absl::string_view name,
             std::optional<FrameNumber>* number) {
  if (at == pieces.size()) return name.empty();
  const Piece& piece = pieces[at];
  switch (piece.kind) {
    case Piece::Kind::kText:
      return absl::StartsWith(name, piece.text) &&
             Matches(pieces, at + 1, name.substr(piece.text.size()), number);
    case Piece::Kind::kOne: {
      if (name.empty()) return false;
      const std::string one(name.substr(0, 1));
      return fnmatch(piece.text.c_str(), one.c_str(), FNM_NOESCAPE) == 0 &&
             Matches(pieces, at + 1, name.substr(1), number);
    }
    case Piece::Kind::kAny:
    case Piece::Kind::kNumber:
      break;
  }
  for (size_t length = name.size() + 1; length-- > 0;) {
    const absl::string_view own = name.substr(0, length);
    if (piece.kind == Piece::Kind::kNumber && !IsNumber(piece, own)) continue;
    if (!Matches(pieces, at + 1, name.substr(length), number)) continue;
    if (piece.kind == Piece::Kind::kNumber && !number->has_value()) *number = ParseFrameNumber(own);
    return true;
  }
  return false;
}

std::vector<std::string> NamesIn(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  std::filesystem::directory_iterator entry(folder.empty() ? "." : folder, error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    names.push_back(entry->path().filename().string());
  }
  std::sort(names.begin(), names.end(), NaturalLess);
  return names;
}

std::string Joined(const std::string& folder, absl::string_view name) {
  return folder.empty() || absl::EndsWith(folder, "/") ? absl::StrCat(folder, name)
                                                       : absl::StrCat(folder, "/", name);
}

absl::Status NothingMatches(const std::string& pattern, const std::string& folder) {
  std::string kind = std::filesystem::path(pattern).extension().string();
  if (kind.empty() || HasMarks(kind)) kind = ".exr";
  std::string there;
  int64_t count = 0;
  for (const std::string& name : NamesIn(folder)) {
    if (name.front() == '.' || !absl::EndsWithIgnoreCase(name, kind)) continue;
    if (count++ == 0) there = name;
  }
  return absl::NotFoundError(
      absl::StrCat(Utf8Text(pattern),
                   ": no file in ",
                   folder.empty() ? "the current folder" : Utf8Text(folder),
                   " matches this pattern; it has ",
                   count == 0 ? "no " : absl::StrCat(count, " "),
                   kind,
                   count == 1 ? " file" : " files",
                   count == 0 ? "" : absl::StrCat(", such as ", Utf8Text(there))));
}

}  // namespace

bool IsFilePattern(const std::string& path) {
  std::error_code error;
  return HasMarks(path) && !std::filesystem::exists(path, error);
}

absl::StatusOr<std::vector<MatchedFile>> FilesMatching(const std::string& pattern) {
  std::vector<MatchedFile> found = {{absl::StartsWith(pattern, "/") ? "/" : "", std::nullopt}};
  std::string searched;  // the last folder with a mark in it or below it
  for (const absl::string_view part : absl::StrSplit(pattern, '/', absl::SkipEmpty())) {
    const std::vector<Piece> pieces = PiecesOf(part);
    const bool is_plain = !HasMarks(part);
    if (!is_plain && !found.empty()) searched = found.front().path;
    std::vector<MatchedFile> next;
    for (const MatchedFile& folder : found) {
      std::error_code error;
      if (is_plain || std::filesystem::exists(Joined(folder.path, part), error)) {
        next.push_back({Joined(folder.path, part), folder.number});
        continue;
      }
      for (const std::string& name : NamesIn(folder.path)) {
        if (name.front() == '.' && part.front() != '.') continue;
        std::optional<FrameNumber> number;
        if (!Matches(pieces, 0, name, &number)) continue;
        next.push_back({Joined(folder.path, name), number.has_value() ? number : folder.number});
      }
    }
    found = std::move(next);
  }
  const auto is_no_file = [](const MatchedFile& file) {
    std::error_code error;
    return !std::filesystem::is_regular_file(file.path, error);
  };
  found.erase(std::remove_if(found.begin(), found.end(), is_no_file), found.end());
  if (found.empty()) return NothingMatches(pattern, searched);
  return found;
}

}  // namespace lightfit
