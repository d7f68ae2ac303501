#include "io/exr/channels.h"

#include <algorithm>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "wire/utf8.h"

namespace lightfit::internal {

namespace {

constexpr size_t kMaxListed = 40;

// "Z" and "left" of "left.Z" in a part that has that view. A name without a view is of the default
// one, which stands first.
void SetNameAndView(absl::string_view written,
                    const std::vector<std::string>& views,
                    ExrChannel* channel) {
  channel->name = std::string(written);
  if (views.empty()) return;
  channel->view = views.front();
  std::vector<absl::string_view> words = absl::StrSplit(written, '.');
  for (size_t i = 0; i + 1 < words.size(); ++i) {
    if (std::find(views.begin(), views.end(), words[i]) == views.end()) continue;
    channel->view = std::string(words[i]);
    words.erase(words.begin() + static_cast<std::ptrdiff_t>(i));
    channel->name = absl::StrJoin(words, ".");
    return;
  }
}

// "depth" of the parts "depth.left" and "left_depth", if that is the view.
std::string WithoutView(absl::string_view part, absl::string_view view) {
  if (view.empty()) return std::string(part);
  for (const char* mark : {".", "_", "-", " "}) {
    if (absl::ConsumeSuffix(&part, absl::StrCat(mark, view))) break;
    if (absl::ConsumePrefix(&part, absl::StrCat(view, mark))) break;
  }
  return std::string(part);
}

bool IsPartAndChannel(absl::string_view name, absl::string_view part, absl::string_view channel) {
  return !part.empty() && absl::ConsumePrefix(&name, part) && absl::ConsumePrefix(&name, ".") &&
         name == channel;
}

}  // namespace

ExrChannels::ExrChannels(const ExrInput& exr) : exr_(exr) {
  for (int part = 0; part < exr.num_parts(); ++part) {
    const std::vector<std::string>& views = exr.part_views(part);
    for (const std::string& view : views) {
      if (std::find(views_.begin(), views_.end(), view) == views_.end()) views_.push_back(view);
    }
    const std::string part_name =
        WithoutView(exr.part_name(part), views.size() == 1 ? views.front() : "");
    for (size_t i = 0; i < exr.channels(part).size(); ++i) {
      ExrChannel& channel = all_.emplace_back();
      channel.id = {part, static_cast<int>(i)};
      channel.part = part_name;
      SetNameAndView(exr.channels(part)[i], views, &channel);
    }
  }
}

NameMatch ExrChannels::Match(const ExrChannel& channel, absl::string_view name) const {
  const std::string& written = exr_.name(channel.id);
  for (const std::string* part : {&exr_.part_name(channel.id.part), &channel.part}) {
    if (IsPartAndChannel(name, *part, written) || IsPartAndChannel(name, *part, channel.name)) {
      return NameMatch::kPartAndChannel;
    }
  }
  return name == written || name == channel.name ? NameMatch::kChannel : NameMatch::kNone;
}

absl::StatusOr<std::optional<ChannelId>> ExrChannels::Find(absl::string_view name,
                                                           int near_part,
                                                           absl::string_view view) const {
  std::vector<ChannelId> near, by_part, others;
  for (const ExrChannel& channel : all_) {
    if (!channel.IsIn(view)) continue;
    const NameMatch match = Match(channel, name);
    if (match == NameMatch::kNone) continue;
    if (match == NameMatch::kPartAndChannel) {
      by_part.push_back(channel.id);
    } else {
      (channel.id.part == near_part ? near : others).push_back(channel.id);
    }
  }
  for (const std::vector<ChannelId>& found : {near, by_part, others}) {
    if (found.size() == 1) return found.front();
    if (found.size() > 1) {
      return absl::InvalidArgumentError(
          absl::StrFormat("%s: \"%s\" may be any of the channels %s: name it as PART.CHANNEL",
                          exr_.path(),
                          Utf8Text(name),
                          QuotedChannels(exr_, found)));
    }
  }
  return std::nullopt;
}

std::string ExrChannels::QuotedByPart() const {
  std::string list;
  for (int part = 0; part < exr_.num_parts(); ++part) {
    if (part == static_cast<int>(kMaxListed)) {
      return absl::StrCat(list, "; and ", exr_.num_parts() - part, " more parts");
    }
    std::string channels = QuotedList(exr_.channels(part));
    if (exr_.num_parts() == 1) return channels;
    absl::StrAppend(&list, part == 0 ? "" : "; ", exr_.quoted_part(part));
    // Part names need not tell it.
    if (exr_.part_views(part).size() == 1) {
      absl::StrAppend(&list, " of the view ", QuotedList(exr_.part_views(part)));
    }
    absl::StrAppend(&list, ": ", channels);
  }
  return list;
}

std::string QuotedChannels(const ExrInput& exr, const std::vector<ChannelId>& channels) {
  std::string list;
  for (size_t i = 0; i < std::min(channels.size(), kMaxListed); ++i) {
    absl::StrAppend(&list, i == 0 ? "" : ", ", exr.quoted_name(channels[i]));
  }
  if (channels.size() > kMaxListed) {
    absl::StrAppend(&list, " and ", channels.size() - kMaxListed, " more");
  }
  return list;
}

}  // namespace lightfit::internal
