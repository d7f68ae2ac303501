#include "io/exr/depth.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/string_view.h"
#include "wire/utf8.h"

namespace lightfit::internal {

namespace {

// All names here are lower case and without marks: "z_depth" is "zdepth".
constexpr absl::string_view kDepthNames[] = {"z",
                                             "depth",
                                             "zdepth",
                                             "depthz",
                                             "pz",
                                             "zbuffer",
                                             "zpass",
                                             "depthpass",
                                             "cameradepth",
                                             "vrayzdepth"};

// What the only channel of a layer called depth may be called, beside these.
constexpr absl::string_view kOnlyNames[] = {"v", "r", "red", "x", "y", "value", "gray", "grey"};

// Layers and parts whose Z is no depth, even where X and Y are not there.
constexpr absl::string_view kVectorNames[] = {
    "p", "n", "ng", "ns", "pos", "pref", "pworld", "nworld", "worldpos", "point", "points", "uv"};
constexpr absl::string_view kVectorWords[] = {"normal",
                                              "position",
                                              "velocity",
                                              "motion",
                                              "vector",
                                              "tangent",
                                              "mist",
                                              "fog",
                                              "filter",
                                              "denois",
                                              "blur"};

// The same for layers alone: a light may be called Z.
constexpr absl::string_view kBitWords[] = {"shadow", "facing", "mapped"};

template <size_t kCount>
bool IsOneOf(absl::string_view name, const absl::string_view (&names)[kCount]) {
  return std::find(std::begin(names), std::end(names), name) != std::end(names);
}

template <size_t kCount>
bool HasOneOf(absl::string_view name, const absl::string_view (&words)[kCount]) {
  return std::any_of(std::begin(words), std::end(words), [name](absl::string_view word) {
    return absl::StrContains(name, word);
  });
}

std::string Plain(absl::string_view name) {
  std::string plain;
  for (const char c : name) {
    if (absl::ascii_isalnum(static_cast<unsigned char>(c))) plain.push_back(absl::ascii_tolower(c));
  }
  return plain;
}

// What stands before and after the last point.
std::pair<absl::string_view, absl::string_view> SplitLast(absl::string_view name) {
  const size_t point = name.rfind('.');
  if (point == absl::string_view::npos) return {"", name};
  return {name.substr(0, point), name.substr(point + 1)};
}

bool IsDepthName(absl::string_view layer) {
  return IsOneOf(Plain(SplitLast(layer).second), kDepthNames);
}

bool IsVectorName(absl::string_view layer) {
  const auto [parent, last] = SplitLast(layer);
  const std::string name = Plain(last);
  if (name == "z" && !parent.empty()) return IsVectorName(parent);  // the part "P.Z"
  if (IsDepthName(last)) return false;
  return IsOneOf(name, kVectorNames) || HasOneOf(name, kVectorWords);
}

// Whether the names have the x of this z: "px" of "pz".
bool HasItsX(std::string name, const std::set<std::string>& names) {
  if (name.empty() || name.back() != 'z') return false;
  name.back() = 'x';
  return names.count(name) > 0;
}

// The lower the better.
struct Rank {
  int is_uint = 0;  // never read as a depth, but said so
  int name = 0;
  int part = 0;

  bool operator<(const Rank& other) const {
    return std::tie(is_uint, name, part) < std::tie(other.is_uint, other.name, other.part);
  }
};

struct Candidate {
  const ExrChannel* channel;
  Rank rank;
};

class Ranking {
 public:
  explicit Ranking(const ExrChannels& channels) : channels_(channels) {
    for (const ExrChannel& channel : channels.all()) {
      names_of_layers_[LayerKey(channel)].insert(Plain(SplitLast(channel.name).second));
      parts_.insert(Plain(channel.part));
    }
  }

  // Nothing where the channel is no depth.
  std::optional<Rank> Of(const ExrChannel& channel) const {
    const std::optional<int> name = NameRank(channel);
    if (!name) return std::nullopt;
    Rank rank;
    rank.is_uint = channels_.exr().is_uint(channel.id) ? 1 : 0;
    rank.name = *name;
    rank.part = IsDepthName(channel.part) ? 0 : 1;
    return rank;
  }

 private:
  bool has_parts() const { return channels_.exr().num_parts() > 1; }

  // The layer that a channel without one is in: that of its part.
  absl::string_view LayerOf(const ExrChannel& channel) const {
    const absl::string_view layer = SplitLast(channel.name).first;
    return layer.empty() && has_parts() ? channel.part : layer;
  }

  // Layers are told apart by view too, and not by part: a vector's components may lie in several.
  std::pair<std::string, std::string> LayerKey(const ExrChannel& channel) const {
    return {absl::AsciiStrToLower(LayerOf(channel)), channel.view};
  }

