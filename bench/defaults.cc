// bench/defaults.cc : every default of the fit against its alternatives, judged by wrong pixels.
//
// In:   the scenes of bench/scene_set.h, lights in turn over their cameras. Every second scene is
//       there for choosing ("tuning"), the others show whether the choice holds ("report").
// Out:  one row per alternative: wrong pixels over those of the defaults, as ratio of totals and as
//       geometric mean, ideal and practical bias, both halves. Then how well the foretold share of
//       wrong pixels agrees with the measured one.
//
// The table in docs/defaults.md. --csv: per light and row, measured and foretold.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/progress.h"
#include "base/text_file.h"
#include "bench/scene_run.h"
#include "bench/wrong_ratio.h"
#include "jobs/compare/stage.h"
#include "optimizer/figures/foretell.h"
#include "optimizer/fit.h"
#include "render/judge.h"
#include "render/readback_image.h"

namespace lightfit {
namespace {

constexpr MapSize kMap = {400, 400};

struct Arguments {
  SceneArguments scenes = {.num_lights = 30, .seed = 7};
  int readback = 180;
};

struct Variant {
  std::string name;
  FitOptions options;
  bool knows_facing = true;
};

std::vector<Variant> Variants() {
  std::vector<Variant> variants = {{"defaults", FitOptions()}};
  const auto add = [&](const std::string& name, const std::function<void(FitOptions&)>& change) {
    variants.push_back({name, FitOptions()});
    change(variants.back().options);
  };
  add("cover: all receivers", [](FitOptions& o) { o.cover = Cover::kReceivers; });
  add("border: dark", [](FitOptions& o) { o.border = BorderChoice::kDark; });
  add("border: automatic", [](FitOptions& o) { o.border = BorderChoice::kAutomatic; });
  variants.push_back({"no third state", FitOptions(), /*knows_facing=*/false});
  add("metric: l2", [](FitOptions& o) { o.metric = Metric::kL2; });
  add("metric: l2 across the edge", [](FitOptions& o) { o.metric = Metric::kL2AcrossEdge; });
  add("metric: l1", [](FitOptions& o) { o.metric = Metric::kL1; });
  add("reweighting rounds: 2", [](FitOptions& o) { o.reweighting_rounds = 2; });
  add("reweighting rounds: 10", [](FitOptions& o) { o.reweighting_rounds = 10; });
  add("along-edge share: 0.01", [](FitOptions& o) { o.along_edge_share = 0.01; });
  add("along-edge share: 0.2", [](FitOptions& o) { o.along_edge_share = 0.2; });
  add("edge window: 1", [](FitOptions& o) { o.samples.edge_window = 1; });
  add("edge window: 3", [](FitOptions& o) { o.samples.edge_window = 3; });
  add("outlines: left out", [](FitOptions& o) { o.samples.use_outlines = false; });
  add("terminators: taken in", [](FitOptions& o) { o.samples.use_terminators = true; });
  add("max_depth_bend: 0.25", [](FitOptions& o) { o.samples.max_depth_bend = 0.25; });
  add("max_depth_bend: 0.8", [](FitOptions& o) { o.samples.max_depth_bend = 0.8; });
  add("min_cos_light: 0.0005", [](FitOptions& o) { o.samples.min_cos_light = 0.0005; });
  add("min_cos_light: 0.02", [](FitOptions& o) { o.samples.min_cos_light = 0.02; });
  add("min_cos_light: 0.1", [](FitOptions& o) { o.samples.min_cos_light = 0.1; });
  add("margin: 0.3 %", [](FitOptions& o) { o.margin_percent = 0.3; });
  add("margin: 2 %", [](FitOptions& o) { o.margin_percent = 2.0; });
  add("min_w: 0.01", [](FitOptions& o) { o.min_w = 0.01; });
  add("affine: rectangle", [](FitOptions& o) { o.affine = Affine::kMinAreaRectangle; });
  add("search: focused", [](FitOptions& o) { o.search = Search::kFocused; });
  add("search: line", [](FitOptions& o) { o.search = Search::kRotationLineSearch; });
  add("search: refine", [](FitOptions& o) { o.search = Search::kRotationLineSearchRefined; });
  variants.push_back({"line (Algorithm 1, normalised)", FitOptions::AsPublished()});
  variants.back().options.ray_space = RaySpace::kNormalized;
  variants.back().options.sample_by_sample = false;
  variants.push_back({"as published", FitOptions::AsPublished()});
  variants.back().options.sample_by_sample = false;
  return variants;
}

// One light under one variant, as wrong pixels of the screen.
struct Measured {
  double ideal = 0.0, practical = 0.0, foretold = 0.0;
};

struct LightRow {
  std::string scene, light;
  bool is_for_tuning;
  std::vector<Measured> measured;  // by variant
};

absl::StatusOr<Measured> Measure(const CompareStage& stage,
                                 const ReadbackImage& readback,
                                 const std::vector<Lighting>& truth,
                                 const Light& light,
                                 const Variant& variant,
                                 const JudgeOptions& judge) {
  Readback view = readback.View();
  if (!variant.knows_facing) view.facing_bits = {};
  const absl::StatusOr<LightMatrix> fit = FitLight(view, light, kMap, variant.options);
  if (!fit.ok()) return fit.status();
  const absl::StatusOr<ShadowImage> image = JudgeMatrix(
      *stage.caster, stage.screen, truth, light, {fit->map_from_world, kMap, fit->border}, judge);
  if (!image.ok()) return image.status();
  const absl::StatusOr<double> share =
      ForetellWrongShare(view, light, fit->map_from_world, kMap, {}, fit->border);
  if (!share.ok()) return share.status();
  return Measured{static_cast<double>(image->wrong.ideal),
                  static_cast<double>(image->wrong.practical),
                  *share * kScreenSize * kScreenSize};
}

absl::Status MeasureScene(size_t index,
                          const Arguments& arguments,
                          const std::vector<Variant>& variants,
                          Progress& progress,
                          std::vector<LightRow>* rows) {
  const SceneCase& scene = SceneCases()[index];
  const JudgeOptions judge = {.phases = arguments.scenes.phases};
  const absl::StatusOr<RayCaster> caster = LoadSceneCase(scene, arguments.scenes.folder);
  if (!caster.ok()) return caster.status();
  const absl::StatusOr<std::vector<CompareStage>> stages =
      MakeStages(scene, *caster, arguments.readback);
  if (!stages.ok()) return stages.status();
  const std::vector<Light> lights =
      DrawLights(scene, *caster, arguments.scenes.num_lights, arguments.scenes.seed);
  for (size_t i = 0; i < lights.size(); ++i) {
    progress.Begin(absl::StrCat(scene.name, ": ", lights[i].name));
    const CompareStage& stage = (*stages)[ViewOf(i, *stages)];
    const std::vector<Lighting> truth = TrueLighting(*caster, stage.screen, lights[i]);
    const absl::StatusOr<ReadbackImage> readback =
        RenderReadback(*caster, stage.readback.camera, {&lights[i], 1});
    if (!readback.ok()) return readback.status();
    LightRow row = {scene.name, lights[i].name, IsForTuning(index), {}};
    for (const Variant& variant : variants) {
      const absl::StatusOr<Measured> measured =
          Measure(stage, *readback, truth, lights[i], variant, judge);
      if (!measured.ok()) break;  // no shadow in view, or receivers all around: no row
      row.measured.push_back(*measured);
    }
    if (row.measured.size() == variants.size()) rows->push_back(std::move(row));
    progress.Advance();
  }
  return absl::OkStatus();
}

// Over the defaults' of one half.
WrongRatio RatioOf(const std::vector<LightRow>& rows,
                   bool tuning,
                   size_t variant,
                   double Measured::*kind) {
  WrongRatio ratio;
  for (const LightRow& row : rows) {
    if (row.is_for_tuning == tuning) {
      ratio.Add(row.measured[variant].*kind, row.measured[0].*kind);
    }
  }
  return ratio;
}

void PrintRatios(const std::vector<LightRow>& rows, const std::vector<Variant>& variants) {
  std::printf("%-32s %-29s %-29s\n", "", "tuning half", "report half");
  std::printf("%-32s %14s %14s %14s %14s\n",
              "wrong pixels / defaults'",
              "ideal",
              "practical",
              "ideal",
              "practical");
  for (size_t variant = 0; variant < variants.size(); ++variant) {
    std::printf("%-32s", variants[variant].name.c_str());
    for (const bool tuning : {true, false}) {
      for (const auto kind : {&Measured::ideal, &Measured::practical}) {
        const WrongRatio ratio = RatioOf(rows, tuning, variant, kind);
        std::printf("    %.3f %.3f", ratio.total(), ratio.mean());
      }
    }
    std::printf("\n");
  }
}

// Correlation of logarithms, and the spread of their difference around its mean.
struct Agreement {
  double correlation = 0.0, mean_ratio = 0.0, spread_factor = 0.0;
};
Agreement AgreementOf(const std::vector<std::pair<double, double>>& logs) {
  double mean_x = 0.0, mean_y = 0.0, xx = 0.0, yy = 0.0, xy = 0.0, dd = 0.0;
  const double n = static_cast<double>(logs.size());
  for (const auto& [x, y] : logs) {
    mean_x += x / n;
    mean_y += y / n;
  }
  for (const auto& [x, y] : logs) {
    const double dx = x - mean_x, dy = y - mean_y;
    xx += dx * dx;
    yy += dy * dy;
    xy += dx * dy;
    dd += (dy - dx) * (dy - dx);
  }
  return {xy / std::sqrt(xx * yy), std::exp(mean_y - mean_x), std::exp(std::sqrt(dd / n))};
}

void PrintForetold(const std::vector<LightRow>& rows) {
  std::vector<std::pair<double, double>> of_defaults, within;
  for (const LightRow& row : rows) {
    if (row.is_for_tuning) continue;
    double mean_x = 0.0, mean_y = 0.0;
    for (const Measured& measured : row.measured) {
      mean_x += std::log(measured.foretold + 1.0) / static_cast<double>(row.measured.size());
      mean_y += std::log(measured.ideal + 1.0) / static_cast<double>(row.measured.size());
    }
    for (size_t i = 0; i < row.measured.size(); ++i) {
      const double x = std::log(row.measured[i].foretold + 1.0);
      const double y = std::log(row.measured[i].ideal + 1.0);
      if (i == 0) of_defaults.emplace_back(x, y);
      within.emplace_back(x - mean_x, y - mean_y);
    }
  }
  const Agreement across = AgreementOf(of_defaults);
  const Agreement inside = AgreementOf(within);
  std::printf("\nforetold against measured wrong pixels, ideal bias, report half, in logarithms\n");
  std::printf(
      "  the defaults from light to light: correlation %.3f, measured / foretold %.2f on "
      "average, off by a factor of %.2f\n",
      across.correlation,
      across.mean_ratio,
      across.spread_factor);
  std::printf(
      "  all rows above, each light about its own mean: correlation %.3f, off by a factor "
      "of %.2f\n",
      inside.correlation,
      inside.spread_factor);
}

absl::Status WriteCsv(const std::string& path,
                      const std::vector<LightRow>& rows,
                      const std::vector<Variant>& variants) {
  std::string text = "scene,light,half,variant,ideal,practical,foretold\n";
  for (const LightRow& row : rows) {
    for (size_t i = 0; i < variants.size(); ++i) {
      absl::StrAppendFormat(&text,
                            "%s,%s,%s,\"%s\",%g,%g,%g\n",
                            row.scene,
                            row.light,
                            row.is_for_tuning ? "tuning" : "report",
                            variants[i].name,
                            row.measured[i].ideal,
                            row.measured[i].practical,
                            row.measured[i].foretold);
    }
  }
  return WriteTextFileAtomically(path, text);
}

absl::Status Run(const Arguments& arguments) {
  const JudgeOptions judge = {.phases = arguments.scenes.phases};
  if (absl::Status status = ValidateJudgeOptions(judge); !status.ok()) return status;
  const std::vector<Variant> variants = Variants();
  std::vector<LightRow> rows;
  {
    Progress progress(arguments.scenes.num_lights * static_cast<int>(SceneCases().size()));
    absl::Status status = ForEachScene(arguments.scenes, [&](size_t scene) {
      return MeasureScene(scene, arguments, variants, progress, &rows);
    });
    if (!status.ok()) return status;
  }
  const auto num_tuning = std::count_if(
      rows.begin(), rows.end(), [](const LightRow& row) { return row.is_for_tuning; });
  std::printf(
      "%d lights for tuning, %d for the report; each cell: ratio of totals, geometric mean\n",
      static_cast<int>(num_tuning),
      static_cast<int>(rows.size() - num_tuning));
  PrintRatios(rows, variants);
  PrintForetold(rows);
  const std::string& path = arguments.scenes.csv_path;
  return path.empty() ? absl::OkStatus() : WriteCsv(path, rows, variants);
}

}  // namespace
}  // namespace lightfit

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): options are ours
  lightfit::Arguments arguments;
  CLI::App app("Every default of the fit against its alternatives, judged by wrong pixels.");
  lightfit::DeclareLights(&app, "--lights", &arguments.scenes);
  app.add_option("--readback", arguments.readback, "Side of the read-back, pixels")
      ->capture_default_str();
  lightfit::DeclarePhases(&app, &arguments.scenes.phases);
  lightfit::DeclareScenes(&app, &arguments.scenes);
  lightfit::DeclareCsv(&app, &arguments.scenes);
  CLI11_PARSE(app, argc, argv);
  return lightfit::ExitCodeOf("defaults", lightfit::Run(arguments));
}
