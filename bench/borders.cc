// bench/borders.cc : the border's value, the finer cover, and the forecast that chooses among them.
//
// In:   the scenes of bench/scene_set.h, lights in turn over their cameras; read-backs with the
//       third state. Every second scene is there for choosing ("tuning"), the others for the
//       report.
// Out:  per scene, wrong pixels over those of Algorithm 1 as published and over the lit border's,
// as
//       ratio of totals and as geometric mean, ideal and practical bias, four phases; lights where
//       ours is behind every other method; then how well wrong pixels are foretold, with the third
//       state, without, and by what the drawn map says. --csv: per light and row, all of it.
//
// The tables of docs/defaults.md.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/progress.h"
#include "base/text_file.h"
#include "bench/forecast_table.h"
#include "bench/inputs.h"
#include "bench/readback_borders.h"
#include "bench/scene_run.h"
#include "bench/wrong_ratio.h"
#include "jobs/compare/stage.h"
#include "methods/method.h"
#include "optimizer/figures/foretell.h"
#include "optimizer/fit.h"
#include "render/judge.h"
#include "render/readback_image.h"
#include "render/true_lighting.h"

namespace lightfit {
namespace {

constexpr MapSize kMap = {400, 400};

struct Arguments {
  SceneArguments scenes = {.num_lights = 20, .seed = 43};
  int readback = 180;
  int fine_readback = 720;
};

// The rows, in this order.
enum Row { kLit, kDark, kAutomatic, kFine, kBitsAlone, kAsPublished, kFocused, kLispsm, kNumRows };
constexpr const char* kRowNames[] = {"lit",
                                     "dark",
                                     "automatic",
                                     "with finer cover",
                                     "no third state",
                                     "as published",
                                     "focused",
                                     "lispsm"};
constexpr bool IsOurs(int row) { return row < kAsPublished; }

// A read-back with its third state, and the buffers of it.
struct Shadows {
  std::vector<uint32_t> shadow, facing, lit;

  explicit Shadows(const std::vector<Lighting>& lighting) {
    for (const Lighting at : lighting) {
      shadow.push_back(at == Lighting::kShadowed ? 1 : 0);
      lit.push_back(at == Lighting::kLit ? 1 : 0);
      facing.push_back(shadow.back() | lit.back());
    }
  }
};

struct Measured {
  double ideal = 0.0, practical = 0.0;
  double foretold = 0.0, foretold_by_bits = 0.0;  // pixels
  double mapped = 0.0;                            // of what the drawn map says, pixels
  bool is_searched = true;                        // with enough samples: else a focused map
  Border border = Border::kLit;
};

struct LightRow {
  std::string scene, light;
  bool is_for_tuning = false;
  std::vector<Measured> rows;
};

class LightBench {
 public:
  LightBench(const CompareStage& stage,
             const CompareStage& fine,
             const Light& light,
             const Arguments& arguments)
      : stage_(stage),
        light_(light),
        arguments_(arguments),
        truth_(TrueLighting(*stage.caster, stage.screen, light)),
        shadows_(TrueLighting(*stage.caster, stage.readback_surfaces, light)),
        fine_shadows_(TrueLighting(*stage.caster, fine.readback_surfaces, light)) {
    light_.shadow_bit = 0;
    readback_ = stage.readback;
    readback_.depth = stage.readback_depth;
    readback_.shadow_bits = shadows_.shadow;
    readback_.facing_bits = shadows_.facing;
    fine_cover_.columns = fine.readback.width();
    fine_cover_.rows = fine.readback.height();
    fine_cover_.nearest = fine.readback_depth;
    fine_cover_.shadow_bits = fine_shadows_.shadow;
    fine_cover_.lit_bits = fine_shadows_.lit;
  }

  // Nothing for a light for which one of the rows has no matrix.
  absl::StatusOr<std::vector<Measured>> Measure() const {
    std::vector<Measured> rows;
    for (int row = 0; row < kNumRows; ++row) {
      absl::StatusOr<Measured> measured = MeasureRow(row);
      if (!measured.ok()) return measured.status();
      rows.push_back(*measured);
    }
    return rows;
  }

