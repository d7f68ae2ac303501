#include "jobs/add_summaries.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/text_file.h"

namespace lightfit {

absl::Status SummaryAdder::Add(const std::string& name, const SummarySet& set) {
  if (!sum_.has_value()) {
    sum_ = set;
    added_.emplace_back(name, set.frames);
    return absl::OkStatus();
  }
  absl::Status status = AddToSet(set, &*sum_);
  if (status.ok()) {
    added_.emplace_back(name, set.frames);
    return status;
  }
  const auto repeated = FirstInBoth(set.frames, sum_->frames);
  if (status.code() != absl::StatusCode::kAlreadyExists || !repeated.has_value()) {
    return InFile(name, status);
  }
  for (const auto& [other, frames] : added_) {
    if (!std::binary_search(frames.begin(), frames.end(), *repeated)) continue;
    return absl::InvalidArgumentError(
        absl::StrFormat("%s is in %s and in %s, and would count twice: leave one of the two out",
                        IdentityText(*repeated),
                        other,
                        name));
  }
  return absl::InvalidArgumentError(absl::StrCat(name, ": ", status.message()));
}

std::vector<std::string> SummaryAdder::Notes() const {
  std::vector<std::string> notes;
  if (!sum_.has_value()) return notes;
  if (const int64_t unknown = sum_->num_unknown_frames(); unknown > 0) {
    notes.push_back(absl::StrFormat(
        "%d of %d frames are of summary files that do not say which frames they are (made by an "
        "older lightfit): whether one counts twice cannot be seen",
        unknown,
        sum_->num_frames()));
  }
  const std::vector<FrameNumber> several = NumbersOfSeveral(sum_->frames);
  if (several.empty()) return notes;
  std::vector<std::string> paths;
  for (const auto& [path, frames] : added_) {
    const bool has_it =
        std::any_of(frames.begin(), frames.end(), [&several](const FrameIdentity& frame) {
          return frame.number == several.front();
        });
    if (has_it && paths.size() < 2) paths.push_back(path);
  }
  notes.push_back(absl::StrFormat(
      "frame %s%s is there more than once with different content (%s): if one was rendered again, "
      "leave the old one out",
      several.front().Text(),
      several.size() > 1 ? absl::StrCat(" and ", several.size() - 1, " more") : "",
      absl::StrJoin(paths, ", ")));
  return notes;
}

}  // namespace lightfit
