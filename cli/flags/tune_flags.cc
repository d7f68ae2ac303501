#include "cli/flags/tune_flags.h"

#include <CLI/CLI.hpp>

#include "absl/strings/str_cat.h"
#include "cli/flags/choice_option.h"
#include "cli/flags/number_checks.h"
#include "cli/flags/standard_streams.h"

namespace lightfit::cli {
namespace {

constexpr char kExamples[] =
    "Examples:\n"
    "  lightfit tune sponza.glb --camera 3.5,1.7,-4.2:-9,2.2,-4.4:55 --light sun=sun:1,-3,0.5 \\\n"
    "      --map 2048x2048 --screen 1920x1080 --json sun.json\n"
    "  lightfit tune generate:kind=room,seed=5 --camera 2.3,1.6,3.3:-1.2,0.7,-1.5:65 \\\n"
    "      --light sun=sun:1,-0.6,-0.25 --map 400x400 --evaluations 2000 --json room.json\n"
    "\n"
    "Starts from the fit, moves the map in all its eight degrees of freedom, and counts the wrong\n"
    "pixels of each move by ray casting: minutes for a light, for shots that are rendered for "
    "hours.\n"
    "Goes on where it was stopped when it is called again with the same words, and with more\n"
    "--evaluations from where it ended. The JSON file is that of lightfit fit.";

}  // namespace

std::string TuneFlags::JournalPath() const {
  if (!journal_path.empty()) return journal_path;
  // A stream has nothing beside it.
  const bool has_file = !json_path.empty() && WithStreamNames(json_path) == json_path;
  return has_file ? absl::StrCat(json_path, ".journal") : "";
}

void DeclareTuneFlags(CLI::App* app, TuneFlags* flags) {
  DeclareSceneFlags(app, &flags->compare.scene);
  app->get_option("--seed")->description("Of the random lights and of the search [1]");
  DeclareSizeFlags(app, &flags->compare);
  const std::string group = "Search";
  app->add_option("--evaluations",
                  flags->evaluations,
                  "Maps that are tried for each light, by casting the rays of them all [600]")
      ->type_name("N")
      ->check(CLI::Range(1, 10'000'000))
      ->group(group);
  AddChoice(
      app,
      "--bias",
      BiasWords(),
      &flags->bias,
      "Whose wrong pixels are to be few: of sampling alone, or with a renderer's bias [ideal]")
      ->group(group);
  app->add_option("--bias-share",
                  flags->compare.judge.constant_share,
                  "Constant part of the practical bias, of the receivers' range of distances from "
                  "the light [0.0002]")
      ->type_name("SHARE")
      ->check(NumberIn(0.0, 1.0))
      ->group(group);
  DeclareMethodFlags(app, &flags->compare.fit.options);
  const std::string output = "Output";
  app->add_option("--json", flags->json_path, "Write matrices and figures to this file")
      ->type_name("FILE.json")
      ->group(output);
  DeclareClipFlag(app, output, &flags->clip);
  app->add_option("--journal",
                  flags->journal_path,
                  "Where the values of tried maps are kept, to go on from [with --json FILE: "
                  "FILE.journal]")
      ->type_name("FILE")
      ->group(output);
  DeclareLegendFlag(app, output, &flags->compare.legend);
  app->add_flag("-q,--quiet", flags->quiet, "No table and no progress; errors and warnings only")
      ->group(output);
  app->footer(kExamples);
}

}  // namespace lightfit::cli
