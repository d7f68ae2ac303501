#include <CLI/CLI.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/strip.h"
#include "cli/command_line/completion.h"
#include "cli/command_line/declared.h"
#include "cli/command_line/file_kinds.h"

namespace lightfit::cli {
namespace {

// The first sentence of what an option means; shells have a line for it.
std::string ShortMeaning(const std::string& description) {
  std::string text = description.substr(0, description.find(". "));
  text = text.substr(0, text.find("; "));
  const size_t default_at = text.rfind(" [");
  return text.substr(0, default_at);
}

std::string InZsh(const std::string& text) {
  return absl::StrReplaceAll(
      text, {{"\\", "\\\\"}, {"'", "'\\''"}, {"[", "\\["}, {"]", "\\]"}, {":", "\\:"}});
}

// What completes a value, behind its name.
std::string ZshAction(const OptionKind& kind) {
  if (!kind.choices.empty()) return absl::StrCat("(", absl::StrJoin(kind.choices, " "), ")");
  if (kind.has_file && (kind.has_list || kind.extensions.empty())) return "_files";
  if (kind.has_file) {
    std::vector<std::string> names;
    for (const std::string& extension : kind.extensions) names.push_back("*" + extension);
    return absl::StrCat("_files -g \"(#i)(", absl::StrJoin(names, "|"), ")\"");
  }
  return kind.has_folder ? "_files -/" : " ";
}

std::string ZshOption(const CLI::Option& option) {
  const std::vector<std::string> names = NamesOf(option);
  const OptionKind kind = KindOf(option);
  const std::string meaning = absl::StrCat("[", InZsh(ShortMeaning(option.get_description())), "]");
  const std::string value =
      kind.is_flag ? "" : absl::StrCat(":", InZsh(ValueWord(option)), ":", ZshAction(kind));
  std::string text;
  for (const std::string& name : names) {
    // Once only, unless it may be repeated.
    const std::string before =
        option.get_items_expected_max() > 1 ||
                option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll
            ? "*"
            : absl::StrCat("(", absl::StrJoin(names, " "), ")");
    const bool is_long = name.size() > 2;
    absl::StrAppend(&text,
                    " \\\n        '",
                    before,
                    name,
                    is_long && !kind.is_flag ? "=" : "",
                    meaning,
                    value,
                    "'");
  }
  return text;
}

std::string ZshVerb(const CLI::App& verb) {
  std::string text = absl::StrCat("      ", verb.get_name(), ")\n        _arguments -s");
  for (const CLI::Option* option : DeclaredOptions(verb))
    absl::StrAppend(&text, ZshOption(*option));
  if (const CLI::Option* positional = DeclaredPositional(verb); positional != nullptr) {
    absl::StrAppend(&text,
                    " \\\n        '",
                    positional->get_items_expected_max() > 1 ? "*" : "1",
                    ":",
                    InZsh(ValueWord(*positional)),
                    ":",
                    ZshAction(KindOf(*positional)),
                    "'");
  }
  return absl::StrCat(text, " ;;\n");
}

std::string InFish(const std::string& text) {
  return absl::StrCat("'", absl::StrReplaceAll(text, {{"\\", "\\\\"}, {"'", "\\'"}}), "'");
}

}  // namespace

std::string ZshCompletion(const CLI::App& app) {
  std::string verbs, cases;
  for (const CLI::App* verb : DeclaredVerbs(app)) {
    absl::StrAppend(
        &verbs, "        '", verb->get_name(), ":", InZsh(verb->get_description()), "'\n");
    absl::StrAppend(&cases, ZshVerb(*verb));
  }
  return absl::StrCat(
      "#compdef lightfit\n# Completion of lightfit for zsh, as `lightfit completion zsh` prints "
      "it.\n\n_lightfit() {\n  local curcontext=\"$curcontext\" state line\n  typeset -A opt_args\n"
      "  _arguments -C '(- *)'{-h,--help}'[Print this help]' \\\n"
      "    '(- *)'{-V,--version}'[Print the version]' '1:verb:->verb' '*::argument:->argument'\n"
      "  case $state in\n    verb)\n      local -a verbs\n      verbs=(\n",
      verbs,
      "        'help:Print the help of a verb'\n      )\n      _describe verb verbs ;;\n"
      "    argument)\n      case $words[1] in\n",
      cases,
      "      esac ;;\n  esac\n}\n\n_lightfit \"$@\"\n");
}

std::string FishCompletion(const CLI::App& app) {
  std::string text =
      "# Completion of lightfit for fish, as `lightfit completion fish` prints it.\n"
      "complete -c lightfit -f\n";
  for (const CLI::App* verb : DeclaredVerbs(app)) {
    absl::StrAppend(&text,
                    "complete -c lightfit -n __fish_use_subcommand -a ",
                    verb->get_name(),
                    " -d ",
                    InFish(verb->get_description()),
                    "\n");
    const std::string seen = absl::StrCat(
        "complete -c lightfit -n '__fish_seen_subcommand_from ", verb->get_name(), "'");
    for (const CLI::Option* option : DeclaredOptions(*verb)) {
      absl::StrAppend(&text, seen);
      for (const std::string& name : NamesOf(*option)) {
        absl::StrAppend(&text,
                        name.size() == 2 ? " -s " : " -l ",
                        absl::StripPrefix(absl::StripPrefix(name, "-"), "-"));
      }
      const OptionKind kind = KindOf(*option);
      if (!kind.choices.empty()) {
        absl::StrAppend(&text, " -x -a '", absl::StrJoin(kind.choices, " "), "'");
      } else if (kind.has_file || kind.has_folder) {
        absl::StrAppend(&text, " -r -F");
      } else if (!kind.is_flag) {
        absl::StrAppend(&text, " -x");
      }
      absl::StrAppend(&text, " -d ", InFish(ShortMeaning(option->get_description())), "\n");
    }
    if (DeclaredPositional(*verb) != nullptr) absl::StrAppend(&text, seen, " -F\n");
  }
  return text;
}

}  // namespace lightfit::cli
