#include "jobs/tune/journal.h"

#include <cerrno>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "base/text_file.h"

namespace lightfit {

namespace {

constexpr char kHeading[] = "lightfit tune journal 1, key ";

absl::Status NotWritten(const std::string& path) {
  return absl::UnknownError(
      absl::StrCat(path, ": cannot be written: ", std::generic_category().message(errno)));
}

// One value's line, without its end.
bool ParseLine(absl::string_view line, int* light, double* value) {
  const std::pair<absl::string_view, absl::string_view> parts =
      absl::StrSplit(line, absl::MaxSplits(' ', 1));
  return absl::SimpleAtoi(parts.first, light) && *light >= 0 &&
         absl::SimpleAtod(parts.second, value) && std::isfinite(*value);
}

}  // namespace

absl::StatusOr<Journal> Journal::Open(const std::string& path, absl::string_view key) {
  Journal journal;
  journal.path_ = path;
  const std::string heading = absl::StrCat(kHeading, key, "\n");
  std::error_code error;
  bool is_new = !std::filesystem::exists(path, error);
  if (!is_new) {
    const absl::StatusOr<std::string> text = ReadTextFile(path);
    if (!text.ok()) return text.status();
    // Up to the end of the last whole line; of a run that was stopped at once there is none.
    const absl::string_view whole =
        absl::string_view(*text).substr(0, text->find_last_of('\n') + 1);  // npos + 1 is 0
    is_new = whole.empty() && absl::StartsWith(heading, *text);
    if (!is_new && !absl::StartsWith(whole, heading)) {
      const bool is_journal = absl::StartsWith(whole, kHeading);
      return absl::InvalidArgumentError(absl::StrCat(
          path,
          is_journal ? ": is the journal of another scene, camera, lights, options or version"
                     : ": is there and is no journal of lightfit tune",
          "; want another --journal, or delete it"));
    }
    if (!is_new) {
      std::vector<absl::string_view> lines = absl::StrSplit(whole.substr(heading.size()), '\n');
      lines.pop_back();  // behind the last end of a line
      for (size_t i = 0; i < lines.size(); ++i) {
        int light = 0;
        double value = 0.0;
        if (!ParseLine(lines[i], &light, &value)) {
          return absl::InvalidArgumentError(absl::StrFormat(
              "%s: line %d is damaged; delete it and those after it, or want another --journal",
              path,
              i + 2));
        }
        journal.by_light_[light].values.push_back(value);
      }
      std::filesystem::resize_file(path, whole.size(), error);
      if (error) return absl::UnknownError(absl::StrCat(path, ": ", error.message()));
    }
  }
  journal.file_.reset(std::fopen(path.c_str(), is_new ? "wb" : "ab"));
  if (journal.file_ == nullptr) return NotWritten(path);
  if (is_new && (std::fputs(heading.c_str(), journal.file_.get()) < 0 ||
                 std::fflush(journal.file_.get()) != 0)) {
    return NotWritten(path);
  }
  return journal;
}

std::optional<double> Journal::Next(int light) {
  const auto found = by_light_.find(light);
  if (found == by_light_.end()) return std::nullopt;
  Values& values = found->second;
  if (values.num_asked == values.values.size()) return std::nullopt;
  return values.values[values.num_asked++];
}

absl::Status Journal::Append(int light, double value) {
  if (file_ == nullptr) return absl::OkStatus();
  const std::string line = absl::StrFormat("%d %.17g\n", light, value);
  if (std::fputs(line.c_str(), file_.get()) < 0 || std::fflush(file_.get()) != 0) {
    return NotWritten(path_);
  }
  return absl::OkStatus();
}

}  // namespace lightfit