 private:
  absl::StatusOr<Measured> MeasureRow(int row) const {
    Readback readback = readback_;
    if (row == kFine) readback.fine_cover = &fine_cover_;
    if (row == kBitsAlone) readback.facing_bits = {};
    Eigen::Matrix4d map_from_world;
    Border border = Border::kLit;
    bool is_searched = true;
    if (IsOurs(row) || row == kAsPublished) {
      FitOptions options;
      if (row == kDark) options.border = BorderChoice::kDark;
      if (row == kAutomatic || row == kFine || row == kBitsAlone)
        options.border = BorderChoice::kAutomatic;
      if (row == kAsPublished) {
        options = FitOptions::AsPublished();
        options.sample_by_sample = false;
      }
      const absl::StatusOr<LightMatrix> fit = FitLight(readback, light_, kMap, options);
      if (!fit.ok()) return fit.status();
      map_from_world = fit->map_from_world;
      border = fit->border;
      is_searched = fit->search.stop_reason != StopReason::kTooFewSamples;
    } else {
      MethodInput input = stage_.view;
      input.light = light_;
      input.map = kMap;
      const absl::StatusOr<MethodMap> map =
          SetUpMap(row == kFocused ? Method::kFocused : Method::kLispsm, input);
      if (!map.ok()) return map.status();
      map_from_world = map->map_from_world;
    }
    JudgeOptions judge;
    judge.phases = arguments_.scenes.phases;
    const absl::StatusOr<ShadowImage> image = JudgeMatrix(
        *stage_.caster, stage_.screen, truth_, light_, {map_from_world, kMap, border}, judge);
    if (!image.ok()) return image.status();
    constexpr double kPixels = static_cast<double>(kScreenSize) * kScreenSize;
    const absl::StatusOr<double> share =
        ForetellWrongShare(readback, light_, map_from_world, kMap, {}, border);
    if (!share.ok()) return share.status();
    readback.facing_bits = {};
    const absl::StatusOr<double> share_by_bits =
        ForetellWrongShare(readback, light_, map_from_world, kMap, {}, border);
    if (!share_by_bits.ok()) return share_by_bits.status();
    return Measured{static_cast<double>(image->wrong.ideal),
                    static_cast<double>(image->wrong.practical),
                    *share * kPixels,
                    *share_by_bits * kPixels,
                    MappedShare(map_from_world, border) * kPixels,
                    is_searched,
                    border};
  }

  // What a renderer's own map says at the pixels of read-backs whose pixels are jittered from frame
  // to frame, against the truth there: MeasuredWrongShare() of four frames.
  double MappedShare(const Eigen::Matrix4d& map_from_world, Border border) const {
    constexpr int kFrames = 4;
    double sum = 0.0;
    for (int frame = 0; frame < kFrames; ++frame) {
      Camera camera = stage_.readback.camera;
      const Eigen::Vector2d jitter(frame % 2 == 0 ? -0.25 : 0.25, frame < 2 ? -0.25 : 0.25);
      camera.screen_from_camera.topRows<2>() += jitter * camera.screen_from_camera.row(2);
      const absl::StatusOr<SurfaceImage> image = RenderSurfaces(*stage_.caster, camera);
      if (!image.ok()) return 0.0;
      const std::vector<Lighting> truth = TrueLighting(*stage_.caster, *image, light_);
      const absl::StatusOr<ShadowImage> mapped =
          JudgeMatrix(*stage_.caster, *image, truth, light_, {map_from_world, kMap, border});
      if (!mapped.ok()) return 0.0;
      ReadbackImage readback = ReadbackOf(*image);
      AddShadow(truth, light_.shadow_bit, &readback);
      const Shadows drawn(mapped->ideal);
      Readback view = readback.View();
      view.mapped_bits = drawn.shadow;
      sum += MeasuredWrongShare(view, light_).value_or(0.0) / kFrames;
    }
    return sum;
  }

