#include "cli/flags/compare_flags.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "cli/flags/choice_option.h"
#include "cli/flags/number_checks.h"
#include "cli/flags/readback_flags.h"
#include "cli/flags/size_flags.h"
#include "jobs/compare/rows.h"

namespace lightfit::cli {
namespace {

constexpr int64_t kMaxTexels = int64_t{1} << 28;  // 16384 x 16384: two gigabytes of depth

constexpr char kExamples[] =
    "Examples:\n"
    "  lightfit compare sponza.glb --camera 3.5,1.7,-4.2:-9,2.2,-4.4:55 --light sun=sun:1,-3,0.5 "
    "\\\n"
    "      --picture methods.png --masks masks\n"
    "  lightfit compare generate --camera 0,1.7,18:0,0.5,0 --random-lights 500 --csv lights.csv\n"
    "  lightfit compare frame.exr --lights scene.json --matrix engine=engine.json\n"
    "  lightfit compare sponza.glb --camera 3.5,1.7,-4.2:-9,2.2,-4.4:55 --light sun=sun:1,-3,0.5 "
    "\\\n"
    "      --camera-step 0.1,0,0,0.5\n"
    "  lightfit compare sponza.glb --camera 3.5,1.7,-4.2:-9,2.2,-4.4:55 --light sun=sun:1,-3,0.5 "
    "\\\n"
    "      --maps 4 --texels 1024x1024 --matrix kept=plan.json\n"
    "\n"
    "Units: positions in world units, images in pixels, maps in texels. A read-back has no true\n"
    "shadows to count wrong or flipped pixels by: it gives energies, footprints and, with\n"
    "--next-readback, drift.\n"
    "--matrix: a result of lightfit fit --json (with --maps: its plans), or {\"map_from_world\":\n"
    "[16 numbers], \"map\": {\"width\": 1024, \"height\": 1024}}, or {\"clip_from_world\":\n"
    "[16 numbers], \"clip\": \"opengl\"}; with \"border\": \"dark\" where look-ups outside the\n"
    "map find shadow. Single matrices are taken for maps of the size compared. Plans keep the\n"
    "sizes, border and guard of their file; a note says where their texels are not those of one\n"
    "map here.";

// Refuses the word while parsing when `parse` does.
template <typename Parse, typename Target>
void ParseInto(const char* flag, const std::string& text, const Parse& parse, Target* target) {
  const auto value = parse(text);
  if (!value.ok()) throw CLI::ValidationError(flag, std::string(value.status().message()));
  *target = *value;
}

absl::StatusOr<MapSize> ParseJudgedMap(const std::string& text) {
  absl::StatusOr<MapSize> map = ParseMapSize(text);
  if (!map.ok()) return map;
  if (int64_t{map->width} * map->height > kMaxTexels) {
    return absl::InvalidArgumentError(
        absl::StrCat(text, ": want at most ", kMaxTexels, " texels, such as 16384x16384"));
  }
  return map;
}

void DeclareMatrices(CLI::App* app, CompareFlags* flags) {
  app->add_option_function<std::vector<std::string>>(
         "--matrix",
         [flags](const std::vector<std::string>& texts) {
           for (const std::string& text : texts) {
             MatrixFlag matrix;
             ParseInto("--matrix", text, ParseMatrixFlag, &matrix);
             for (const MatrixFlag& other : flags->matrices) {
               if (other.name != matrix.name) continue;
               throw CLI::ValidationError(
                   "--matrix",
                   absl::StrCat("\"", text, "\": the name is taken, want distinct names"));
             }
             flags->matrices.push_back(std::move(matrix));
           }
         },
         "Matrices or plans from elsewhere as a further method (may be repeated)")
      ->type_name("NAME=FILE.json")
      ->expected(1)
      ->take_all()
      ->group("Methods");
  app->add_option("--bias-share",
                  flags->judge.constant_share,
                  "Constant part of the practical bias, of the receivers' range of distances from "
                  "the light [0.0002]")
      ->type_name("SHARE")
      ->check(NumberIn(0.0, 1.0))
      ->group("Methods");
  app->add_option_function<int>(
         "--phases",
         [flags](int phases) {
           JudgeOptions judge = flags->judge;
           judge.phases = phases;
           const absl::Status status = ValidateJudgeOptions(judge);
           if (!status.ok()) throw CLI::ValidationError("--phases", std::string(status.message()));
           flags->judge = judge;
         },
         "Wrong pixels are means over N phases, in which every map is moved by other parts of a "
         "texel: 1, 4, 9, ... 64. The count of a single one depends on where single texels fall; 1 "
         "counts the map as it is, in less time [4]")
      ->type_name("N")
      ->group("Methods");
}

void DeclareCrawl(CLI::App* app, CrawlFlags* flags) {
  const std::string group = "Crawl";
  app->add_flag("--crawl",
                flags->is_wanted,
                "Measure how much shadows crawl to the next frame, where every method is set up "
                "anew and scene and lights stand still. Alone: the camera moves forward by 1 % of "
                "the median depth of what it sees and turns by half a degree. The options below "
                "imply --crawl")
      ->group(group);
  CLI::Option* step = app->add_option_function<std::string>(
      "--camera-step",
      [flags](const std::string& text) {
        flags->is_wanted = true;
        ParseInto("--camera-step", text, ParseCameraStep, &flags->step);
      },
      "How the camera moves to the next frame: world units in its own directions, then turns to "
      "the right and upwards, degrees");
  step->type_name("FORWARD,RIGHT,UP[,YAW[,PITCH]]")->group(group);
  app->add_option_function<int>(
         "--next-frame",
         [flags](int frame) {
           flags->is_wanted = true;
           flags->next_frame = frame;
         },
         "The next frame is that of the --camera scene file [of --next-readback: --frame + 1]")
      ->type_name("N")
      ->check(CLI::NonNegativeNumber)
      ->excludes(step)
      ->group(group);
  app->add_option_function<std::string>(
         "--next-readback",
         [flags](const std::string& path) {
           flags->is_wanted = true;
           flags->next_readback_path = path;
         },
         "The next frame of a read-back, with the same lights")
      ->type_name("FILE.exr")
      ->group(group);
}

// A name of --matrix that a row beside plans has already.
void CheckMatrixNames(const CompareFlags& flags) {
  const std::optional<PlanOptions> plan = PlanOptionsOf(flags.fit.plan, flags.fit.options);
  if (!plan.has_value()) return;
  CompareOptions options;
  options.plan = *plan;  // not SetPlan(): nobody has looked at the sizes yet
  const std::vector<std::string> rows = RowNames(options);
  for (const MatrixFlag& matrix : flags.matrices) {
    if (std::find(rows.begin(), rows.end(), matrix.name) == rows.end()) continue;
    throw CLI::ValidationError(
        "--matrix",
        absl::StrCat("\"", matrix.name, "\" is a method already with --maps, want another name"));
  }
}

void DeclareOutput(CLI::App* app, CompareFlags* flags) {
  const std::string group = "Output";
  app->add_flag("--per-light", flags->per_light, "With many lights a table for each of them too")
      ->group(group);
  app->add_option("--csv", flags->csv_path, "Write one line for each light and method")
      ->type_name("FILE.csv")
      ->group(group);
  app->add_option("--json", flags->json_path, "Write matrices and figures to this file")
      ->type_name("FILE.json")
      ->group(group);
  app->add_option("--picture",
                  flags->picture_path,
                  "Draw the shadows of all methods for one light, wrong pixels marked")
      ->type_name("FILE.png")
      ->group(group);
  app->add_option("--picture-light",
                  flags->picture_light,
                  "The light to draw [where focused and lightfit differ most]")
      ->type_name("LIGHT")
      ->group(group);
  AddChoice(app,
            "--bias",
            BiasWords(),
            &flags->picture_bias,
            "Whose wrong pixels the picture shows: of sampling alone, or with a renderer's bias "
            "[ideal]")
      ->group(group);
  app->add_option("--masks",
                  flags->masks_path,
                  "Write an image of each light's wrong pixels into this folder, LIGHT.exr: "
                  "channels METHOD.ideal and METHOD.practical, 1 where the method is wrong, and "
                  "truth.shadow, truth.facing")
      ->type_name("FOLDER")
      ->group(group);
  DeclareLegendFlag(app, group, &flags->legend);
  app->add_flag("-q,--quiet", flags->quiet, "No table and no progress; errors and warnings only")
      ->group(group);
}

}  // namespace

bool CompareFlags::is_readback() const {
  return absl::EndsWith(absl::AsciiStrToLower(scene.scene), ".exr");
}

void DeclareSizeFlags(CLI::App* app, CompareFlags* flags) {
  const std::string group = "Sizes";
  app->add_option_function<std::string>(
         "--screen",
         [flags](const std::string& text) {
           ParseInto("--screen", text, ParsePixelSize, &flags->screen);
         },
         "The image whose wrong pixels are counted, pixels [750 high and as wide as the camera's "
         "file says; 750x750 where it says nothing]")
      ->type_name("WIDTHxHEIGHT")
      ->group(group);
  app->add_option_function<std::string>(
         "--readback",
         [flags](const std::string& text) {
           ParseInto("--readback", text, ParsePixelSize, &flags->readback);
         },
         "The read-back that is fitted from, pixels [180x180, in the screen's aspect ratio]")
      ->type_name("WIDTHxHEIGHT")
      ->group(group);
  app->add_option_function<std::string>(
         "--map",
         [flags](const std::string& text) {
           ParseInto("--map", text, ParseJudgedMap, &flags->map);
         },
         "Every shadow map, texels [1024x1024]")
      ->type_name("WIDTHxHEIGHT")
      ->group(group);
}

void DeclareCompareFlags(CLI::App* app, CompareFlags* flags) {
  flags->fit.options.border = BorderChoice::kAutomatic;
  DeclareSceneFlags(app, &flags->scene, "SCENE|READBACK.exr");
  DeclareSizeFlags(app, flags);
  DeclarePlanFlags(app, flags->map, &flags->fit.plan);
  DeclareMatrices(app, flags);
  DeclareCrawl(app, &flags->crawl);
  DeclareMethodFlags(app, &flags->fit.options);
  DeclareOutput(app, flags);
  const std::string group = "Read-back";
  DeclareReadbackFlags(app, group, &flags->fit);
  DeclareCameraExrFlags(app, group, &flags->fit.camera_exr);
  app->footer(kExamples);
  app->callback([app, flags] {
    CheckPlanFlags(*app, flags->map, &flags->fit.plan);
    CheckMatrixNames(*flags);
  });
}

absl::StatusOr<MatrixFlag> ParseMatrixFlag(const std::string& text) {
  const std::pair<std::string, std::string> parts = absl::StrSplit(text, absl::MaxSplits('=', 1));
  if (parts.first.empty() || parts.second.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat("\"", text, "\": want NAME=FILE such as engine=matrices.json"));
  }
  const std::vector<std::string> rows = RowNames({});
  if (std::find(rows.begin(), rows.end(), parts.first) != rows.end()) {
    return absl::InvalidArgumentError(absl::StrCat("\"",
                                                   text,
                                                   "\": \"",
                                                   parts.first,
                                                   "\" is a method already, want another name "
                                                   "than ",
                                                   absl::StrJoin(rows, ", ")));
  }
  return MatrixFlag{parts.first, parts.second};
}

PixelSize DefaultReadbackSize(PixelSize screen) {
  constexpr double kSide = 180.0;
  const double stretch = std::sqrt(static_cast<double>(screen.width) / screen.height);
  return {std::max(1, static_cast<int>(std::lround(kSide * stretch))),
          std::max(1, static_cast<int>(std::lround(kSide / stretch)))};
}

}  // namespace lightfit::cli