  std::optional<int> NameRank(const ExrChannel& channel) const {
    const auto [layer, last] = SplitLast(channel.name);
    const absl::string_view any_layer = LayerOf(channel);
    const std::string name = Plain(last);
    const std::set<std::string>& beside = names_of_layers_.at(LayerKey(channel));
    const bool is_in_depth = IsDepthName(any_layer);
    if (HasItsX(name, beside) || IsVectorName(any_layer)) return std::nullopt;
    if (layer.empty()) {
      if (HasItsX(Plain(channel.part), parts_)) return std::nullopt;
      if (last == "Z") return 1;
    } else if (!is_in_depth && (HasOneOf(Plain(SplitLast(layer).second), kBitWords) ||
                                (name == "z" && beside.count("y") > 0))) {
      return std::nullopt;
    }
    if (is_in_depth && beside.size() == 1 && IsOneOf(name, kOnlyNames)) return 2;
    if (name == "z") return layer.empty() || is_in_depth ? 2 : 3;
    if (IsOneOf(name, kDepthNames)) return 2;
    return std::nullopt;
  }

  const ExrChannels& channels_;
  std::map<std::pair<std::string, std::string>, std::set<std::string>> names_of_layers_;
  std::set<std::string> parts_;
};

std::vector<Candidate> CandidatesOf(const ExrChannels& channels,
                                    const std::string& wanted,
                                    const std::string& view) {
  std::vector<Candidate> candidates;
  const Ranking ranking(channels);
  for (const ExrChannel& channel : channels.all()) {
    if (!view.empty() && !channel.IsIn(view)) continue;
    if (wanted.empty()) {
      if (const std::optional<Rank> rank = ranking.Of(channel)) {
        candidates.push_back({&channel, *rank});
      }
      continue;
    }
    const NameMatch match = channels.Match(channel, wanted);
    if (match == NameMatch::kNone) continue;
    Rank rank;
    rank.name = match == NameMatch::kPartAndChannel ? 0 : 1;
    candidates.push_back({&channel, rank});
  }
  return candidates;
}

absl::Status NoDepth(const ExrChannels& channels,
                     const std::string& wanted,
                     const std::string& view) {
  const std::string place =
      view.empty() ? "" : absl::StrCat(" in the view \"", Utf8Text(view), "\"");
  if (!wanted.empty()) {
    return absl::NotFoundError(
        absl::StrFormat("%s: depth_channel \"%s\" is not there%s; channels: %s",
                        channels.exr().path(),
                        Utf8Text(wanted),
                        place,
                        channels.QuotedByPart()));
  }
  return absl::NotFoundError(
      absl::StrFormat("%s: has no channel%s that is a depth, such as \"Z\", \"depth\", \"depth.V\" "
                      "or \"<layer>.Z\" without an X beside it: render a depth channel, or name it "
                      "as depth_channel, CHANNEL or PART.CHANNEL; channels: %s",
                      channels.exr().path(),
                      place,
                      channels.QuotedByPart()));
}

// The view of the candidates, empty in files without views.
absl::StatusOr<std::string> ViewOf(const ExrChannels& channels,
                                   const std::vector<Candidate>& candidates) {
  std::vector<std::string> views;
  for (const Candidate& candidate : candidates) {
    const std::string& view = candidate.channel->view;
    if (!view.empty() && std::find(views.begin(), views.end(), view) == views.end()) {
      views.push_back(view);
    }
  }
  if (views.empty()) views = channels.views();
  if (views.empty()) return "";
  if (views.size() == 1) return views.front();
  std::vector<ChannelId> ids;
  ids.reserve(candidates.size());
  for (const Candidate& candidate : candidates) ids.push_back(candidate.channel->id);
  return absl::InvalidArgumentError(
      absl::StrFormat("%s: has the views %s, and depth may be any of the channels %s: name one of "
                      "the views as view",
                      channels.exr().path(),
                      QuotedList(views),
                      QuotedChannels(channels.exr(), ids)));
}

}  // namespace

absl::StatusOr<DepthChoice> ChooseDepth(const ExrChannels& channels,
                                        const std::string& wanted,
                                        const std::string& view) {
  const std::vector<std::string>& views = channels.views();
  if (!view.empty() && std::find(views.begin(), views.end(), view) == views.end()) {
    return absl::NotFoundError(absl::StrFormat("%s: has no view \"%s\"; views: %s",
                                               channels.exr().path(),
                                               Utf8Text(view),
                                               QuotedList(views)));
  }
  const std::vector<Candidate> candidates = CandidatesOf(channels, wanted, view);
  if (candidates.empty()) return NoDepth(channels, wanted, view);
  DepthChoice choice;
  choice.view = view;
  if (view.empty()) {
    absl::StatusOr<std::string> only = ViewOf(channels, candidates);
    if (!only.ok()) return only.status();
    choice.view = *std::move(only);
  }
  const Rank best =
      std::min_element(candidates.begin(),
                       candidates.end(),
                       [](const Candidate& a, const Candidate& b) { return a.rank < b.rank; })
          ->rank;
  std::vector<ChannelId> equals;
  for (const Candidate& candidate : candidates) {
    if (!(best < candidate.rank)) equals.push_back(candidate.channel->id);
  }
  choice.id = equals.front();
  if (equals.size() == 1) return choice;
  return absl::InvalidArgumentError(
      absl::StrFormat("%s: depth may be any of the channels %s: name one as depth_channel, CHANNEL "
                      "or PART.CHANNEL",
                      channels.exr().path(),
                      QuotedChannels(channels.exr(), equals)));
}

}  // namespace lightfit::internal
