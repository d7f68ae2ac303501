// bench/plans/lamps.cc : lamps among their receivers, at equal texels, judged by wrong pixels.
//
// In:   the scenes of bench/scene_set.h, lamps in turn over their cameras; read-backs of 180x180
//       with the third state.
// Out:  wrong pixels of cubes, paraboloids and fitted plans, 400x400 texels in all, over those of a
//       cube of the needed faces: ratio of totals, geometric mean, and the worst among lamps with
//       300 wrong pixels or more; ideal and practical bias, four phases; over all lamps, over those
//       whose dark receivers no single map holds, per scene. --csv: per lamp and row, all of it.
//
// A lamp stands on the sight line of a pixel in the middle half of the picture, 30 to 90 % of the
// way to what is seen there, or to where half of all pixels are nearer if that is less; and as far
// from surfaces as DrawLights() has them. Receivers lie all around it: no single map holds what the
// camera sees. Of a hundred lines that the seed draws the first such place is taken; a camera
// without one has no lamp.
//
// Scenes whose file is absent are named and left out.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/progress.h"
#include "base/text_file.h"
#include "bench/scene_set.h"
#include "jobs/compare/stage.h"
#include "jobs/schemes/fitted.h"
#include "jobs/schemes/judge_maps.h"
#include "jobs/schemes/shipped.h"
#include "methods/view_body.h"
#include "optimizer/light_view.h"
#include "render/clearance.h"
#include "render/generator/dice.h"

namespace lightfit {
namespace {

constexpr int kSide = 400;  // of a single map of as many texels as all maps have
constexpr int kReadback = 180;

struct Arguments {
  int num_lamps = 3;
  uint64_t seed = 61;
  int phases = 4;
  std::string only;
  std::string folder = DefaultSceneFolder();
  std::string csv_path;
};

// A lamp in a stage, and its read-back with the third state. Stays where it is made: surfaces and
// views refer to it.
struct LampView {
  const CompareStage& stage;
  Light light;
  std::vector<uint32_t> shadow, facing;
  std::optional<absl::StatusOr<Surfaces>> surfaces;

  LampView(const CompareStage& stage, const Light& lamp) : stage(stage), light(lamp) {
    for (const Lighting at : TrueLighting(*stage.caster, stage.readback_surfaces, light)) {
      shadow.push_back(at == Lighting::kShadowed ? 1 : 0);
      facing.push_back(IsJudged(at) ? 1 : 0);
    }
    Readback readback = stage.readback;
    readback.depth = stage.readback_depth;
    readback.shadow_bits = shadow;
    readback.facing_bits = facing;
    surfaces = FindSurfaces(readback, 1, {});
  }
  LampView(const LampView&) = delete;
  LampView& operator=(const LampView&) = delete;

