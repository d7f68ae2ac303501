#include "cli/command_line/unknown_words.h"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "base/suggest.h"
#include "cli/command_line/file_kinds.h"

namespace lightfit::cli {
namespace {

// What other programs call an option of ours. Of several the first that the verb has counts.
constexpr std::pair<const char*, const char*> kSynonyms[] = {
    {"--silent", "--quiet"},     {"--debug", "--verbose"},      {"--trace", "--verbose"},
    {"--resolution", "--map"},   {"--map-size", "--map"},       {"--res", "--map"},
    {"--width", "--map"},        {"--height", "--map"},         {"--light-file", "--lights"},
    {"--jobs", "--threads"},     {"-j", "--threads"},           {"--overwrite", "--force"},
    {"-f", "--force"},           {"--yes", "--force"},          {"--cascades", "--maps"},
    {"--splits", "--maps"},      {"--filter", "--guard"},       {"--kernel", "--guard"},
    {"--image", "--picture"},    {"--png", "--picture"},        {"--plot", "--picture"},
    {"--exclude", "--only"},     {"--select", "--only"},        {"--znear", "--near"},
    {"--zfar", "--far"},         {"--near-clip", "--near"},     {"--far-clip", "--far"},
    {"--algorithm", "--search"}, {"--method", "--search"},      {"--api", "--clip"},
    {"--convention", "--clip"},  {"--clip-space", "--clip"},    {"--margin", "--margin-percent"},
    {"--fov", "--camera"},       {"--eye", "--camera"},         {"--out", "--output"},
    {"--out", "--json"},         {"--output", "--json"},        {"-o", "--json"},
    {"--matrices", "--matrix"},  {"--suns", "--random-lights"}, {"--port", "--listen"},
    {"--address", "--listen"},   {"--host", "--listen"},        {"--bind", "--listen"},
};

bool IsOption(const std::string& word) {
  return word.find_first_not_of('-') != std::string::npos && word.front() == '-' &&
         !absl::ascii_isdigit(word[1]) && word[1] != '.';
}

// Without their dashes.
std::vector<std::string> OptionNames(const CLI::App& verb) {
  std::vector<std::string> names;
  for (const CLI::Option* option : verb.get_options()) {
    names.insert(names.end(), option->get_lnames().begin(), option->get_lnames().end());
  }
  return names;
}

// "--foo (did you mean --foot?)".
std::string UnknownOptionText(const CLI::App& verb, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  std::vector<std::string> meant;
  for (const auto& [other, ours] : kSynonyms) {
    if (meant.empty() && absl::EqualsIgnoreCase(name, other) &&
        verb.get_option_no_throw(ours) != nullptr) {
      meant.emplace_back(ours);
    }
  }
  if (meant.empty()) {
    // Without dashes, so that "-map" is "--map" and "--channel" the end of "--depth-channel".
    meant = LikelyMeant(name.substr(name.find_first_not_of('-')), OptionNames(verb));
    for (std::string& option : meant) option.insert(0, "--");
  }
  return meant.empty() ? name
                       : absl::StrCat(name, " (did you mean ", absl::StrJoin(meant, " or "), "?)");
}

std::string UnknownOptionsText(const CLI::App& app, const CLI::App& verb) {
  std::vector<std::string> unknown;
  for (const std::string& word : verb.remaining()) {
    if (IsOption(word)) unknown.push_back(UnknownOptionText(verb, word));
  }
  if (unknown.empty()) return "";
  const std::string owner =
      &verb == &app ? app.get_name() : absl::StrCat(app.get_name(), " ", verb.get_name());
  return absl::StrCat(owner,
                      " has no ",
                      unknown.size() == 1 ? "option " : "options ",
                      absl::StrJoin(unknown, ", "));
}

// The verb for a file that stands where a verb should.
std::string VerbForFile(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return "shot ";
  const std::string lower = absl::AsciiStrToLower(path);
  if (absl::EndsWith(lower, ".exr")) return "fit ";
  if (absl::EndsWith(lower, ".summary")) return "fit --summary ";
  for (const char* extension : {".glb", ".gltf", ".obj", ".ply"}) {
    if (absl::EndsWith(lower, extension)) return "compare ";
  }
  return "";
}

std::string NoVerbText(const CLI::App& app) {
  std::vector<std::string> verbs;
  for (const CLI::App* verb : app.get_subcommands({})) {
    if (!verb->get_group().empty()) verbs.push_back(verb->get_name());
  }
  const std::string list = absl::StrJoin(verbs, ", ");
  for (const std::string& word : app.remaining()) {
    if (IsOption(word)) continue;
    const std::string verb = VerbForFile(word);
    if (!verb.empty()) {
      return absl::StrCat(
          "what is to be done with ", word, "? Say a verb first: lightfit ", verb, word, " ...");
    }
    return absl::StrCat(
        "there is no verb \"", word, "\", want one of ", list, DidYouMean(word, verbs));
  }
  const std::string unknown = UnknownOptionsText(app, app);
  return unknown.empty() ? absl::StrCat("want a verb: one of ", list) : unknown;
}

// What is left over of a verb that takes one thing, and what takes several.
std::string TooManyText(const CLI::App& verb) {
  const std::vector<std::string> words = verb.remaining();
  if (words.empty()) return "";
  std::string text = absl::StrCat("\"", absl::StrJoin(words, "\", \""), "\": ");
  for (const CLI::Option* option : verb.get_options()) {
    if (!option->get_positional()) continue;
    const std::vector<std::string> given = option->results();
    absl::StrAppend(&text,
                    "lightfit ",
                    verb.get_name(),
                    " takes one ",
                    option->get_type_name(),
                    given.empty() ? "" : absl::StrCat(", and has ", given.front()));
    if (verb.get_name() == "fit" || verb.get_name() == "allocate") {
      absl::StrAppend(&text,
                      "; for the frames of a shot lightfit shot, for one map for several "
                      "read-backs lightfit summarize and then lightfit ",
                      verb.get_name(),
                      " --summary");
    }
    return text;
  }
  return absl::StrCat(text, "lightfit ", verb.get_name(), " takes options only");
}

// Every option that is required and absent.
std::string MissingText(const CLI::App& verb) {
  std::vector<std::string> missing;
  for (const CLI::Option* option : verb.get_options()) {
    if (!option->get_required() || option->count() > 0) continue;
    missing.push_back(option->get_positional()
                          ? option->get_type_name()
                          : absl::StrCat(option->get_name(), " ", option->get_type_name()));
  }
  if (missing.empty()) return "";
  return absl::StrCat("lightfit ", verb.get_name(), " wants ", absl::StrJoin(missing, " and "));
}

}  // namespace

std::string UsageErrorText(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> verbs = app.get_subcommands();
  if (verbs.empty()) return NoVerbText(app);
  const CLI::App& verb = *verbs.front();
  if (std::string text = UnknownOptionsText(app, verb); !text.empty()) return text;
  if (std::string text = UnknownOptionsText(app, app); !text.empty()) return text;
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) return TooManyText(verb);
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr) {
    if (std::string text = MissingText(verb); !text.empty()) return text;
  }
  return error.what();
}

}  // namespace lightfit::cli
