#include "cli/command_line/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>

#include "absl/strings/str_cat.h"
#include "base/verbose.h"
#include "base/version.h"
#include "cli/allocate.h"
#include "cli/command_line/completion.h"
#include "cli/command_line/file_options.h"
#include "cli/command_line/man_page.h"
#include "cli/command_line/option_words.h"
#include "cli/command_line/standard_streams.h"
#include "cli/command_line/unknown_words.h"
#include "cli/compare.h"
#include "cli/exit_code.h"
#include "cli/fit.h"
#include "cli/flags/choice_option.h"
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
    "Exit codes: 0 done, 1 wrong usage, 2 an input or output cannot be used, or nothing was "
    "fitted,\n"
    "3 done but for some lights, which are named on stderr.\n"
    "A file named - is standard input or output. lightfit completion bash and lightfit man print\n"
    "what shells complete by, and the manual.\n"
    "Try: lightfit help fit";

const std::string& VersionText() {
  static const auto& text = *new std::string(absl::StrCat("lightfit ", kVersion));
  return text;
}

constexpr char kServe[] = "serve";  // takes no read-back, and logs

// Options that all verbs have.
void DeclareCommon(CLI::App* verb) {
  verb->set_version_flag("-V,--version", VersionText(), "Print the version")->group("");
  if (verb->get_name() == kServe) return;
  verb->add_flag_callback(
          "-v,--verbose",
          [] { SetVerbose(true); },
          "Say on stderr what is read, what is searched and how long each step takes")
      ->group("Output");
  PrepareFileOptions(verb);
}

int PrintText(const std::string& text) {
  const bool is_written = std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
  return is_written ? kExitOk : kExitBadInput;
}

using Script = std::string (*)(const CLI::App& app);

// What no list of verbs has.
void DeclareCompletion(CommandLine* line) {
  static const Words<Script> shells = {
      {"bash", BashCompletion}, {"zsh", ZshCompletion}, {"fish", FishCompletion}};
  CLI::App* verb = line->app->add_subcommand("completion", "What a shell completes lightfit by");
  const auto script = std::make_shared<Script>();
  AddChoice(verb, "shell", shells, script.get(), "The shell")->required();
  verb->group("");
  line->verbs.emplace_back(verb,
                           [app = line->app.get(), script] { return PrintText((*script)(*app)); });
}

void DeclareMan(CommandLine* line) {
  CLI::App* verb = line->app->add_subcommand("man", "The manual, for man -l");
  const auto name = std::make_shared<std::string>();
  const auto folder = std::make_shared<std::string>();
  verb->add_option("verb", *name, "Of this verb [of the program]")->type_name("VERB");
  verb->add_option("--folder", *folder, "Write all pages into this folder")->type_name("FOLDER");
  verb->group("");
  line->verbs.emplace_back(verb, [app = line->app.get(), name, folder] {
    if (!folder->empty()) {
      const absl::Status status = WriteManPages(*app, *folder);
      return status.ok() ? kExitOk : Fail(kExitBadInput, status);
    }
    const absl::StatusOr<std::string> page = ManPage(*app, *name);
    return page.ok() ? PrintText(*page) : Fail(kExitUsage, page.status());
  });
}

int Refuse(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> parsed = app.get_subcommands();
  if (!parsed.empty()) NameOptionsOf(*parsed.front());
  PrintError(UsageErrorText(app, error));
  std::fprintf(stderr,
               "Run lightfit %s%s--help for the options.\n",
               parsed.empty() ? "" : parsed.front()->get_name().c_str(),
               parsed.empty() ? "" : " ");
  return kExitUsage;
}

bool IsCommonFlag(const std::string& word) {
  return word == "-q" || word == "--quiet" || word == "-v" || word == "--verbose";
}

}  // namespace

CommandLine MakeCommandLine() {
  CommandLine line;
  line.app =
      std::make_unique<CLI::App>("Fits shadow-map matrices to what the camera sees.", "lightfit");
  CLI::App& app = *line.app;
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.set_version_flag("-V,--version", VersionText(), "Print the version");
  app.require_subcommand(1);
  app.footer(kFooter);
  for (const Verb& verb : kVerbs) {
    CLI::App* subcommand = app.add_subcommand(verb.name, verb.summary);
    line.verbs.emplace_back(subcommand, verb.declare(subcommand));
    DeclareCommon(subcommand);
  }
  DeclareCompletion(&line);
  DeclareMan(&line);
  return line;
}

std::vector<std::string> PlainWords(std::vector<std::string> words) {
  // "-q fit a.exr" becomes "fit a.exr -q".
  std::rotate(
      words.begin(), std::find_if_not(words.begin(), words.end(), IsCommonFlag), words.end());
  if (words.empty()) return words;
  if (words[0] == "version") return {"--version"};
  if (words[0] != "help") return words;
  words.erase(words.begin());
  if (words.empty()) return {"--help"};
  return {words[0], "--help"};
}

int RunCommandLine(const std::vector<std::string>& words) {
  StandardStreams streams;
  const CommandLine line = MakeCommandLine();
  std::vector<std::string> reversed = PlainWords(words);  // as CLI11 wants them
  std::reverse(reversed.begin(), reversed.end());
  try {
    line.app->parse(std::move(reversed));
  } catch (const CLI::ParseError& error) {
    // "lightfit fti --help" is no call for help.
    const bool is_understood =
        !line.app->get_subcommands().empty() || line.app->remaining().empty();
    return error.get_exit_code() == 0 && is_understood ? line.app->exit(error)
                                                       : Refuse(*line.app, error);
  }
  for (const auto& [verb, run] : line.verbs) {
    if (!verb->parsed()) continue;
    NameOptionsOf(*verb);
    streams.Begin();
    const int code = run();
    std::fflush(stdout);
    const absl::Status status = streams.Finish();
    return status.ok() ? code : Fail(kExitBadInput, status);
  }
  return kExitUsage;
}

}  // namespace lightfit::cli
