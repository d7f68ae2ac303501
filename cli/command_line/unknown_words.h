// cli/command_line/unknown_words.h
//
// What to say of a command line that could not be understood.
// In:   the program with its verbs, after parsing failed; the error that CLI11 has for it.
// Out:  one message: all options that there are not, with those that may have been meant; else a
//       verb that there is not, words too many, what is missing.
#pragma once

#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace lightfit::cli {

std::string UsageErrorText(const CLI::App& app, const CLI::ParseError& error);

}  // namespace lightfit::cli
