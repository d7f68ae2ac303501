#include "jobs/shot/frames.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <system_error>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "base/text_file.h"

namespace lightfit {
namespace {

bool IsExr(const std::filesystem::path& path) {
  return absl::AsciiStrToLower(path.extension().string()) == ".exr";
}

// Takes the digits at the front of `text`, without leading zeros.
absl::string_view TakeDigits(absl::string_view* text) {
  size_t end = 0;
  while (end < text->size() && absl::ascii_isdigit((*text)[end])) ++end;
  absl::string_view digits = text->substr(0, end);
  text->remove_prefix(end);
  while (digits.size() > 1 && digits.front() == '0') digits.remove_prefix(1);
  return digits;
}

absl::StatusOr<std::vector<std::string>> FilesOfFolder(const std::string& folder) {
  std::error_code error;
  std::filesystem::directory_iterator entry(folder, error);
  std::vector<std::string> paths;
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    if (IsExr(entry->path())) paths.push_back(entry->path().string());
  }
  if (error) {
    return absl::InvalidArgumentError(
        absl::StrCat(folder, ": the folder cannot be read: ", error.message()));
  }
  if (paths.empty()) {
    return absl::NotFoundError(absl::StrCat(
        folder, ": there is no .exr file in this folder, want the read-backs of a shot"));
  }
  std::sort(paths.begin(), paths.end(), NaturalLess);
  return paths;
}

absl::StatusOr<std::vector<std::string>> FilesOfList(const std::string& list) {
  const absl::StatusOr<std::string> text = ReadTextFile(list);
  if (!text.ok()) return text.status();
  const std::filesystem::path folder = std::filesystem::path(list).parent_path();
  std::vector<std::string> paths;
  for (absl::string_view line : absl::StrSplit(*text, '\n')) {
    line = absl::StripAsciiWhitespace(line);
    if (line.empty() || line.front() == '#') continue;
    const std::filesystem::path path{std::string(line)};
    if (!IsExr(path)) {
      return absl::InvalidArgumentError(absl::StrCat(
          list, ": \"", line.substr(0, 100), "\": want the path of one .exr file per line"));
    }
    paths.push_back((folder / path).string());
  }
  if (paths.empty()) {
    return absl::NotFoundError(
        absl::StrCat(list, ": the list is empty, want the path of one .exr file per line"));
  }
  return paths;
}

// The last component, also of "shots/walk/".
std::string LastName(const std::string& path) {
  std::error_code error;
  std::filesystem::path whole = std::filesystem::absolute(path, error).lexically_normal();
  if (!whole.has_filename()) whole = whole.parent_path();
  return whole.filename().string();
}

// The digits that a name ends in; -1 without any.
int64_t TrailingNumber(const std::string& name) {
  size_t begin = name.size();
  while (begin > 0 && absl::ascii_isdigit(name[begin - 1])) --begin;
  int64_t number = -1;
  return absl::SimpleAtoi(name.substr(begin), &number) ? number : -1;
}

std::vector<ShotFrame> NamedFrames(std::vector<std::string> paths) {
  std::vector<ShotFrame> frames;
  std::set<std::string> names;
  bool numbers_rise = true;
  for (std::string& path : paths) {
    ShotFrame frame;
    frame.name = std::filesystem::path(path).stem().string();
    frame.path = std::move(path);
    frame.number = TrailingNumber(frame.name);
    names.insert(frame.name);
    numbers_rise &= frame.number > (frames.empty() ? -1 : frames.back().number);
    frames.push_back(std::move(frame));
  }
  for (size_t i = 0; i < frames.size(); ++i) {
    if (names.size() < frames.size()) frames[i].name = absl::StrFormat("%04d", i + 1);
    if (!numbers_rise) frames[i].number = static_cast<int64_t>(i) + 1;
  }
  return frames;
}

}  // namespace

bool NaturalLess(absl::string_view a, absl::string_view b) {
  const absl::string_view whole_a = a, whole_b = b;
  while (!a.empty() && !b.empty()) {
    if (absl::ascii_isdigit(a.front()) && absl::ascii_isdigit(b.front())) {
      const absl::string_view digits_a = TakeDigits(&a), digits_b = TakeDigits(&b);
      if (digits_a.size() != digits_b.size()) return digits_a.size() < digits_b.size();
      if (digits_a != digits_b) return digits_a < digits_b;
    } else {
      if (a.front() != b.front()) return a.front() < b.front();
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  if (a.empty() != b.empty()) return a.empty();
  return whole_a < whole_b;  // "7" and "07" are not the same file
}

absl::StatusOr<FrameList> ListFrames(const std::vector<std::string>& inputs) {
  if (inputs.empty()) {
    return absl::InvalidArgumentError("no frames: want a folder, a list or EXR files");
  }
  std::error_code error;
  FrameList list;
  absl::StatusOr<std::vector<std::string>> paths = inputs;
  if (inputs.size() == 1 && std::filesystem::is_directory(inputs[0], error)) {
    list.shot = LastName(inputs[0]);
    paths = FilesOfFolder(inputs[0]);
  } else if (inputs.size() == 1 && !IsExr(inputs[0])) {
    list.shot = std::filesystem::path(LastName(inputs[0])).stem().string();
    paths = FilesOfList(inputs[0]);
  } else {
    for (const std::string& input : inputs) {
      if (IsExr(input)) continue;
      return absl::InvalidArgumentError(
          absl::StrCat(input, ": want one folder, one list, or .exr files alone"));
    }
    list.shot = LastName(std::filesystem::absolute(inputs[0], error).parent_path().string());
  }
  if (!paths.ok()) return paths.status();
  list.frames = NamedFrames(*std::move(paths));
  return list;
}

}  // namespace lightfit
