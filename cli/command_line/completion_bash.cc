#include <CLI/CLI.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/strip.h"
#include "cli/command_line/completion.h"
#include "cli/command_line/declared.h"
#include "cli/command_line/file_kinds.h"

namespace lightfit::cli {
namespace {

constexpr char kStart[] =
    R"(# Completion of lightfit for bash, as `lightfit completion bash` prints it.

_lightfit_words() {
  mapfile -t COMPREPLY < <(compgen -W "$1" -- "$word")
}

# Files of these extensions, all without any; and folders on the way to them.
_lightfit_files() {
  local extension
  compopt -o filenames 2> /dev/null
  if (($# == 0)); then
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
    return
  fi
  mapfile -t COMPREPLY < <(
    compgen -d -- "$word"
    for extension in "$@" "${@^^}"; do compgen -f -X "!*.$extension" -- "$word"; done
  )
}

_lightfit_folders() {
  compopt -o filenames 2> /dev/null
  mapfile -t COMPREPLY < <(compgen -d -- "$word")
}

_lightfit() {
  local word=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} verb='' i
  # --option=value, and NAME=FILE, are three words here.
  if [[ $word == '=' ]]; then
    word=''
  elif [[ $previous == '=' ]]; then
    previous=${COMP_WORDS[COMP_CWORD - 2]}
    [[ $previous == -* ]] || previous=${COMP_WORDS[COMP_CWORD - 3]}
  fi
  for ((i = 1; i < COMP_CWORD; i++)); do
    [[ ${COMP_WORDS[i]} == -* ]] && continue
    verb=${COMP_WORDS[i]}
    break
  done
  COMPREPLY=()
  case $verb in
)";

constexpr char kEnd[] = R"(  esac
}

complete -F _lightfit lightfit
)";

std::string Extensions(const OptionKind& kind) {
  std::string text;
  for (const std::string& extension : kind.extensions) {
    absl::StrAppend(&text, " ", absl::StripPrefix(extension, "."));
  }
  return text;
}

// The command that completes a value.
std::string CommandFor(const OptionKind& kind) {
  if (!kind.choices.empty()) {
    return absl::StrCat("_lightfit_words '", absl::StrJoin(kind.choices, " "), "'");
  }
  // Lists have any name.
  if (kind.has_file) return absl::StrCat("_lightfit_files", kind.has_list ? "" : Extensions(kind));
  if (kind.has_folder) return "_lightfit_folders";
  return "";
}

std::string VerbCase(const CLI::App& verb) {
  std::string cases;
  std::vector<std::string> all, others;
  for (const CLI::Option* option : DeclaredOptions(verb)) {
    const std::vector<std::string> names = NamesOf(*option);
    all.insert(all.end(), names.begin(), names.end());
    const OptionKind kind = KindOf(*option);
    if (kind.is_flag) continue;
    const std::string command = CommandFor(kind);
    if (command.empty()) {
      others.insert(others.end(), names.begin(), names.end());
    } else {
      absl::StrAppend(&cases, "        ", absl::StrJoin(names, " | "), ") ", command, " ;;\n");
    }
  }
  if (!others.empty()) absl::StrAppend(&cases, "        ", absl::StrJoin(others, " | "), ") ;;\n");
  const CLI::Option* positional = DeclaredPositional(verb);
  const std::string command = positional == nullptr ? "" : CommandFor(KindOf(*positional));
  return absl::StrCat(
      "    ",
      verb.get_name(),
      ")\n      case $previous in\n",
      cases,
      "        *)\n          if [[ $word == -* ]]; then\n            _lightfit_words '",
      absl::StrJoin(all, " "),
      "'\n",
      command.empty() ? "" : absl::StrCat("          else\n            ", command, "\n"),
      "          fi\n          ;;\n      esac\n      ;;\n");
}

}  // namespace

std::string BashCompletion(const CLI::App& app) {
  std::vector<std::string> verbs;
  std::string cases;
  for (const CLI::App* verb : DeclaredVerbs(app)) {
    verbs.push_back(verb->get_name());
    absl::StrAppend(&cases, VerbCase(*verb));
  }
  const std::string list = absl::StrJoin(verbs, " ");
  return absl::StrCat(kStart,
                      "    '') _lightfit_words '",
                      list,
                      " help --help --version' ;;\n",
                      "    help) _lightfit_words '",
                      list,
                      "' ;;\n",
                      cases,
                      kEnd);
}

}  // namespace lightfit::cli
