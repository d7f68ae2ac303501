#include "io/notes/readback_notes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "wire/utf8.h"

namespace lightfit {

void ReadbackNotes::Add(size_t place, const std::string& path, const ReadbackFile& file) {
  notes_[place] = {path, lightfit::OriginText(file.origin), file.warnings};
}

std::string ReadbackNotes::OriginText() const {
  if (notes_.empty()) return "";
  const std::string& first = notes_.begin()->second.origin;
  const auto num_others = std::count_if(
      notes_.begin(), notes_.end(), [&](const auto& note) { return note.second.origin != first; });
  if (num_others == 0) return first;
  const auto other = std::find_if(
      notes_.begin(), notes_.end(), [&](const auto& note) { return note.second.origin != first; });
  return absl::StrCat(first,
                      "; but in ",
                      num_others,
                      " of ",
                      notes_.size(),
                      " read-backs another, as ",
                      other->second.origin,
                      " of ",
                      other->second.path);
}

void PutNotes(const ReadbackFile& file, v1::ReadbackInfo* info) {
  *info->mutable_origin() = OriginToProto(file.origin);
  for (const ReadbackWarning& warning : file.warnings) info->add_warnings(Utf8Text(warning.text));
  if (file.background.has_value() && std::isfinite(*file.background)) {
    info->set_background(*file.background);
  }
}

std::vector<std::string> ReadbackNotes::Warnings() const {
  std::vector<std::pair<std::string, std::string>> lines;  // about, text of the first
  std::map<std::string, int> counts;
  for (const auto& [place, note] : notes_) {
    for (const ReadbackWarning& warning : note.warnings) {
      if (++counts[warning.about] > 1) continue;
      lines.emplace_back(warning.about, absl::StrCat(note.path, ": ", warning.text));
    }
  }
  std::vector<std::string> texts;
  for (auto& [about, text] : lines) {
    const int count = counts[about];
    if (count > 1) {
      absl::StrAppend(&text, " (likewise ", count - 1, " more of ", notes_.size(), " read-backs)");
    }
    texts.push_back(std::move(text));
  }
  return texts;
}

}  // namespace lightfit
