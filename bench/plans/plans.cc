// bench/plans/plans.cc : several maps for one light, at equal texels, judged by wrong pixels.
//
// In:   the scenes of bench/scene_set.h, lights in turn over their cameras; read-backs of two
// sizes. Out:  wrong pixels of plans over those of one map with a lit border fitted from the
// smaller
//       read-back, as ratio of totals and as geometric mean, ideal and practical bias, four phases:
//       over all lights, indoors, per scene; the worst light among those with 300 wrong pixels or
//       more; the same over other rows; time in fits of one map. --csv: per light and row, all of
//       it.
//
// Virtual pages have a row at these texels and one at 2048 x 2048; pages, cubes and paraboloids are
// over the lights that they are for.
//
// The tables of docs/plans.md.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/progress.h"
#include "base/text_file.h"
#include "bench/plans/plan_rows.h"
#include "bench/scene_set.h"
#include "jobs/compare/stage.h"
#include "jobs/schemes/judge_maps.h"
#include "optimizer/figures/foretell.h"
#include "optimizer/readback/surfaces.h"
#include "render/plan_costs.h"
#include "render/true_lighting.h"

namespace lightfit {
namespace {

struct Arguments {
  int num_lights = 6;
  uint64_t seed = 61;
  int readback = 180;
  int large_readback = 360;
  int phases = 4;
  std::vector<int> num_maps = {2, 4, 8};
  std::string half;  // empty: both
  std::string only;
  std::string folder = DefaultSceneFolder();
  std::string csv_path;
};

struct Measured {
  bool is_there = false;
  double ideal = 0.0, practical = 0.0, outside = 0.0;
  double seconds = 0.0;
  int num_maps = 0;

  // Of matrices: maps that hold a receiver, draws for each caster; wrong pixels foretold.
  bool is_plan = false;
  double overlap = 0.0, draws = 0.0, foretold = 0.0;
};

struct LightRow {
  std::string scene, light;
  std::vector<Measured> rows;
};

// A read-back with its third state, and what it refers to.
struct View {
  std::vector<uint32_t> shadow, facing;
  Readback readback;

  View(const CompareStage& stage, const Light& light) : readback(stage.readback) {
    for (const Lighting at : TrueLighting(*stage.caster, stage.readback_surfaces, light)) {
      shadow.push_back(at == Lighting::kShadowed ? 1 : 0);
      facing.push_back(at == Lighting::kShadowed || at == Lighting::kLit ? 1 : 0);
    }
    readback.depth = stage.readback_depth;
    readback.shadow_bits = shadow;
    readback.facing_bits = facing;
  }
};

class LightBench {
 public:
  LightBench(const CompareStage& stage,
             const CompareStage& large,
             const Light& light,
             const Arguments& arguments)
      : stage_(stage),
        light_(light),
        arguments_(arguments),
        truth_(TrueLighting(*stage.caster, stage.screen, light)),
        small_view_(stage, light),
        large_view_(large, light) {
    light_.shadow_bit = 0;
  }

  absl::StatusOr<std::vector<Measured>> Measure(const std::vector<PlanRow>& rows) const {
    const absl::StatusOr<Surfaces> small = FindSurfaces(small_view_.readback, 1, {});
    if (!small.ok()) return small.status();
    const absl::StatusOr<Surfaces> large = FindSurfaces(large_view_.readback, 1, {});
    if (!large.ok()) return large.status();
    std::vector<Measured> measured;
    measured.reserve(rows.size());
    for (const PlanRow& row : rows) {
      measured.push_back(MeasureRow(row, {stage_.view, row.from_large ? large : small, light_}));
    }
    if (!measured.front().is_there) return absl::NotFoundError("no single map");
    return measured;
  }

 private:
  Measured MeasureRow(const PlanRow& row, const SchemeInput& input) const {
    Measured best;
    for (const Scheme& scheme : row.schemes) {
      const Measured measured = MeasureScheme(row, scheme, input);
      if (measured.is_there && (!best.is_there || measured.ideal < best.ideal)) best = measured;
    }
    return best;
  }

