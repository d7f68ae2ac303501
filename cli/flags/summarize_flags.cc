#include "cli/flags/summarize_flags.h"

#include <CLI/CLI.hpp>

#include "cli/flags/readback_flags.h"

namespace lightfit::cli {
namespace {

constexpr char kExamples[] =
    "Examples:\n"
    "  lightfit summarize 0007.exr --lights scene.json -o 0007.summary\n"
    "  lightfit summarize *.summary -o shot.summary\n"
    "  lightfit fit --summary shot.summary --map 2048x2048 --json shot.json\n"
    "\n"
    "A summary has what fit needs to know of any number of frames, about two kilobytes per light.\n"
    "The same frames give the same file to the last byte in whatever order and groups they are\n"
    "added. Lights, metric and cover must be the same; a frame that is in two of the inputs is\n"
    "refused, and so is an output among the inputs. Folders and patterns ('shot.####.exr') are\n"
    "read-backs, as for shot. With several read-backs --frame is that of the first, and the "
    "others\n"
    "count on from it by their numbers.\n"
    "The l1 metrics weigh samples by a map: each frame's own best one, or for a closer fit of a\n"
    "whole shot the maps of a first round, --weigh-by shot.json.";

}  // namespace

void DeclareSummarizeFlags(CLI::App* app, SummarizeFlags* flags) {
  const std::string group = "Input";
  app->add_option("inputs",
                  flags->inputs,
                  "OpenEXR files, folders or patterns of them, and summary files to add")
      ->required()
      ->type_name("READBACK.exr|FILE.summary");
  DeclareLightFlags(app, &flags->fit.lights, group);
  DeclareOnlyFlag(app, group, &flags->fit.only);
  DeclareReadbackFlags(app, group, &flags->fit);
  DeclareCameraFlags(app, "Camera", &flags->fit);
  DeclareSummingFlags(app, &flags->fit.options);
  app->add_option("--weigh-by",
                  flags->weigh_by_path,
                  "l1 metrics: weigh samples by the maps in this result of lightfit fit [by each "
                  "frame's own best map]")
      ->type_name("RESULT.json")
      ->group("Method");
  app->add_option("-o,--output", flags->output_path, "Write the summary to this file")
      ->required()
      ->type_name("FILE.summary")
      ->group("Output");
  app->add_flag(
         "-q,--quiet", flags->fit.quiet, "No figures and no progress; errors and warnings only")
      ->group("Output");
  app->footer(kExamples);
  app->callback([app, flags] {
    flags->fit.has_metric = app->count("--metric") > 0;
    flags->fit.has_cover = app->count("--cover") > 0;
  });
}

}  // namespace lightfit::cli
