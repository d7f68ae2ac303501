#include "jobs/shot/frames.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "base/text_file.h"
#include "io/frames/exr_frame.h"
#include "jobs/frames/frame_gaps.h"
#include "jobs/frames/frame_names.h"
#include "jobs/frames/frame_pattern.h"
#include "wire/utf8.h"

namespace lightfit {
namespace {

bool IsExr(const std::filesystem::path& path) {
  return absl::AsciiStrToLower(path.extension().string()) == ".exr";
}

// Of systems and programs, such as "._1001.exr".
bool IsHidden(const std::filesystem::path& path) { return path.filename().string().front() == '.'; }

absl::StatusOr<std::vector<std::string>> FilesOfFolder(const std::string& folder) {
  std::error_code error;
  std::filesystem::directory_iterator entry(folder, error);
  std::vector<std::string> paths;
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    std::error_code ignored;
    if (!IsExr(entry->path()) || IsHidden(entry->path()) || entry->is_directory(ignored)) continue;
    paths.push_back(entry->path().string());
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

// What is known of where the files are on the time line.
struct Numbered {
  std::vector<std::string> series;
  std::vector<std::optional<FrameNumber>> numbers;

  bool IsComplete() const {
    return std::all_of(numbers.begin(), numbers.end(), [](const auto& n) { return n.has_value(); });
  }
  bool IsEmpty() const {
    return std::none_of(
        numbers.begin(), numbers.end(), [](const auto& n) { return n.has_value(); });
  }
};

Numbered ByNames(const std::vector<std::string>& names) {
  Numbered result;
  for (FrameName& name : ReadFrameNames(names)) {
    result.series.push_back(std::move(name.series));
    result.numbers.push_back(name.number);
  }
  return result;
}

bool HasTwoAlike(const std::vector<std::string>& names) {
  return std::set<std::string>(names.begin(), names.end()).size() < names.size();
}

std::vector<std::string> StemsOf(const std::vector<MatchedFile>& files) {
  std::vector<std::string> names;
  names.reserve(files.size());
  for (const MatchedFile& file : files) {
    names.push_back(std::filesystem::path(file.path).stem().string());
  }
  return names;
}

std::vector<std::string> FoldersOf(const std::vector<MatchedFile>& files) {
  std::vector<std::string> names;
  names.reserve(files.size());
  for (const MatchedFile& file : files) {
    names.push_back(std::filesystem::path(file.path).parent_path().filename().string());
  }
  return names;
}

Numbered ByHeaders(const std::vector<MatchedFile>& files) {
  Numbered result;
  for (const MatchedFile& file : files) {
    result.series.emplace_back("header");
    result.numbers.push_back(FrameOfExr(file.path));
    if (!result.numbers.back().has_value()) break;  // of all or of none
  }
  result.series.resize(files.size());
  result.numbers.resize(files.size());
  return result;
}

// What patterns said, names, folders' names where files have one name, or headers.
Numbered NumbersOf(const std::vector<MatchedFile>& files, std::vector<std::string>* names) {
  Numbered marked;
  for (const MatchedFile& file : files) {
    marked.series.emplace_back("pattern");
    marked.numbers.push_back(file.number);
  }
  const bool have_one_name = std::set<std::string>(names->begin(), names->end()).size() == 1;
  if (have_one_name && (files.size() > 1 || ByNames(*names).IsEmpty())) {
    const std::vector<std::string> folders = FoldersOf(files);
    Numbered by_folders = ByNames(folders);
    if (!HasTwoAlike(folders) && by_folders.IsComplete()) {
      if (files.size() > 1) *names = folders;
      return by_folders;
    }
  }
  if (marked.IsComplete()) return marked;
  Numbered by_names = ByNames(*names);
  if (!by_names.IsEmpty()) return by_names;
  Numbered by_headers = ByHeaders(files);
  return by_headers.IsComplete() ? by_headers : by_names;
}

absl::Status SameNumberError(const std::string& a, const std::string& b, FrameNumber number) {
  const std::string folder = std::filesystem::path(a).parent_path().string();
  return absl::InvalidArgumentError(
      absl::StrCat(Utf8Text(a),
                   " and ",
                   Utf8Text(b),
                   " are both frame ",
                   number.Text(),
                   ": want one file for each frame; choose those of one shot and pass by a "
                   "pattern, such as \"",
                   Utf8Text(folder),
                   folder.empty() ? "" : "/",
                   "NAME.*.exr\""));
}

absl::Status TwoSeriesError(const std::string& path_a,
                            const std::string& series_a,
                            const std::string& path_b,
                            const std::string& series_b) {
  return absl::InvalidArgumentError(
      absl::StrCat(Utf8Text(path_a),
                   " and ",
                   Utf8Text(path_b),
                   " are not of one sequence (",
                   Utf8Text(series_a),
                   " and ",
                   Utf8Text(series_b),
                   "): want the frames of one shot; choose them by a pattern, such as \"",
                   Utf8Text(std::filesystem::path(path_a).parent_path().string()),
                   "/",
                   Utf8Text(series_a),
                   ".exr\""));
}

// Puts the frames in order, and says what is missing.
absl::Status OrderByNumber(bool was_given_in_order, FrameList* list) {
  std::vector<ShotFrame>& frames = list->frames;
  const auto before = [](const ShotFrame& a, const ShotFrame& b) { return a.number < b.number; };
  if (was_given_in_order && !std::is_sorted(frames.begin(), frames.end(), before)) {
    list->reordered =
        "frames are taken in the order of their numbers, not in the one in which they were given";
  }
  std::stable_sort(frames.begin(), frames.end(), before);
  std::vector<FrameNumber> numbers;
  numbers.reserve(frames.size());
  for (const ShotFrame& frame : frames) numbers.push_back(frame.number);
  for (size_t i = 1; i < frames.size(); ++i) {
    if (numbers[i] == numbers[i - 1])
      return SameNumberError(frames[i - 1].path, frames[i].path, numbers[i]);
  }
  const FrameGaps gaps = FindGaps(numbers);
  for (size_t i = 0; i < frames.size(); ++i) frames[i].is_after_gap = gaps.is_after[i];
  if (gaps.step > FrameNumber::Whole(1)) {
    list->apart = absl::StrCat("frames are ",
                               gaps.step.Text(),
                               " apart, from ",
                               numbers.front().Text(),
                               " to ",
                               numbers.back().Text());
  }
  list->missing = GapsText(gaps);
  return absl::OkStatus();
}

// `in_order`: the files stand as somebody put them; else in natural order.
absl::Status SetFrames(std::vector<MatchedFile> files, bool in_order, FrameList* list) {
  const auto is_hidden = [](const MatchedFile& file) { return IsHidden(file.path); };
  files.erase(std::remove_if(files.begin(), files.end(), is_hidden), files.end());
  if (files.empty()) return absl::NotFoundError("no frames: hidden files (._*) are none");
  std::vector<std::string> names = StemsOf(files);
  const Numbered numbered = NumbersOf(files, &names);
  list->is_numbered = numbered.IsComplete();
  const bool may_be_mixed = in_order && !list->is_numbered;  // somebody knows what is wanted
  for (size_t i = 1; i < files.size() && !may_be_mixed; ++i) {
    if (numbered.IsEmpty() || numbered.series[i] == numbered.series[0]) continue;
    std::map<std::optional<FrameNumber>, size_t> first;  // with that number
    for (size_t b = 0; b < files.size() && list->is_numbered; ++b) {
      const auto [a, is_new] = first.emplace(numbered.numbers[b], b);
      if (is_new) continue;
      return SameNumberError(files[a->second].path, files[b].path, *numbered.numbers[b]);
    }
    return TwoSeriesError(files[0].path, numbered.series[0], files[i].path, numbered.series[i]);
  }
  const bool have_own_names = !HasTwoAlike(names);
  for (size_t i = 0; i < files.size(); ++i) {
    ShotFrame frame;
    frame.path = std::move(files[i].path);
    frame.name = have_own_names ? std::move(names[i]) : absl::StrFormat("%04d", i + 1);
    frame.number =
        list->is_numbered ? *numbered.numbers[i] : FrameNumber::Whole(static_cast<int64_t>(i) + 1);
    list->frames.push_back(std::move(frame));
  }
  if (list->is_numbered) return OrderByNumber(in_order, list);
  return absl::OkStatus();
}

std::vector<MatchedFile> Files(const std::vector<std::string>& paths) {
  std::vector<MatchedFile> files;
  files.reserve(paths.size());
  for (const std::string& path : paths) files.push_back({path, std::nullopt});
  return files;
}

}  // namespace

absl::StatusOr<FrameList> ListFrames(const std::vector<std::string>& inputs) {
  if (inputs.empty()) {
    return absl::InvalidArgumentError("no frames: want a folder, a list or EXR files");
  }
  std::error_code error;
  FrameList list;
  std::vector<MatchedFile> files;
  bool in_order = true;
  if (inputs.size() == 1 && std::filesystem::is_directory(inputs[0], error)) {
    list.shot = LastName(inputs[0]);
    const absl::StatusOr<std::vector<std::string>> paths = FilesOfFolder(inputs[0]);
    if (!paths.ok()) return paths.status();
    files = Files(*paths);
    in_order = false;
  } else if (inputs.size() == 1 && !IsExr(inputs[0]) && !IsFilePattern(inputs[0])) {
    list.shot = std::filesystem::path(LastName(inputs[0])).stem().string();
    const absl::StatusOr<std::vector<std::string>> paths = FilesOfList(inputs[0]);
    if (!paths.ok()) return paths.status();
    files = Files(*paths);
  } else {
    for (const std::string& input : inputs) {
      if (IsFilePattern(input)) {
        absl::StatusOr<std::vector<MatchedFile>> found = FilesMatching(input);
        if (!found.ok()) return found.status();
        files.insert(files.end(), found->begin(), found->end());
        in_order = in_order && inputs.size() > 1;
      } else {
        files.push_back({input, std::nullopt});
      }
    }
    for (const MatchedFile& file : files) {
      if (IsExr(file.path)) continue;
      return absl::InvalidArgumentError(
          absl::StrCat(file.path, ": want one folder, one list, or .exr files alone"));
    }
    list.shot = LastName(std::filesystem::absolute(files[0].path, error).parent_path().string());
  }
  if (absl::Status status = SetFrames(std::move(files), in_order, &list); !status.ok()) {
    return inputs.size() == 1 ? InFile(inputs[0], status) : status;
  }
  return list;
}

std::optional<FrameNumber> NumberOfFile(const std::string& path) {
  const std::vector<MatchedFile> files = {{path, std::nullopt}};
  std::vector<std::string> names = StemsOf(files);
  return NumbersOf(files, &names).numbers[0];
}

}  // namespace lightfit