  Measured MeasureScheme(const PlanRow& row, const Scheme& scheme, const SchemeInput& input) const {
    Measured measured;
    const auto begin = std::chrono::steady_clock::now();
    const absl::StatusOr<SchemeMaps> maps = scheme.set_up(input);
    measured.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (!maps.ok()) return measured;
    JudgeOptions judge;
    judge.phases = arguments_.phases;
    const absl::StatusOr<ShadowImage> image =
        JudgeMaps(*stage_.caster, stage_.screen, truth_, light_, *maps, judge);
    if (!image.ok()) return measured;
    const Plan* plan = PlanOf(*maps);
    if (plan != nullptr && !AddPlan(row, *plan, &measured)) return measured;
    measured.is_there = NumTexels(*maps) <= row.texels;
    measured.ideal = static_cast<double>(image->wrong.ideal);
    measured.practical = static_cast<double>(image->wrong.practical);
    measured.outside = static_cast<double>(image->wrong.outside);
    measured.num_maps = NumMaps(*maps);
    return measured;
  }

  // Whether it could be measured.
  bool AddPlan(const PlanRow& row, const Plan& plan, Measured* measured) const {
    const absl::StatusOr<PlanCosts> costs =
        MeasurePlanCosts(*stage_.caster, stage_.screen, truth_, light_, plan);
    if (!costs.ok()) return false;
    measured->is_plan = true;
    measured->overlap = costs->overlap;
    measured->draws = costs->draws_per_caster;
    std::vector<SizedMatrix> maps;
    for (const PlanMap& map : plan.maps) maps.push_back({map.map_from_world, map.size});
    constexpr double kPixels = static_cast<double>(kScreenSize) * kScreenSize;
    const Readback& readback = row.from_large ? large_view_.readback : small_view_.readback;
    measured->foretold =
        kPixels * ForetellWrongShare(readback, light_, maps, {}, plan.border).value_or(0.0);
    return true;
  }

