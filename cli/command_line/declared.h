// cli/command_line/declared.h
//
// What the verbs declare, for those who tell of it: completion and the manual.
// In:   the program with its verbs.
// Out:  verbs, options and positionals that are not hidden, in the order of their declaration.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace lightfit::cli {

std::vector<const CLI::App*> DeclaredVerbs(const CLI::App& app);
std::vector<const CLI::Option*> DeclaredOptions(const CLI::App& verb);

// What stands without an option's name; null where the verb has none. No verb has two.
const CLI::Option* DeclaredPositional(const CLI::App& verb);

// "-q", "--quiet".
std::vector<std::string> NamesOf(const CLI::Option& option);

// What may stand for the value, "FILE.json"; without the limits that the help adds.
std::string ValueWord(const CLI::Option& option);

}  // namespace lightfit::cli
