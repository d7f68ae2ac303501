// cli/verb.h
//
// A verb of the command line, `lightfit <verb> ...`: one file pair each, listed in cli/main.cc.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace lightfit::cli {

struct Verb {
  const char* name;
  const char* summary;  // one line for `lightfit --help`

  // Declares the options on `app` and returns what to do once they are parsed: it returns an
  // ExitCode.
  std::function<int()> (*declare)(CLI::App* app);
};

}  // namespace lightfit::cli