  const CompareStage& stage_;
  Light light_;
  const Arguments& arguments_;
  std::vector<Lighting> truth_;
  Shadows shadows_, fine_shadows_;
  Readback readback_;
  FineCover fine_cover_;
};

absl::Status MeasureScene(size_t index,
                          const Arguments& arguments,
                          Progress& progress,
                          std::vector<LightRow>* rows) {
  const SceneCase& scene = SceneCases()[index];
  const absl::StatusOr<RayCaster> caster = LoadSceneCase(scene, arguments.scenes.folder);
  if (!caster.ok()) return caster.status();
  const absl::StatusOr<std::vector<CompareStage>> stages =
      MakeStages(scene, *caster, arguments.readback);
  if (!stages.ok()) return stages.status();
  const absl::StatusOr<std::vector<CompareStage>> fine =
      MakeStages(scene, *caster, arguments.fine_readback);
  if (!fine.ok()) return fine.status();
  const std::vector<Light> lights =
      DrawLights(scene, *caster, arguments.scenes.num_lights, arguments.scenes.seed);
  for (size_t i = 0; i < lights.size(); ++i) {
    progress.Begin(absl::StrCat(scene.name, ": ", lights[i].name));
    const size_t view = ViewOf(i, *stages);
    const LightBench bench((*stages)[view], (*fine)[view], lights[i], arguments);
    absl::StatusOr<std::vector<Measured>> measured = bench.Measure();
    if (measured.ok()) {
      rows->push_back({scene.name,
                       absl::StrCat(lights[i].name, "/", view + 1),
                       IsForTuning(index),
                       *std::move(measured)});
    }
    progress.Advance();
  }
  return absl::OkStatus();
}

// Ratio of totals and geometric mean of a row over another.
std::string RatioText(const std::vector<const LightRow*>& lights,
                      int row,
                      int reference,
                      double Measured::*kind) {
  WrongRatio ratio;
  for (const LightRow* light : lights) {
    ratio.Add(light->rows[row].*kind, light->rows[reference].*kind);
  }
  return ratio.Text();
}

// Lights on which a row has more than 1.1 times the fewest of all methods that are not ours.
int NumBehind(const std::vector<const LightRow*>& lights, int row) {
  int num_behind = 0;
  for (const LightRow* light : lights) {
    double best = light->rows[kAsPublished].ideal;
    for (int other = kAsPublished; other < kNumRows; ++other) {
      best = std::min(best, light->rows[other].ideal);
    }
    num_behind += light->rows[row].ideal > 1.1 * best + 1.0 ? 1 : 0;
  }
  return num_behind;
}

void PrintRatios(const std::string& title, const std::vector<const LightRow*>& lights) {
  if (lights.empty()) return;
  const auto num_dark = std::count_if(lights.begin(), lights.end(), [](const LightRow* light) {
    return light->rows[kAutomatic].border == Border::kDark;
  });
  std::printf("\n== %s: %d lights, %d with a dark border\n",
              title.c_str(),
              static_cast<int>(lights.size()),
              static_cast<int>(num_dark));
  std::printf("%-18s %-18s %-18s %-18s %-18s %s\n",
              "",
              "ideal/published",
              "practical/publ.",
              "ideal/lit",
              "practical/lit",
              "behind");
  for (int row = 0; row < kNumRows; ++row) {
    std::printf("%-18s %-18s %-18s %-18s %-18s %d\n",
                kRowNames[row],
                RatioText(lights, row, kAsPublished, &Measured::ideal).c_str(),
                RatioText(lights, row, kAsPublished, &Measured::practical).c_str(),
                RatioText(lights, row, kLit, &Measured::ideal).c_str(),
                RatioText(lights, row, kLit, &Measured::practical).c_str(),
                NumBehind(lights, row));
  }
}

void Print(const std::vector<LightRow>& rows) {
  std::vector<const LightRow*> tuning, report;
  for (size_t begin = 0; begin < rows.size();) {
    std::vector<const LightRow*> of_scene;
    size_t end = begin;
    for (; end < rows.size() && rows[end].scene == rows[begin].scene; ++end) {
      of_scene.push_back(&rows[end]);
      (rows[end].is_for_tuning ? tuning : report).push_back(&rows[end]);
    }
    PrintRatios(rows[begin].scene, of_scene);
    begin = end;
  }
  PrintRatios("tuning half", tuning);
  PrintRatios("report half", report);
  for (const auto& [title, foretold] : {std::pair{"third state", &Measured::foretold},
                                        std::pair{"shadow bits alone", &Measured::foretold_by_bits},
                                        std::pair{"drawn map's bit", &Measured::mapped}}) {
    ForecastTable table;
    for (const LightRow& light : rows) {
      if (!light.rows[kLit].is_searched) continue;  // hardly an edge in view
      std::vector<ForecastTable::Pixels> pixels;
      for (const Row row : {kLit, kDark, kAsPublished, kFocused, kLispsm}) {
        pixels.push_back({light.rows[row].ideal, light.rows[row].*foretold});
      }
      table.Add(light.scene, pixels, 0);
    }
    std::printf("\n%s", table.Text(title).c_str());
  }
}

absl::Status WriteCsv(const std::string& path, const std::vector<LightRow>& rows) {
  std::string text =
      "scene,light,half,row,border,ideal,practical,foretold,foretold_by_bits,mapped\n";
  for (const LightRow& light : rows) {
    for (int row = 0; row < kNumRows; ++row) {
      const Measured& measured = light.rows[row];
      absl::StrAppendFormat(&text,
                            "%s,%s,%s,%s,%s,%g,%g,%g,%g,%g\n",
                            light.scene,
                            light.light,
                            light.is_for_tuning ? "tuning" : "report",
                            kRowNames[row],
                            BorderName(measured.border),
                            measured.ideal,
                            measured.practical,
                            measured.foretold,
                            measured.foretold_by_bits,
                            measured.mapped);
    }
  }
  return WriteTextFileAtomically(path, text);
}

absl::Status Run(const Arguments& arguments) {
  std::vector<LightRow> rows;
  {
    Progress progress(arguments.scenes.num_lights * static_cast<int>(SceneCases().size()));
    absl::Status status = ForEachScene(arguments.scenes, [&](size_t scene) {
      return MeasureScene(scene, arguments, progress, &rows);
    });
    if (!status.ok()) return status;
  }
  Print(rows);
  if (arguments.scenes.only.empty()) {
    const absl::StatusOr<std::string> text = ReadbackBordersText(DefaultReadbackFolder(), kMap);
    if (!text.ok()) return text.status();
    std::printf("%s", text->c_str());
  }
  const std::string& path = arguments.scenes.csv_path;
  return path.empty() ? absl::OkStatus() : WriteCsv(path, rows);
}

}  // namespace
}  // namespace lightfit

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): options are ours
  lightfit::Arguments arguments;
  CLI::App app("Borders and finer covers, judged by wrong pixels; and how well they are foretold.");
  lightfit::DeclareLights(&app, "--lights", &arguments.scenes);
  app.add_option("--readback", arguments.readback, "Side of the read-back, pixels")
      ->capture_default_str();
  app.add_option("--fine", arguments.fine_readback, "Side of the finer cover's image, pixels")
      ->capture_default_str();
  lightfit::DeclarePhases(&app, &arguments.scenes.phases);
  lightfit::DeclareHalf(&app, &arguments.scenes);
  lightfit::DeclareScenes(&app, &arguments.scenes);
  lightfit::DeclareCsv(&app, &arguments.scenes);
  CLI11_PARSE(app, argc, argv);
  return lightfit::ExitCodeOf("borders", lightfit::Run(arguments));
}
