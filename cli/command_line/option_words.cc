#include "cli/command_line/option_words.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "cli/flags/choices.h"

namespace lightfit::cli {
namespace {

const CLI::App* verb_of_messages = nullptr;

// An option is found by its field's name, min_side by --min-side; here are those that have another
// one. Of several the first that the verb has counts.
struct Renamed {
  const char* field;
  const char* option;
};
constexpr Renamed kRenamed[] = {
    {"max_maps", "--maps"},
    {"guard_texels", "--guard"},
    {"each", "--map"},
    {"map", "--map"},
    {"texels", "--budget"},
    {"budget_texels", "--budget"},
    {"budget_texels", "--texels"},
    {"powers_of_two", "--power-of-two"},
    {"limit_px", "--tolerance"},
    {"image_scale", "--image"},
    {"constant_share", "--bias-share"},
    {"update_every_frames", "--update-every"},
    {"shadow_channel_format", "--shadow-channel"},
    {"facing_channel_format", "--facing-channel"},
    {"mapped_channel_format", "--mapped-channel"},
    {"shadow_bits", "--shadow-bits-channel"},
    {"fine_cover", "--cover-readback"},
};

// Settings of "generate:", by their words there.
constexpr std::pair<const char*, const char*> kSettings[] = {
    {"num_triangles", "triangles"}, {"num_objects", "objects"}, {"floor_half_size", "floor"}};

constexpr std::pair<const char*, const char*> kEnumerators[] = {
    {"kFocused", "focused"},
    {"kRotationLineSearch", "line"},
    {"kRotationLineSearchRefined", "refine"},
    {"kGlobal", "global"},
    {"kMinAreaRectangle", "rectangle"},
    {"kMinAreaRectangleCgal", "cgal-rectangle"},
    {"kSkewedRectangle", "skewed"},
    {"kMinEnergyParallelogram", "parallelogram"},
    {"kReceivers", "receivers"},
    {"kShadowed", "shadowed"},
    {"kL1", "l1"},
    {"kL1AcrossEdge", "l1-edge"},
    {"kL2", "l2"},
    {"kL2AcrossEdge", "l2-edge"},
};

// Fields that no option sets: said as words.
constexpr const char* kWithoutOption[] = {"min_w",
                                          "margin_texels",
                                          "along_edge_share",
                                          "reweighting_rounds",
                                          "line_search_rounds",
                                          "grid_directions",
                                          "sample_by_sample",
                                          "max_depth_bend",
                                          "depth_noise",
                                          "min_cos_light",
                                          "min_cos_eye",
                                          "edge_window",
                                          "max_frame_shift",
                                          "max_pixels",
                                          "facing_bits",
                                          "mapped_bits"};

// Before a field: structures of the library.
constexpr const char* kStructures[] = {"options",
                                       "rules",
                                       "sizes",
                                       "samples",
                                       "fit",
                                       "plan",
                                       "plan_options",
                                       "plan_tracker",
                                       "tracker",
                                       "tolerance",
                                       "judge",
                                       "readback"};

// What is no field alone.
std::string WithPhrases(absl::string_view message) {
  return absl::StrReplaceAll(message,
                             {{": the guard of ", ": the --guard of "},
                              {"camera: near = ", "camera: --near "},
                              {", far = ", ", --far "},
                              {" (FitLight)", ""}});
}

bool IsStructure(const std::string& word) {
  return std::find(std::begin(kStructures), std::end(kStructures), word) != std::end(kStructures);
}

bool IsExtension(const std::string& word) {
  constexpr const char* kExtensions[] = {"exr", "json", "csv", "png", "summary", "journal", "txt"};
  return std::find(std::begin(kExtensions), std::end(kExtensions), word) != std::end(kExtensions);
}

bool HasOption(const std::string& option) {
  return verb_of_messages != nullptr && verb_of_messages->get_option_no_throw(option) != nullptr;
}

std::optional<std::string> OptionFor(const std::string& field) {
  const std::string same = absl::StrCat("--", absl::StrReplaceAll(field, {{"_", "-"}}));
  if (HasOption(same)) return same;
  for (const Renamed& renamed : kRenamed) {
    if (field == renamed.field && HasOption(renamed.option)) return renamed.option;
  }
  return std::nullopt;
}

struct Said {
  std::string text;
  bool is_option = false;  // "= 3" after it is " 3"
};

template <typename Value>
std::optional<Said> SayForSchema(const std::string& word,
                                 absl::string_view prefix,
                                 const Words<Value>& words) {
  if (!absl::StartsWith(word, prefix)) return std::nullopt;
  const Value* value = FindValue(words, word.substr(prefix.size()));
  if (value == nullptr) return std::nullopt;
  return Said{WordFor(words, *value)};
}

// METRIC_L1_ACROSS_EDGE and so on, as the schema of files calls them.
std::optional<Said> SayForSchema(const std::string& word) {
  for (const std::optional<Said>& said : {SayForSchema(word, "METRIC_", MetricWords()),
                                          SayForSchema(word, "COVER_", CoverWords()),
                                          SayForSchema(word, "BORDER_", BorderWords())}) {
    if (said.has_value()) return said;
  }
  return std::nullopt;
}

// What to say for `word`, which may have dots in it; absent: as it is.
std::optional<Said> SayFor(const std::string& word) {
  for (const auto& [name, choice] : kEnumerators) {
    if (word == name) return Said{choice};
  }
  for (const auto& [choice, kind] : DepthKindWords()) {
    if (word == DepthKindName(kind) && word != choice) return Said{choice};
  }
  if (std::optional<Said> choice = SayForSchema(word); choice.has_value()) return choice;
  const std::vector<std::string> path = absl::StrSplit(word, '.');
  const bool is_path = path.size() > 1 && std::all_of(path.begin(), path.end() - 1, IsStructure);
  if (path.size() > 1 && !is_path) return std::nullopt;
  const std::string& field = path.back();
  if (is_path && IsExtension(field)) return std::nullopt;  // the file fit.exr
  if (!is_path && !absl::StrContains(field, '_')) return std::nullopt;
  for (const auto& [name, setting] : kSettings) {
    if (field == name) return Said{setting};
  }
  if (std::optional<std::string> option = OptionFor(field); option.has_value()) {
    return Said{*option, true};
  }
  const bool is_known = path[0] == "options" || path[0] == "rules" || path[0] == "readback" ||
                        std::any_of(std::begin(kWithoutOption),
                                    std::end(kWithoutOption),
                                    [&field](const char* name) { return field == name; });
  if (!is_known) return std::nullopt;
  return Said{absl::StrReplaceAll(field, {{"_", " "}})};
}

bool IsOfWord(char c) { return absl::ascii_isalnum(c) || c == '_' || c == '.'; }

// What a word must not stand behind or before: it would be part of a path or an option.
bool IsOfPath(char c) { return c == '/' || c == '-' || c == '\\' || c == '~'; }

// "--phases: --phases 3, want ...": the option is named once.
std::string WithoutRepetition(const std::string& message) {
  const std::string option = message.substr(0, message.find(": "));
  const bool is_twice = absl::StartsWith(option, "--") &&
                        absl::StartsWith(message, absl::StrCat(option, ": ", option, " "));
  return is_twice ? message.substr(option.size() + 2) : message;
}

}  // namespace

void NameOptionsOf(const CLI::App& verb) { verb_of_messages = &verb; }

std::string InOptionWords(absl::string_view message) {
  // What is wrong within a file that people write is said in the file's words.
  const bool is_of_file = absl::StrContains(absl::AsciiStrToLower(message), ".json: ");
  if (is_of_file) return std::string(message);
  const std::string text = WithPhrases(message);
  std::string result;
  bool is_quoted = false;
  for (size_t i = 0; i < text.size();) {
    if (!IsOfWord(text[i])) {
      is_quoted ^= text[i] == '"';
      result.push_back(text[i++]);
      continue;
    }
    size_t end = i;
    while (end < text.size() && IsOfWord(text[end])) ++end;
    const size_t word_end = end;
    while (end > i + 1 && text[end - 1] == '.') --end;  // the end of a sentence
    const std::string word = text.substr(i, end - i);
    const bool is_free = !is_quoted && (i == 0 || !IsOfPath(text[i - 1])) &&
                         (word_end == text.size() || !IsOfPath(text[word_end]));
    i = end;
    // "options.sizes: no power of two ..." needs no name.
    const std::vector<std::string> path = absl::StrSplit(word, '.');
    if (is_free && (path[0] == "options" || path[0] == "rules") &&
        absl::StartsWith(&text[end], ": ") && std::all_of(path.begin(), path.end(), IsStructure)) {
      i += 2;
      continue;
    }
    const std::optional<Said> said = is_free ? SayFor(word) : std::nullopt;
    result.append(said.has_value() ? said->text : word);
    if (said.has_value() && said->is_option && absl::StartsWith(&text[end], " = ")) i += 2;
  }
  return WithoutRepetition(result);
}

}  // namespace lightfit::cli
