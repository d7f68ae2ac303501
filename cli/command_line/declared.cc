#include "cli/command_line/declared.h"

#include <CLI/CLI.hpp>

#include "absl/strings/str_cat.h"

namespace lightfit::cli {

std::vector<const CLI::App*> DeclaredVerbs(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* verb) { return !verb->get_group().empty(); });
}

std::vector<const CLI::Option*> DeclaredOptions(const CLI::App& verb) {
  return verb.get_options([](const CLI::Option* option) {
    return !option->get_positional() && !option->get_group().empty();
  });
}

const CLI::Option* DeclaredPositional(const CLI::App& verb) {
  const std::vector<const CLI::Option*> positionals =
      verb.get_options([](const CLI::Option* option) { return option->get_positional(); });
  return positionals.empty() ? nullptr : positionals.front();
}

std::vector<std::string> NamesOf(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back(absl::StrCat("-", name));
  for (const std::string& name : option.get_lnames()) names.push_back(absl::StrCat("--", name));
  return names;
}

std::string ValueWord(const CLI::Option& option) {
  std::string word = option.get_type_name();
  // The checks of CLI11 put themselves behind a colon: "COUNT:INT in [1 - 32]", "N:POSITIVE".
  for (const char* check : {":INT in", ":FLOAT in", ":POSITIVE", ":NONNEGATIVE", ":FILE", ":{"}) {
    const size_t at = word.rfind(check);
    if (at != std::string::npos) return word.substr(0, at);
  }
  return word;
}

}  // namespace lightfit::cli
