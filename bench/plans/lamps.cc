// bench/plans/lamps.cc : lamps among their receivers, at equal texels, judged by wrong pixels.
//
// In:   the scenes of bench/scene_set.h, lamps in turn over their cameras; read-backs of 180x180
//       with the third state.
// Out:  wrong pixels of cubes, paraboloids and fitted plans, 400x400 texels in all, over those of a
//       cube of the needed faces: ratio of totals, geometric mean, and the worst among lamps with
//       300 wrong pixels or more; ideal and practical bias, four phases; over all lamps, over those
//       whose dark receivers no single map holds, per scene. --csv: per lamp and row, all of it.
//
// A camera that sees no place for one has no lamp (bench/plans/draw_lamp.h).
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/progress.h"
#include "base/text_file.h"
#include "bench/plans/draw_lamp.h"
#include "bench/scene_run.h"
#include "bench/wrong_ratio.h"
#include "jobs/compare/stage.h"
#include "jobs/schemes/fitted.h"
#include "jobs/schemes/judge_maps.h"
#include "jobs/schemes/shipped.h"
#include "render/true_lighting.h"

namespace lightfit {
namespace {

constexpr int kSide = 400;  // of a single map of as many texels as all maps have
constexpr int kReadback = 180;

constexpr SchemeBudget kBudget = {{kSide, kSide}};

Scheme CubeRow(const std::string& name, bool needed_faces_only, bool turned) {
  CubeFacesOptions options;
  options.needed_faces_only = needed_faces_only;
  options.turned = turned;
  return CubeScheme(name, options, kBudget);
}

Scheme FitRow(const std::string& name, int num_maps, Cover cover, bool choose_by_forecast) {
  PlanOptions options;
  options.max_maps = num_maps;
  options.texels = kBudget.texels();
  options.choose_by_forecast = choose_by_forecast;
  options.fit.cover = cover;
  return FittedScheme(name, options);
}

Scheme PairRow(const std::string& name, const std::optional<Eigen::Vector3d>& normal) {
  return PairScheme(name, normal, PairFill::kByRays, kBudget);
}

std::vector<Scheme> MakeRows() {
  std::vector<Scheme> rows = {
      CubeRow("cube, all faces", false, false),
      CubeRow("cube, needed faces", true, false),
      CubeRow("cube, turned", true, true),
      PairRow("pair, normal x", Eigen::Vector3d::UnitX()),
      PairRow("pair, normal y (up)", Eigen::Vector3d::UnitY()),
      PairRow("pair, normal z", Eigen::Vector3d::UnitZ()),
      PairRow("pair, free", std::nullopt),
      PairScheme("pair, free, drawn", std::nullopt, PairFill::kByRaster, kBudget)};
  for (const bool forecast : {false, true}) {
    const std::string chosen = forecast ? ", chosen" : "";
    for (const int num_maps : {2, 3, 4, 6}) {
      rows.push_back(FitRow(
          absl::StrCat(num_maps, " maps, dark", chosen), num_maps, Cover::kShadowed, forecast));
    }
    rows.push_back(FitRow(absl::StrCat("6 maps, all", chosen), 6, Cover::kReceivers, forecast));
  }
  return rows;
}

struct Measured {
  bool is_there = false;
  double ideal = 0.0, practical = 0.0, outside = 0.0;
  std::string why_not;
};
struct LampRow {
  std::string scene, lamp;
  bool has_single_map = false;  // for the dark receivers
  std::vector<Measured> rows;
};

absl::StatusOr<ShadowImage> JudgeRow(const Scheme& row,
                                     const LitStage& lamp,
                                     const std::vector<Lighting>& truth,
                                     const JudgeOptions& options) {
  const CompareStage& stage = *lamp.stage;
  const absl::StatusOr<SchemeMaps> maps = row.set_up({stage.view, *lamp.surfaces, lamp.light});
  if (!maps.ok()) return maps.status();
  if (NumTexels(*maps) > kBudget.texels()) return absl::InternalError("too many texels");
  return JudgeMaps(*stage.caster, stage.screen, truth, lamp.light, *maps, options);
}

LampRow MeasureLamp(const std::string& scene,
                    const LitStage& lamp,
                    const std::vector<Scheme>& rows,
                    int phases) {
  LampRow measured = {scene, lamp.light.name, HasSingleMap(lamp, Cover::kShadowed), {}};
  const std::vector<Lighting> truth =
      TrueLighting(*lamp.stage->caster, lamp.stage->screen, lamp.light);
  JudgeOptions options;
  options.phases = phases;
  for (const Scheme& row : rows) {
    const absl::StatusOr<ShadowImage> image = JudgeRow(row, lamp, truth, options);
    measured.rows.emplace_back();
    Measured& result = measured.rows.back();
    result.is_there = image.ok();
    if (!image.ok()) {
      result.why_not = std::string(image.status().message());
      continue;
    }
    result.ideal = static_cast<double>(image->wrong.ideal);
    result.practical = static_cast<double>(image->wrong.practical);
    result.outside = static_cast<double>(image->wrong.outside);
  }
  return measured;
}

absl::Status MeasureScene(size_t index,
                          const SceneArguments& arguments,
                          const std::vector<Scheme>& rows,
                          Progress& progress,
                          std::vector<LampRow>* lamps) {
  const SceneCase& scene = SceneCases()[index];
  const absl::StatusOr<RayCaster> caster = LoadSceneCase(scene, arguments.folder);
  if (!caster.ok()) return caster.status();
  const absl::StatusOr<std::vector<CompareStage>> stages = MakeStages(scene, *caster, kReadback);
  if (!stages.ok()) return stages.status();
  for (int i = 0; i < arguments.num_lights; ++i) {
    const size_t view = i % stages->size();
    const std::string name = absl::StrFormat("lamp%03d/%d", i + 1, view + 1);
    progress.Begin(absl::StrCat(scene.name, ": ", name));
    const std::optional<LitStage> lamp = DrawLamp((*stages)[view], name, 1000 * arguments.seed + i);
    if (!lamp.has_value()) {
      std::printf(
          "%s has no %s: no place with receivers all around\n", scene.name.c_str(), name.c_str());
    } else {
      lamps->push_back(MeasureLamp(scene.name, *lamp, rows, arguments.phases));
    }
    progress.Advance();
  }
  return absl::OkStatus();
}

using Lamps = std::vector<const LampRow*>;

// Over lamps that have both.
WrongRatio RatioOf(const Lamps& lamps, size_t row, size_t reference, double Measured::*kind) {
  WrongRatio ratio;
  for (const LampRow* lamp : lamps) {
    const Measured &measured = lamp->rows[row], &other = lamp->rows[reference];
    if (measured.is_there && other.is_there) ratio.Add(measured.*kind, other.*kind);
  }
  return ratio;
}

size_t IndexOf(const std::vector<Scheme>& rows, const std::string& name) {
  const auto is_it = [&name](const Scheme& row) { return row.name == name; };
  return std::find_if(rows.begin(), rows.end(), is_it) - rows.begin();
}

void PrintRatios(const std::string& title, const std::vector<Scheme>& rows, const Lamps& lamps) {
  if (lamps.empty()) return;
  std::printf("\n== %s: %d lamps\n", title.c_str(), static_cast<int>(lamps.size()));
  std::printf(
      "%-22s %5s   %-17s %s\n", "over needed faces:", "lamps", "ideal, worst", "practical, worst");
  const size_t reference = IndexOf(rows, "cube, needed faces");
  for (size_t row = 0; row < rows.size(); ++row) {
    const WrongRatio ideal = RatioOf(lamps, row, reference, &Measured::ideal);
    const WrongRatio practical = RatioOf(lamps, row, reference, &Measured::practical);
    if (ideal.count() == 0) {
      std::printf("%-22s %5d   -\n", rows[row].name.c_str(), 0);
      continue;
    }
    std::printf("%-22s %5d   %.2f %.2f  %-6.2f %.2f %.2f  %.2f\n",
                rows[row].name.c_str(),
                ideal.count(),
                ideal.total(),
                ideal.mean(),
                ideal.worst(),
                practical.total(),
                practical.mean(),
                practical.worst());
  }
}

struct Target {
  std::string row, over;
  double at_most, aim;
};

void PrintTargets(const std::vector<Scheme>& rows, const Lamps& lamps) {
  const std::string faces = "cube, needed faces";
  std::printf("\n== ideal bias: total, mean, and what is wanted of both\n");
  for (const Target& target : {Target{"4 maps, dark", faces, 0.33, 0.20},
                               Target{"4 maps, dark, chosen", faces, 0.33, 0.20},
                               Target{"6 maps, all", faces, 0.53, 0.38},
                               Target{"6 maps, all, chosen", faces, 0.53, 0.38},
                               Target{"pair, free", "pair, normal x", 0.85, 0.75},
                               Target{"pair, free", "pair, normal y (up)", 0.85, 0.75},
                               Target{"pair, free", "pair, normal z", 0.85, 0.75}}) {
    const WrongRatio ratio =
        RatioOf(lamps, IndexOf(rows, target.row), IndexOf(rows, target.over), &Measured::ideal);
    std::printf("%-22s over %-22s %-9s of %d lamps; want %.2f, aim %.2f\n",
                target.row.c_str(),
                target.over.c_str(),
                ratio.Text().c_str(),
                ratio.count(),
                target.at_most,
                target.aim);
  }
}

void PrintMissing(const std::vector<Scheme>& rows, const std::vector<LampRow>& lamps) {
  std::string missing;
  for (const LampRow& lamp : lamps) {
    for (size_t row = 0; row < rows.size(); ++row) {
      if (lamp.rows[row].is_there) continue;
      absl::StrAppend(
          &missing, lamp.scene, ", ", rows[row].name, ": ", lamp.rows[row].why_not, "\n");
    }
  }
  if (!missing.empty()) std::printf("\n== not there\n%s", missing.c_str());
}

void Print(const std::vector<Scheme>& rows, const std::vector<LampRow>& lamps) {
  Lamps all, without_single;
  for (size_t begin = 0; begin < lamps.size();) {
    Lamps of_scene;
    for (; begin < lamps.size() &&
           (of_scene.empty() || lamps[begin].scene == of_scene.front()->scene);
         ++begin) {
      of_scene.push_back(&lamps[begin]);
      all.push_back(&lamps[begin]);
      if (!lamps[begin].has_single_map) without_single.push_back(&lamps[begin]);
    }
    PrintRatios(of_scene.front()->scene, rows, of_scene);
  }
  PrintRatios("no single map for the dark receivers", rows, without_single);
  PrintRatios("all", rows, all);
  PrintMissing(rows, lamps);
  PrintTargets(rows, all);
}

absl::Status WriteCsv(const std::string& path,
                      const std::vector<Scheme>& rows,
                      const std::vector<LampRow>& lamps) {
  std::string text = "scene,lamp,has_single_map,row,ideal,practical,outside\n";
  for (const LampRow& lamp : lamps) {
    for (size_t row = 0; row < rows.size(); ++row) {
      const Measured& measured = lamp.rows[row];
      if (!measured.is_there) continue;
      absl::StrAppendFormat(&text,
                            "%s,%s,%d,\"%s\",%g,%g,%g\n",
                            lamp.scene,
                            lamp.lamp,
                            lamp.has_single_map ? 1 : 0,
                            rows[row].name,
                            measured.ideal,
                            measured.practical,
                            measured.outside);
    }
  }
  return WriteTextFileAtomically(path, text);
}

absl::Status Run(const SceneArguments& arguments) {
  const std::vector<Scheme> rows = MakeRows();
  std::vector<LampRow> lamps;
  {
    Progress progress(arguments.num_lights * static_cast<int>(SceneCases().size()));
    absl::Status status = ForEachScene(arguments, [&](size_t scene) {
      return MeasureScene(scene, arguments, rows, progress, &lamps);
    });
    if (!status.ok()) return status;
  }
  Print(rows, lamps);
  return arguments.csv_path.empty() ? absl::OkStatus() : WriteCsv(arguments.csv_path, rows, lamps);
}

}  // namespace
}  // namespace lightfit

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): options are ours
  lightfit::SceneArguments arguments = {.num_lights = 3, .seed = 61};
  CLI::App app("Lamps among their receivers, judged by wrong pixels at equal texels.");
  lightfit::DeclareLights(&app, "--lamps", &arguments);
  lightfit::DeclarePhases(&app, &arguments.phases);
  lightfit::DeclareScenes(&app, &arguments);
  lightfit::DeclareCsv(&app, &arguments);
  CLI11_PARSE(app, argc, argv);
  return lightfit::ExitCodeOf("lamps", lightfit::Run(arguments));
}
