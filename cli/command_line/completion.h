// cli/command_line/completion.h
//
// What bash, zsh and fish complete `lightfit` by, from the declarations of its verbs: verbs,
// options, choices, and files of the kind that an option takes.
// In:   the program with its verbs.
// Out:  a script for the shell.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace lightfit::cli {

std::string BashCompletion(const CLI::App& app);
std::string ZshCompletion(const CLI::App& app);
std::string FishCompletion(const CLI::App& app);

}  // namespace lightfit::cli
