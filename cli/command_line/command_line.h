// cli/command_line/command_line.h
//
// `lightfit VERB ...`: the verbs with their options, and from them what answers a command line,
// help, completion and the manual.
// In:   the words behind the program's name.
// Out:  an exit code.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
}

namespace lightfit::cli {

struct CommandLine {
  std::unique_ptr<CLI::App> app;

  // What each of its verbs does once it is parsed.
  std::vector<std::pair<CLI::App*, std::function<int()>>> verbs;
};

CommandLine MakeCommandLine();

// As people write it, in the form that is parsed: "help fit" is "fit --help", and what stands
// before the verb, "-q fit", belongs behind it.
std::vector<std::string> PlainWords(std::vector<std::string> words);

int RunCommandLine(const std::vector<std::string>& words);

}  // namespace lightfit::cli
