#include "io/frames/frame_table.h"

#include <algorithm>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/string_view.h"

namespace lightfit {
namespace {

using google::protobuf::Struct;
using google::protobuf::Value;

std::optional<FrameNumber> NumberIn(const Value& value) {
  if (value.has_number_value()) return FrameNumberOf(value.number_value());
  if (value.has_string_value()) return ParseFrameNumber(value.string_value());
  return std::nullopt;
}

// The first of these fields that is there.
absl::StatusOr<std::optional<FrameNumber>> NumberOfField(const Struct& object,
                                                         std::initializer_list<const char*> names,
                                                         const std::string& where) {
  for (const char* name : names) {
    const auto found = object.fields().find(name);
    if (found == object.fields().end()) continue;
    const std::optional<FrameNumber> number = NumberIn(found->second);
    if (number.has_value()) return number;
    return absl::InvalidArgumentError(
        absl::StrCat(where, name, ": want the number of a frame, such as 1001 or 1001.25"));
  }
  return std::optional<FrameNumber>();
}

std::string RangeText(FrameNumber first, FrameNumber last) {
  return first == last ? absl::StrCat("frame ", first.Text())
                       : absl::StrCat("frames ", first.Text(), " ... ", last.Text());
}

}  // namespace

bool HasFrames(const Struct& file) { return file.fields().contains("frames"); }

absl::StatusOr<std::optional<FrameNumber>> StatedNumber(const Struct& entry,
                                                        const std::string& where) {
  return NumberOfField(entry, {"frame", "frame_number", "frameNumber", "number"}, where + ".");
}

absl::StatusOr<FrameTable> ReadFrameTable(const Struct& file) {
  FrameTable table;
  const Value& frames = file.fields().at("frames");
  if (frames.has_struct_value()) {
    for (const auto& [name, value] : frames.struct_value().fields()) {
      const std::optional<FrameNumber> number = ParseFrameNumber(name);
      if (!number.has_value()) {
        return absl::InvalidArgumentError(
            absl::StrCat("frames.", name, ": want the number of a frame for its name, as in 1001"));
      }
      table.push_back({number, value});
    }
  } else {
    const absl::StatusOr<std::optional<FrameNumber>> start =
        NumberOfField(file, {"frame_start", "frameStart", "start_frame", "startFrame"}, "");
    if (!start.ok()) return start.status();
    size_t num_stated = 0;
    for (const Value& value : frames.list_value().values()) {
      const std::string where = absl::StrFormat("frames[%d]", table.size());
      const absl::StatusOr<std::optional<FrameNumber>> number =
          StatedNumber(value.struct_value(), where);
      if (!number.ok()) return number.status();
      num_stated += number->has_value() ? 1 : 0;
      table.push_back({*number, value});
    }
    if (num_stated > 0 && num_stated < table.size()) {
      return absl::InvalidArgumentError(
          absl::StrFormat("frames: %d of %d say which they are (\"frame\": 1001), want all or none",
                          num_stated,
                          table.size()));
    }
    if (num_stated == 0 && start->has_value()) {
      for (size_t i = 0; i < table.size(); ++i) {
        table[i].number = FrameNumber{(*start)->millionths +
                                      FrameNumber::Whole(static_cast<int64_t>(i)).millionths};
      }
    }
  }
  if (table.empty()) return absl::InvalidArgumentError("frames: none, want at least one");
  std::vector<FrameNumber> numbers;
  for (const FrameEntry& entry : table) {
    if (entry.number.has_value()) numbers.push_back(*entry.number);
  }
  std::sort(numbers.begin(), numbers.end());
  const auto twice = std::adjacent_find(numbers.begin(), numbers.end());
  if (twice != numbers.end()) {
    return absl::InvalidArgumentError(
        absl::StrCat("frames: frame ", twice->Text(), " is there twice, want it once"));
  }
  return table;
}

absl::StatusOr<EntryChooser> EntryChooser::Make(std::vector<std::optional<FrameNumber>> entries,
                                                const ShotNumbers& shot,
                                                const std::string& what) {
  EntryChooser chooser;
  chooser.what_ = what;
  chooser.is_numbered_ = !entries.empty() && entries[0].has_value();
  for (size_t i = 0; i < entries.size(); ++i) {
    const FrameNumber place = FrameNumber::Whole(static_cast<int64_t>(i));
    chooser.entries_.emplace_back(entries[i].value_or(place), i);
  }
  std::sort(chooser.entries_.begin(), chooser.entries_.end());
  if (!shot.are_known) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "has %s of %d frames, and neither names nor headers of the read-backs say which frames "
        "they are: number their files, as in NAME.1001.exr",
        what,
        entries.size()));
  }
  if (shot.stated.has_value()) {
    chooser.shift_ = shot.stated->millionths - shot.first.millionths;
    return chooser;
  }
  chooser.goes_by_number_ = true;
  if (chooser.is_numbered_) return chooser;
  const int64_t span = shot.last.millionths - shot.first.millionths;
  if (span + FrameNumber::kUnit !=
      FrameNumber::Whole(static_cast<int64_t>(entries.size())).millionths) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "has %s of %d frames without saying which, and the read-backs are %s: which belongs to "
        "which cannot be known. Say \"frame\": %s and so on in the file, or --frame N, the place "
        "(from 0) of what belongs to frame %s",
        what,
        entries.size(),
        RangeText(shot.first, shot.last),
        shot.first.Text(),
        shot.first.Text()));
  }
  chooser.shift_ = -shot.first.millionths;
  return chooser;
}

absl::StatusOr<size_t> EntryChooser::EntryOf(FrameNumber number) const {
  const FrameNumber key = {number.millionths + shift_};
  const auto found =
      std::lower_bound(entries_.begin(), entries_.end(), std::pair<FrameNumber, size_t>(key, 0));
  if (found != entries_.end() && found->first == key) return found->second;
  const FrameNumber first = entries_.front().first, last = entries_.back().first;
  if (is_numbered_) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "has no %s of frame %s: it has %d, of %s%s",
        what_,
        key.Text(),
        entries_.size(),
        RangeText(first, last),
        goes_by_number_ ? "; --frame N says which of them is that of the first read-back" : ""));
  }
  return absl::InvalidArgumentError(absl::StrFormat(
      "frame %s is not in the file: it has %d, counted from 0", key.Text(), entries_.size()));
}

}  // namespace lightfit