  const CompareStage& stage_;
  Light light_;
  const Arguments& arguments_;
  std::vector<Lighting> truth_;
  View small_view_, large_view_;
};

absl::Status MeasureScene(size_t index,
                          const Arguments& arguments,
                          const std::vector<PlanRow>& rows,
                          Progress& progress,
                          std::vector<LightRow>* lights) {
  const SceneCase& scene = SceneCases()[index];
  const absl::StatusOr<RayCaster> caster = LoadSceneCase(scene, arguments.folder);
  if (!caster.ok()) return caster.status();
  const absl::StatusOr<std::vector<CompareStage>> stages =
      MakeStages(scene, *caster, arguments.readback);
  if (!stages.ok()) return stages.status();
  const absl::StatusOr<std::vector<CompareStage>> large =
      MakeStages(scene, *caster, arguments.large_readback);
  if (!large.ok()) return large.status();
  const std::vector<Light> drawn = DrawLights(scene, *caster, arguments.num_lights, arguments.seed);
  for (size_t i = 0; i < drawn.size(); ++i) {
    progress.Begin(absl::StrCat(scene.name, ": ", drawn[i].name));
    const size_t view = ViewOf(i, *stages);
    const LightBench bench((*stages)[view], (*large)[view], drawn[i], arguments);
    absl::StatusOr<std::vector<Measured>> measured = bench.Measure(rows);
    if (measured.ok()) {
      lights->push_back({scene.name, absl::StrCat(drawn[i].name, "/", view + 1), *measured});
    }
    progress.Advance();
  }
  return absl::OkStatus();
}

using Lights = std::vector<const LightRow*>;

// "0.82 0.78 1.13": ratio of totals, geometric mean, worst of those with 300 wrong pixels.
std::string RatioText(
    const Lights& lights, size_t row, size_t reference, double Measured::*kind, bool with_worst) {
  constexpr double kEnoughPixels = 300.0;
  double sum = 0.0, sum_reference = 0.0, log_sum = 0.0, worst = 0.0;
  int count = 0;
  for (const LightRow* light : lights) {
    const Measured& measured = light->rows[row];
    const Measured& other = light->rows[reference];
    if (!measured.is_there || !other.is_there) continue;
    const double wrong = measured.*kind, of_other = other.*kind;
    sum += wrong;
    sum_reference += of_other;
    log_sum += std::log((wrong + 1.0) / (of_other + 1.0));
    if (of_other >= kEnoughPixels) worst = std::max(worst, wrong / of_other);
    ++count;
  }
  if (count == 0) return "-";
  std::string text =
      absl::StrFormat("%.2f %.2f", sum / std::max(1.0, sum_reference), std::exp(log_sum / count));
  if (with_worst) absl::StrAppendFormat(&text, " %.2f", worst);
  return text;
}

void PrintRatios(const std::string& title, const std::vector<PlanRow>& rows, const Lights& lights) {
  if (lights.empty()) return;
  std::printf("\n== %s: %d lights\n", title.c_str(), static_cast<int>(lights.size()));
  std::printf("%-24s %-16s %-16s %-12s %-12s %-12s %-6s %-8s %-6s %s\n",
              "over one map:",
              "ideal, worst",
              "practical",
              "/one chosen",
              "/published",
              "/ZP4+LiSPSM",
              "maps",
              "overlap",
              "draws",
              "time in fits");
  for (size_t row = 0; row < rows.size(); ++row) {
    double seconds = 0.0, seconds_of_one = 0.0, num_maps = 0.0, overlap = 0.0, draws = 0.0;
    int count = 0, num_plans = 0;
    for (const LightRow* light : lights) {
      const Measured& measured = light->rows[row];
      if (!measured.is_there) continue;
      ++count;
      num_plans += measured.is_plan ? 1 : 0;
      seconds += measured.seconds;
      seconds_of_one += light->rows[0].seconds;
      num_maps += measured.num_maps;
      overlap += measured.overlap;
      draws += measured.draws;
    }
    if (count == 0) continue;
    const auto of_plans = [num_plans](double sum) {
      return num_plans > 0 ? absl::StrFormat("%.2f", sum / num_plans) : "-";
    };
    std::printf("%-24s %-16s %-16s %-12s %-12s %-12s %-6.1f %-8s %-6s %.1f\n",
                rows[row].name.c_str(),
                RatioText(lights, row, kOneMap, &Measured::ideal, true).c_str(),
                RatioText(lights, row, kOneMap, &Measured::practical, false).c_str(),
                RatioText(lights, row, kOneChosen, &Measured::ideal, false).c_str(),
                RatioText(lights, row, kAsPublishedMap, &Measured::ideal, false).c_str(),
                RatioText(lights, row, kZp4, &Measured::ideal, false).c_str(),
                num_maps / count,
                of_plans(overlap).c_str(),
                of_plans(draws).c_str(),
                seconds / seconds_of_one);
  }
}

// How many lights a row has more than `factor` times the wrong pixels of another on.
int NumBehind(const Lights& lights, size_t row, size_t other, double factor) {
  return static_cast<int>(std::count_if(lights.begin(), lights.end(), [&](const LightRow* light) {
    const Measured& measured = light->rows[row];
    const Measured& reference = light->rows[other];
    return measured.is_there && reference.is_there &&
           measured.ideal > factor * reference.ideal + 1.0;
  }));
}

// On how many lights plans of several maps are behind others.
void PrintBehind(const std::vector<PlanRow>& rows, const Lights& lights) {
  std::printf("\n== lights of %d on which a row has more wrong pixels than ...\n",
              static_cast<int>(lights.size()));
  std::printf("%-24s %-18s", "", "1.1 ZP4+LiSPSM");
  for (const PlanRow& row : rows) {
    if (row.kind == PlanRow::Kind::kPublished) std::printf(" %s", row.name.c_str());
  }
  std::printf("\n");
  for (size_t row = 0; row < rows.size(); ++row) {
    if (rows[row].kind != PlanRow::Kind::kOurs) continue;
    std::printf("%-24s %-18d", rows[row].name.c_str(), NumBehind(lights, row, kZp4, 1.1));
    for (size_t other = 0; other < rows.size(); ++other) {
      if (rows[other].kind != PlanRow::Kind::kPublished) continue;
      std::printf(
          " %*d", static_cast<int>(rows[other].name.size()), NumBehind(lights, row, other, 1.0));
    }
    std::printf("\n");
  }
}

void Print(const std::vector<PlanRow>& rows, const std::vector<LightRow>& lights) {
  Lights all, indoors;
  for (size_t begin = 0; begin < lights.size();) {
    Lights of_scene;
    size_t end = begin;
    for (; end < lights.size() && lights[end].scene == lights[begin].scene; ++end) {
      of_scene.push_back(&lights[end]);
      all.push_back(&lights[end]);
      const std::string& name = lights[end].scene;
      if (name == "sponza_atrium" || name.find("room") != std::string::npos)
        indoors.push_back(&lights[end]);
    }
    PrintRatios(lights[begin].scene, rows, of_scene);
    begin = end;
  }
  PrintRatios("indoors", rows, indoors);
  PrintRatios("all", rows, all);
  PrintBehind(rows, all);
}

absl::Status WriteCsv(const std::string& path,
                      const std::vector<PlanRow>& rows,
                      const std::vector<LightRow>& lights) {
  std::string text =
      "scene,light,row,maps,ideal,practical,outside,overlap,draws,foretold,seconds\n";
  for (const LightRow& light : lights) {
    for (size_t row = 0; row < rows.size(); ++row) {
      const Measured& measured = light.rows[row];
      if (!measured.is_there) continue;
      const std::string of_plan =
          measured.is_plan
              ? absl::StrFormat("%g,%g,%g", measured.overlap, measured.draws, measured.foretold)
              : ",,";
      absl::StrAppendFormat(&text,
                            "%s,%s,\"%s\",%d,%g,%g,%g,%s,%g\n",
                            light.scene,
                            light.light,
                            rows[row].name,
                            measured.num_maps,
                            measured.ideal,
                            measured.practical,
                            measured.outside,
                            of_plan,
                            measured.seconds);
    }
  }
  return WriteTextFileAtomically(path, text);
}

absl::Status Run(const Arguments& arguments) {
  const std::vector<PlanRow> rows =
      MakePlanRows(arguments.num_maps, arguments.readback, arguments.large_readback);
  std::vector<LightRow> lights;
  std::string names;
  for (const SceneCase& scene : SceneCases()) absl::StrAppend(&names, " ", scene.name);
  if (!absl::StrContains(names, arguments.only)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("--only %s: no such scene; there are%s", arguments.only, names));
  }
  {
    Progress progress(arguments.num_lights * static_cast<int>(SceneCases().size()));
    for (size_t i = 0; i < SceneCases().size(); ++i) {
      const SceneCase& scene = SceneCases()[i];
      if (!arguments.only.empty() && scene.name != arguments.only) continue;
      if (!arguments.half.empty() && (arguments.half == "tuning") != IsForTuning(i)) continue;
      absl::Status status = MeasureScene(i, arguments, rows, progress, &lights);
      if (absl::IsNotFound(status)) {
        std::printf("%s left out: %s\n", scene.name.c_str(), std::string(status.message()).c_str());
        continue;
      }
      if (!status.ok()) return status;
    }
  }
  Print(rows, lights);
  return arguments.csv_path.empty() ? absl::OkStatus() : WriteCsv(arguments.csv_path, rows, lights);
}

}  // namespace
}  // namespace lightfit

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): options are ours
  lightfit::Arguments arguments;
  CLI::App app("Several maps for one light, judged by wrong pixels at equal texels.");
  app.add_option("--lights", arguments.num_lights, "Per scene")->capture_default_str();
  app.add_option("--seed", arguments.seed, "Of the lights")->capture_default_str();
  app.add_option("--readback", arguments.readback, "Side of the smaller read-back, pixels")
      ->capture_default_str();
  app.add_option("--large", arguments.large_readback, "Side of the larger read-back, pixels")
      ->capture_default_str();
  app.add_option("--phases", arguments.phases, "That counts are averaged over")
      ->capture_default_str();
  app.add_option("--maps", arguments.num_maps, "How many maps plans may have")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--half", arguments.half, "tuning or report; default both")
      ->check(CLI::IsMember({"tuning", "report"}));
  app.add_option("--only", arguments.only, "One scene, by name");
  app.add_option("--scenes", arguments.folder, "Folder with the scene files")
      ->capture_default_str();
  app.add_option("--csv", arguments.csv_path, "One row per light and method");
  CLI11_PARSE(app, argc, argv);
  const absl::Status status = lightfit::Run(arguments);
  if (status.ok()) return 0;
  std::fprintf(stderr, "plans: %s\n", std::string(status.message()).c_str());
  return 1;
}
