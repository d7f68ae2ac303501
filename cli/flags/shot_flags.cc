#include "cli/flags/shot_flags.h"

#include <CLI/CLI.hpp>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "cli/flags/fit_inputs.h"
#include "cli/flags/frame_inputs.h"
#include "cli/flags/number_checks.h"
#include "cli/flags/readback_flags.h"
#include "io/summary_file.h"
#include "jobs/fit_comparison.h"

namespace lightfit::cli {
namespace {

constexpr char kExamples[] =
    "Examples:\n"
    "  lightfit shot readbacks/walk --lights scene.json\n"
    "  lightfit shot readbacks/walk --lights scene.json --tracked --stability 0.8 -o walk_stable\n"
    "  lightfit shot frames.txt --lights scene.json --per-shot --map 2048x2048 --clip opengl\n"
    "  lightfit shot readbacks/walk --lights scene.json --maps 4 --texels 2048x2048\n"
    "\n"
    "Writes into the output folder:\n"
    "  per-frame/FRAME.json  every frame its own best matrix: finest, and it crawls\n"
    "  tracked/FRAME.json    a matrix is kept while it is good enough, or moved by whole texels\n"
    "  per-shot/FRAME.json   one matrix per light for the whole shot: it never crawls;\n"
    "  per-shot.json         ... the same matrix once\n"
    "  summaries/            what per-shot was fitted to, for lightfit fit --summary; not with "
    "--maps\n"
    "  shot.csv, shot.png    energy, footprint and crawl of every frame\n"
    "With --maps a light has a plan of several maps wherever it would have a matrix; when tracked\n"
    "each map is kept, moved by whole texels or replaced by itself.\n"
    "\n"
    "Frames go by the numbers of their names, below zero and between frames too, and so do their\n"
    "cameras and lights in files of several frames. Frames that are missing are named.\n"
    "\n"
    "A run that was stopped goes on where it was: a frame whose file, lights and options are the\n"
    "same is not computed again, and results are the same to the last byte. A frame that cannot\n"
    "be used is named and the others go on.\n"
    "Energy ratios need --per-frame too. Units: positions in world units, maps in texels,\n"
    "footprints and crawl in read-back pixels.";

void DeclareModes(CLI::App* app, ShotFlags* flags) {
  const std::string group = "Modes, all three unless some are named";
  app->add_flag("--per-frame", flags->per_frame, "Every frame has its own best matrix")
      ->group(group);
  app->add_flag("--tracked",
                flags->tracked,
                "A matrix is kept from frame to frame while it is good enough")
      ->group(group);
  app->add_flag("--per-shot", flags->per_shot, "One matrix per light for all frames")->group(group);
}

// The published algorithm has a per-frame form, and a tracked one in its rule of when to keep an
// axis. It goes through samples, of which a sum over the shot has none.
void CheckModes(const ShotFlags& flags) {
  if (!flags.fit.as_published || !flags.per_shot) return;
  throw CLI::ValidationError(
      "--as-published",
      "does not go with --per-shot: the published algorithm goes through the "
      "samples of one frame; --search line runs on those of all");
}

void DeclareTracker(CLI::App* app, ShotFlags* flags) {
  const std::string group = "Tracked";
  app->add_option("--stability",
                  flags->stability,
                  "0: the tightest map in every frame; 1: a map stays as long as it is valid [0.5]")
      ->type_name("0...1")
      ->check(NumberIn(0.0, 1.0))
      ->group(group);
  app->add_option("--replace-below",
                  flags->replace_below,
                  "A map is replaced when the median squared footprint falls below this share of "
                  "what it is with the one that is kept [by --stability]")
      ->type_name("SHARE")
      ->check(NumberIn(0.0, std::numeric_limits<double>::infinity()))
      ->group(group);
  app->add_option("--update-every",
                  flags->update_every_frames,
                  "Look for a better map in every n-th frame alone [by --stability]")
      ->type_name("FRAMES")
      ->check(CLI::PositiveNumber)
      ->group(group);
  app->add_option("--cover-margin-percent",
                  flags->cover_margin_percent,
                  "A new map makes this much room on every side for what comes into view, on top "
                  "of --margin-percent [by --stability]")
      ->type_name("PERCENT")
      ->check(NumberIn(0.0, 1000.0))
      ->group(group);
}

void DeclareOutput(CLI::App* app, ShotFlags* flags) {
  const std::string group = "Output";
  app->add_option("-o,--output",
                  flags->output,
                  "Folder for results, made where it is not there [SHOT_lightfit in the current "
                  "folder]")
      ->type_name("FOLDER")
      ->group(group);
  app->add_flag("--force", flags->force, "Compute again what is there already")->group(group);
  app->add_option("--threads", flags->num_threads, "At most this many [one per processor]")
      ->type_name("COUNT")
      ->check(CLI::Range(1, 1024))
      ->group(group);
  DeclareLegendFlag(app, group, &flags->fit.legend);
  app->add_flag(
         "-q,--quiet", flags->fit.quiet, "No table and no progress; errors and warnings only")
      ->group(group);
}

std::vector<std::string> NotesOf(const FrameList& list) {
  std::vector<std::string> notes;
  if (!list.reordered.empty()) notes.push_back(list.reordered);
  if (!list.apart.empty()) {
    notes.push_back(list.apart + ": crawl is from one of these to the next");
  }
  if (!list.missing.empty()) {
    notes.push_back(list.missing +
                    ": one map for the shot is not made for what is missing, and crawl is not "
                    "counted over the gap");
  }
  return notes;
}

}  // namespace

void DeclareShotFlags(CLI::App* app, ShotFlags* flags) {
  flags->fit.options.border = BorderChoice::kAutomatic;
  const std::string input = "Input";
  app->add_option("frames",
                  flags->inputs,
                  "A folder of read-backs (its *.exr), a text file with one path per line, EXR "
                  "files, or a pattern such as 'shot.####.exr', 'shot.%04d.exr' or 'shot.*.exr'")
      ->required()
      ->type_name("FOLDER|LIST|PATTERN|READBACK.exr");
  DeclareLightFlags(app, &flags->fit.lights, input);
  DeclareOnlyFlag(app, input, &flags->fit.only);
  DeclareReadbackFlags(app, input, &flags->fit);
  DeclareCameraFlags(
      app, "Camera; --frame is that of the first read-back, one camera is for all", &flags->fit);
  DeclareMapFlags(app, "Map", &flags->fit);
  DeclarePlanFlags(app, flags->fit.map, &flags->fit.plan);
  DeclareMethodFlags(app, &flags->fit.options);
  app->add_flag("--as-published",
                flags->fit.as_published,
                "Chong and Gortler's Algorithm 1 and their rule of when to keep an axis: per frame "
                "and tracked")
      ->excludes(app->get_option("--search"))
      ->excludes(app->get_option("--affine"))
      ->excludes(app->get_option("--metric"))
      ->excludes(app->get_option("--cover"))
      ->excludes(app->get_option("--border"))
      ->group("Method");
  DeclareModes(app, flags);
  DeclareTracker(app, flags);
  app->get_option("--as-published")->excludes(app->get_option("--stability"));
  app->add_option("--rounds",
                  flags->rounds,
                  "Times that the whole shot is read again to weigh samples in its own map (l1 "
                  "metrics) [2]")
      ->type_name("COUNT")
      ->check(CLI::Range(0, 100))
      ->group("Per shot");
  DeclareOutput(app, flags);
  app->footer(kExamples);
  app->callback([app, flags] {
    CheckPlanFlags(*app, flags->fit.map, &flags->fit.plan);
    CheckModes(*flags);
    for (const std::string& input : flags->inputs) {
      if (!IsSummaryFile(input)) continue;
      throw CLI::ValidationError(
          input,
          "is a summary, and has no frames of its own: lightfit fit --summary fits one map to all "
          "of them");
    }
  });
}

TrackerOptions TrackerOptionsOf(const ShotFlags& flags) {
  const bool as_published = flags.fit.as_published;
  TrackerOptions options =
      as_published ? TrackerOptions::AsPublished() : TrackerOptions::ForStability(flags.stability);
  options.fit = as_published ? FitOptions::AsPublished(flags.fit.options) : flags.fit.options;
  options.replace_below = flags.replace_below.value_or(options.replace_below);
  options.update_every_frames = flags.update_every_frames.value_or(options.update_every_frames);
  options.cover_margin_percent = flags.cover_margin_percent.value_or(options.cover_margin_percent);
  return options;
}

std::optional<PlanTrackerOptions> PlanTrackerOptionsOf(const ShotFlags& flags) {
  const std::optional<PlanOptions> plan = PlanOptionsOf(flags.fit.plan, flags.fit.options);
  if (!plan.has_value()) return std::nullopt;
  PlanTrackerOptions options = PlanTrackerOptions::ForStability(flags.stability);
  options.plan = *plan;
  options.update_every_frames = flags.update_every_frames.value_or(options.update_every_frames);
  options.cover_margin_percent = flags.cover_margin_percent.value_or(options.cover_margin_percent);
  return options;
}

absl::StatusOr<ShotJob> MakeShotJob(const ShotFlags& flags) {
  absl::StatusOr<FrameList> list = ListFrames(flags.inputs);
  if (!list.ok()) return list.status();
  const absl::StatusOr<FrameInputs> inputs = FrameInputs::ForShot(flags.fit, *list);
  if (!inputs.ok()) return inputs.status();
  const ShotFrame& first = list->frames.front();
  absl::StatusOr<FrameLights> lights = inputs->LightsOf(first.path, first.number);
  if (!lights.ok()) return lights.status();

  ShotJob job;
  job.name = list->shot;
  job.frames = std::move(list->frames);
  job.lights = std::move(lights->lights);
  job.notes = NotesOf(*list);
  const bool all = !flags.per_frame && !flags.tracked && !flags.per_shot;
  const bool sums_up = all && !flags.fit.as_published;  // see CheckModes()
  job.modes = {all || flags.per_frame, all || flags.tracked, sums_up || flags.per_shot};
  job.map = flags.fit.map;
  job.clip = flags.fit.clip;
  job.tracker = TrackerOptionsOf(flags);
  job.plans = PlanTrackerOptionsOf(flags);
  job.rounds = flags.rounds;
  job.folder = flags.output.empty() ? job.name + "_lightfit" : flags.output;
  job.force = flags.force;
  job.num_threads = flags.num_threads > 0 ? flags.num_threads : NumProcessors();
  job.quiet = flags.fit.quiet;

  for (ShotFrame& frame : job.frames) {
    frame.exr = inputs->ReadingOf(frame.path, frame.number);
    if (!inputs->HasMovingLights()) continue;
    absl::StatusOr<FrameLights> own = inputs->LightsOf(frame.path, frame.number);
    if (own.ok()) {
      frame.lights = std::move(own->lights);
      frame.absent_lights = std::move(own->absent);
    } else {
      frame.exr = own.status();
    }
  }
  job.FindMotion();
  // A camera file without even the first is a mistake of the command line.
  if (!job.frames.front().exr.ok()) return job.frames.front().exr.status();
  return job;
}

}  // namespace lightfit::cli
