// cli/main.cc
//
// `lightfit`: finds the verb, hands over, and turns every outcome into an exit code.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <functional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/version.h"
#include "cli/allocate.h"
#include "cli/compare.h"
#include "cli/exit_code.h"
#include "cli/fit.h"
#include "cli/render.h"
#include "cli/serve.h"
#include "cli/shot.h"
#include "cli/summarize.h"
#include "cli/tune.h"
#include "cli/verb.h"

namespace lightfit::cli {
namespace {

constexpr Verb kVerbs[] = {
    {"allocate",
     "Find the sizes of shadow maps: split a budget of texels, or keep a tolerance",
     DeclareAllocate},
    {"compare", "Compare every method on a scene or a read-back", DeclareCompare},
    {"fit", "Fit the light matrices of one read-back (an EXR file), or of summaries", DeclareFit},
    {"render",
     "Make a read-back with exact shadows from a scene (.glb, .obj, .ply)",
     DeclareRender},
    {"serve", "Serve fits over gRPC, for renderers and farms", DeclareServe},
    {"shot", "Fit all frames of a shot: per frame, tracked, and once for all", DeclareShot},
    {"summarize",
     "Sum up read-backs in small files, for one fit to all (fit --summary)",
     DeclareSummarize},
    {"tune",
     "Search a scene for the matrices of fewest wrong pixels, and say how far the fits were",
     DeclareTune},
};

constexpr char kFooter[] =
    "Exit codes: 0 done, 1 wrong usage, 2 an input or output cannot be used, 3 done but for some\n"
    "lights, which are named on stderr.\n"
    "Try: lightfit fit --help";

int Main(int argc, char** argv) {
  CLI::App app("Fits shadow-map matrices to what the camera sees.", "lightfit");
  app.set_version_flag("--version", absl::StrCat("lightfit ", kVersion));
  app.require_subcommand(1);
  app.footer(kFooter);
  std::vector<std::pair<CLI::App*, std::function<int()>>> verbs;
  for (const Verb& verb : kVerbs) {
    CLI::App* subcommand = app.add_subcommand(verb.name, verb.summary);
    verbs.emplace_back(subcommand, verb.declare(subcommand));
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    PrintError(error.what());
    const bool has_verb = !app.get_subcommands().empty();
    std::fprintf(stderr,
                 "Run lightfit %s%s--help for the options.\n",
                 has_verb ? app.get_subcommands().front()->get_name().c_str() : "",
                 has_verb ? " " : "");
    return kExitUsage;
  }
  for (const auto& [subcommand, run] : verbs) {
    if (subcommand->parsed()) return run();
  }
  return kExitUsage;
}

}  // namespace
}  // namespace lightfit::cli

int main(int argc, char** argv) {
  // The library throws nothing; a library beneath it might, out of memory for one.
  try {
    return lightfit::cli::Main(argc, argv);
  } catch (const std::exception& error) {
    lightfit::cli::PrintError(error.what());
    return lightfit::cli::kExitBadInput;
  }
}
