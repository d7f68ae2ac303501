#include "jobs/frames/frame_names.h"

#include <algorithm>
#include <set>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"

namespace lightfit {
namespace {

// Digits of a name; the candidates for its number.
struct Group {
  size_t begin = 0, end = 0;
  bool stands_alone = false;  // nothing but separators and ends around it
  bool is_version = false;    // "v02"
};

bool IsSeparator(char c) { return c == '.' || c == '_' || c == '-' || c == ' '; }

std::vector<Group> GroupsOf(absl::string_view name) {
  std::vector<Group> groups;
  for (size_t i = 0; i < name.size();) {
    if (!absl::ascii_isdigit(name[i])) {
      ++i;
      continue;
    }
    Group group = {i, i};
    while (group.end < name.size() && absl::ascii_isdigit(name[group.end])) ++group.end;
    i = group.end;
    const bool at_end = group.end == name.size();
    const bool begins = group.begin == 0 || IsSeparator(name[group.begin - 1]);
    group.is_version = group.begin > 0 && absl::ascii_tolower(name[group.begin - 1]) == 'v' &&
                       (group.begin == 1 || IsSeparator(name[group.begin - 2]));
    group.stands_alone = at_end || (begins && IsSeparator(name[group.end]));
    groups.push_back(group);
  }
  return groups;
}

absl::string_view DigitsOf(absl::string_view name, const Group& group) {
  return name.substr(group.begin, group.end - group.begin);
}

// The names with a mark for every group of digits are the same.
bool HaveOnePattern(absl::Span<const std::string> names,
                    const std::vector<std::vector<Group>>& groups) {
  const auto pattern = [&](size_t i) {
    std::string text;
    size_t at = 0;
    for (const Group& group : groups[i]) {
      absl::StrAppend(&text, absl::string_view(names[i]).substr(at, group.begin - at), "*");
      at = group.end;
    }
    return absl::StrCat(text, absl::string_view(names[i]).substr(at));
  };
  for (size_t i = 1; i < names.size(); ++i) {
    if (pattern(i) != pattern(0)) return false;
  }
  return true;
}

// Which group is the number when nothing else is known; -1: none.
int LikelyGroup(const std::vector<Group>& groups) {
  for (int i = static_cast<int>(groups.size()) - 1; i >= 0; --i) {
    if (groups[i].stands_alone && !groups[i].is_version) return i;
  }
  return -1;
}

// "1001.25": the group and the one before it, which a point alone divides.
bool HasGroupBefore(absl::string_view name, const std::vector<Group>& groups, int group) {
  return group > 0 && groups[group - 1].end + 1 == groups[group].begin &&
         name[groups[group - 1].end] == '.' && !groups[group - 1].is_version;
}

std::vector<int> ChosenGroups(absl::Span<const std::string> names,
                              const std::vector<std::vector<Group>>& groups) {
  std::vector<int> chosen;
  chosen.reserve(names.size());
  for (const std::vector<Group>& own : groups) chosen.push_back(LikelyGroup(own));
  if (names.size() < 2 || chosen[0] < 0 || !HaveOnePattern(names, groups)) return chosen;
  const auto varies = [&](int group) {
    for (size_t i = 1; i < names.size(); ++i) {
      if (DigitsOf(names[i], groups[i][group]) != DigitsOf(names[0], groups[0][group])) return true;
    }
    return false;
  };
  // Takes of one frame are no frames: shot.1.0001, shot.2.0001.
  if (HasGroupBefore(names[0], groups[0], chosen[0])) return chosen;
  for (int group = chosen[0]; group >= 0; --group) {
    const Group& first = groups[0][group];
    if (!first.stands_alone || first.is_version || !varies(group)) continue;
    chosen.assign(names.size(), group);
    break;
  }
  return chosen;
}

FrameName NameOf(absl::string_view name, size_t begin, size_t end) {
  return {absl::StrCat(name.substr(0, begin), "*", name.substr(end)),
          ParseFrameNumber(name.substr(begin, end - begin))};
}

// Where a minus that belongs to the number begins; `begin` without.
size_t WithMinus(absl::string_view name, size_t begin) {
  if (begin == 0 || name[begin - 1] != '-') return begin;
  return begin == 1 || IsSeparator(name[begin - 2]) ? begin - 1 : begin;
}

bool AreDistinct(const std::vector<FrameName>& names) {
  std::set<FrameNumber> numbers;
  for (const FrameName& name : names) {
    if (!name.number.has_value() || !numbers.insert(*name.number).second) return false;
  }
  return true;
}

// Names that all have a group before their last one: whether that is the frame and the last one
// what lies between two frames. A frame's number has more digits than what follows its point.
bool AreBetweenFrames(absl::Span<const std::string> names,
                      const std::vector<std::vector<Group>>& groups,
                      const std::vector<int>& chosen,
                      const std::vector<FrameName>& as_whole,
                      const std::vector<FrameName>& between) {
  bool is_longer = true, is_constant = true;
  size_t most_digits = 0;
  for (size_t i = 0; i < names.size(); ++i) {
    const absl::string_view frame = DigitsOf(names[i], groups[i][chosen[i] - 1]);
    const absl::string_view rest = DigitsOf(names[i], groups[i][chosen[i]]);
    is_longer &= frame.size() > rest.size();
    is_constant &= frame == DigitsOf(names[0], groups[0][chosen[0] - 1]);
    most_digits = std::max(most_digits, rest.size());
  }
  if (!is_longer) return !AreDistinct(as_whole) && AreDistinct(between) && most_digits <= 2;
  if (!is_constant || names.size() < 2 || most_digits < 3) return true;
  // "0012.001", "0012.002": one after the other, so they are frames of a take.
  std::set<FrameNumber> numbers;
  for (const FrameName& name : as_whole) {
    if (name.number.has_value()) numbers.insert(*name.number);
  }
  for (const FrameNumber number : numbers) {
    if (numbers.count({number.millionths + FrameNumber::kUnit}) > 0) return false;
  }
  return true;
}

// "shot-001" beside "shot000": a minus after all.
void FindFurtherMinus(std::vector<FrameName>* result) {
  std::set<std::string> with_zero;
  for (const FrameName& name : *result) {
    if (name.number == FrameNumber{}) with_zero.insert(name.series);
  }
  for (FrameName& name : *result) {
    const size_t mark = name.series.find("-*");
    if (mark == std::string::npos || !name.number.has_value()) continue;
    const std::string series =
        absl::StrCat(name.series.substr(0, mark), name.series.substr(mark + 1));
    if (with_zero.count(series) == 0) continue;
    name.series = series;
    name.number->millionths = -name.number->millionths;
  }
}

}  // namespace

std::vector<FrameName> ReadFrameNames(absl::Span<const std::string> names) {
  std::vector<std::vector<Group>> groups;
  groups.reserve(names.size());
  for (const std::string& name : names) groups.push_back(GroupsOf(name));
  const std::vector<int> chosen = ChosenGroups(names, groups);
  std::vector<FrameName> whole, between;
  std::set<std::string> whole_series;  // of names that are of a whole frame in any case
  bool all_have_two = true;
  for (size_t i = 0; i < names.size(); ++i) {
    if (chosen[i] < 0) {
      whole.push_back({names[i], std::nullopt});
      between.push_back(whole.back());
      all_have_two = false;
      continue;
    }
    const Group& group = groups[i][chosen[i]];
    whole.push_back(NameOf(names[i], WithMinus(names[i], group.begin), group.end));
    between.push_back(whole.back());
    if (HasGroupBefore(names[i], groups[i], chosen[i])) {
      const size_t begin = WithMinus(names[i], groups[i][chosen[i] - 1].begin);
      between.back() = NameOf(names[i], begin, group.end);
    } else {
      all_have_two = false;
      whole_series.insert(whole.back().series);
    }
  }
  const bool all_between =
      all_have_two && !names.empty() && AreBetweenFrames(names, groups, chosen, whole, between);
  std::vector<FrameName> result;
  for (size_t i = 0; i < names.size(); ++i) {
    const bool is_between = all_between || whole_series.count(between[i].series) > 0;
    result.push_back(is_between ? between[i] : whole[i]);
  }
  FindFurtherMinus(&result);
  return result;
}

}  // namespace lightfit