  // Whether a single map holds all of them.
  bool HasSingleMap(Cover cover) const {
    FitOptions options;
    options.cover = cover;
    const absl::StatusOr<LightView> view = ViewLight(**surfaces, light, options);
    return view.ok() && view->cover.ok();
  }
};

// Distance from the eye: half of what is seen is nearer.
double MedianDistance(const SurfaceImage& image) {
  std::vector<double> distances;
  for (const SurfacePoint& pixel : image.pixels) {
    if (pixel.is_surface())
      distances.push_back((pixel.position - EyePosition(image.camera)).norm());
  }
  if (distances.empty()) return 0.0;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

std::unique_ptr<LampView> DrawLamp(const CompareStage& stage,
                                   const std::string& name,
                                   uint64_t seed) {
  constexpr int kAttempts = 100;
  const double least_clearance = 2e-3 * stage.caster->bounds().diagonal().norm();
  const SurfaceImage& image = stage.readback_surfaces;
  const Eigen::Vector3d eye = EyePosition(image.camera);
  const double median = MedianDistance(image);
  Dice dice(seed);
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const int column = kReadback / 4 + dice.Below(kReadback / 2);
    const int row = kReadback / 4 + dice.Below(kReadback / 2);
    const double share = dice.Uniform(0.3, 0.9);
    const SurfacePoint& seen = image.pixels[static_cast<size_t>(row) * kReadback + column];
    if (!seen.is_surface()) continue;
    const Eigen::Vector3d sight = seen.position - eye;
    const double distance = share * std::min(sight.norm(), median);
    const Eigen::Vector3d position = eye + distance * sight.normalized();
    if (!(Clearance(*stage.caster, position) > least_clearance)) continue;
    auto lamp = std::make_unique<LampView>(stage, Light::Point(name, position));
    if (lamp->surfaces->ok() && !lamp->HasSingleMap(Cover::kReceivers)) return lamp;
  }
  return nullptr;
}

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
                                     const LampView& lamp,
                                     const std::vector<Lighting>& truth,
                                     const JudgeOptions& options) {
  const CompareStage& stage = lamp.stage;
  const absl::StatusOr<SchemeMaps> maps = row.set_up({stage.view, *lamp.surfaces, lamp.light});
  if (!maps.ok()) return maps.status();
  if (NumTexels(*maps) > kBudget.texels()) return absl::InternalError("too many texels");
  return JudgeMaps(*stage.caster, stage.screen, truth, lamp.light, *maps, options);
}

LampRow MeasureLamp(const std::string& scene,
                    const LampView& lamp,
                    const std::vector<Scheme>& rows,
                    int phases) {
  LampRow measured = {scene, lamp.light.name, lamp.HasSingleMap(Cover::kShadowed), {}};
  const std::vector<Lighting> truth =
      TrueLighting(*lamp.stage.caster, lamp.stage.screen, lamp.light);
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
                          const Arguments& arguments,
                          const std::vector<Scheme>& rows,
                          Progress& progress,
                          std::vector<LampRow>* lamps) {
  const SceneCase& scene = SceneCases()[index];
  const absl::StatusOr<RayCaster> caster = LoadSceneCase(scene, arguments.folder);
  if (!caster.ok()) return caster.status();
  const absl::StatusOr<std::vector<CompareStage>> stages = MakeStages(scene, *caster, kReadback);
  if (!stages.ok()) return stages.status();
  for (int i = 0; i < arguments.num_lamps; ++i) {
    const size_t view = i % stages->size();
    const std::string name = absl::StrFormat("lamp%03d/%d", i + 1, view + 1);
    progress.Begin(absl::StrCat(scene.name, ": ", name));
    const std::unique_ptr<LampView> lamp =
        DrawLamp((*stages)[view], name, 1000 * arguments.seed + i);
    if (lamp == nullptr) {
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

struct Ratio {
  int count = 0;
  double total = 0.0, mean = 0.0, worst = 0.0;
};

// Over lamps that have both.
Ratio RatioOf(const Lamps& lamps, size_t row, size_t reference, double Measured::*kind) {
  constexpr double kEnoughPixels = 300.0;
  Ratio ratio;
  double sum = 0.0, sum_reference = 0.0, log_sum = 0.0;
  for (const LampRow* lamp : lamps) {
    const Measured &measured = lamp->rows[row], &other = lamp->rows[reference];
    if (!measured.is_there || !other.is_there) continue;
    const double wrong = measured.*kind, of_other = other.*kind;
    sum += wrong;
    sum_reference += of_other;
    log_sum += std::log((wrong + 1.0) / (of_other + 1.0));
    if (of_other >= kEnoughPixels) ratio.worst = std::max(ratio.worst, wrong / of_other);
    ++ratio.count;
  }
  if (ratio.count == 0) return ratio;
  ratio.total = sum / std::max(1.0, sum_reference);
  ratio.mean = std::exp(log_sum / ratio.count);
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
    const Ratio ideal = RatioOf(lamps, row, reference, &Measured::ideal);
    const Ratio practical = RatioOf(lamps, row, reference, &Measured::practical);
    if (ideal.count == 0) {
      std::printf("%-22s %5d   -\n", rows[row].name.c_str(), 0);
      continue;
    }
    std::printf("%-22s %5d   %.2f %.2f  %-6.2f %.2f %.2f  %.2f\n",
                rows[row].name.c_str(),
                ideal.count,
                ideal.total,
                ideal.mean,
                ideal.worst,
                practical.total,
                practical.mean,
                practical.worst);
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
    const Ratio ratio =
        RatioOf(lamps, IndexOf(rows, target.row), IndexOf(rows, target.over), &Measured::ideal);
    const std::string figures =
        ratio.count == 0 ? "-" : absl::StrFormat("%.2f %.2f", ratio.total, ratio.mean);
    std::printf("%-22s over %-22s %-9s of %d lamps; want %.2f, aim %.2f\n",
                target.row.c_str(),
                target.over.c_str(),
                figures.c_str(),
                ratio.count,
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

absl::Status Run(const Arguments& arguments) {
  std::string names;
  for (const SceneCase& scene : SceneCases()) absl::StrAppend(&names, " ", scene.name);
  if (!absl::StrContains(names, arguments.only)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("--only %s: no such scene; there are%s", arguments.only, names));
  }
  const std::vector<Scheme> rows = MakeRows();
  std::vector<LampRow> lamps;
  {
    Progress progress(arguments.num_lamps * static_cast<int>(SceneCases().size()));
    for (size_t i = 0; i < SceneCases().size(); ++i) {
      const SceneCase& scene = SceneCases()[i];
      if (!arguments.only.empty() && scene.name != arguments.only) continue;
      absl::Status status = MeasureScene(i, arguments, rows, progress, &lamps);
      if (absl::IsNotFound(status)) {
        std::printf("%s left out: %s\n", scene.name.c_str(), std::string(status.message()).c_str());
        continue;
      }
      if (!status.ok()) return status;
    }
  }
  Print(rows, lamps);
  return arguments.csv_path.empty() ? absl::OkStatus() : WriteCsv(arguments.csv_path, rows, lamps);
}

}  // namespace
}  // namespace lightfit

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): options are ours
  lightfit::Arguments arguments;
  CLI::App app("Lamps among their receivers, judged by wrong pixels at equal texels.");
  app.add_option("--lamps", arguments.num_lamps, "Per scene")->capture_default_str();
  app.add_option("--seed", arguments.seed, "Of the lamps")->capture_default_str();
  app.add_option("--phases", arguments.phases, "Moves of the maps, a square number")
      ->capture_default_str();
  app.add_option("--only", arguments.only, "One scene by name");
  app.add_option("--scenes", arguments.folder, "Folder with the scenes")->capture_default_str();
  app.add_option("--csv", arguments.csv_path, "Write every lamp and row to a file");
  CLI11_PARSE(app, argc, argv);
  const absl::Status status = lightfit::Run(arguments);
  if (status.ok()) return 0;
  std::fprintf(stderr, "lamps: %s\n", std::string(status.message()).c_str());
  return 1;
}
