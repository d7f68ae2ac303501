// bench/plans/plans.cc : several maps for one light, at equal texels, judged by wrong pixels.
//
// In:   the scenes of bench/scene_set.h, lights in turn over their cameras; read-backs of two
//       sizes.
// Out:  wrong pixels of plans over those of one map with a lit border fitted from the
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
#include <chrono>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/progress.h"
#include "bench/plans/plan_rows.h"
#include "bench/plans/plan_table.h"
#include "bench/scene_run.h"
#include "jobs/compare/stage.h"
#include "jobs/schemes/judge_maps.h"
#include "partition/evaluate_plan.h"
#include "render/plan_costs.h"
#include "render/true_lighting.h"

namespace lightfit {
namespace {

struct Arguments {
  SceneArguments scenes = {.num_lights = 6, .seed = 61};
  int readback = 180;
  int large_readback = 360;
  std::vector<int> num_maps = {2, 4, 8};
};

class LightBench {
 public:
  LightBench(const CompareStage& stage,
             const CompareStage& large,
             const Light& light,
             const Arguments& arguments)
      : stage_(stage),
        arguments_(arguments),
        truth_(TrueLighting(*stage.caster, stage.screen, light)),
        small_(Lit(stage, light)),
        large_(Lit(large, light)) {}

  absl::StatusOr<std::vector<MeasuredPlan>> Measure(const std::vector<PlanRow>& rows) const {
    for (const LitStage* lit : {&small_, &large_}) {
      if (!lit->surfaces->ok()) return lit->surfaces->status();
    }
    std::vector<MeasuredPlan> measured;
    measured.reserve(rows.size());
    for (const PlanRow& row : rows) {
      measured.push_back(MeasureRow(row, {stage_.view, *LitOf(row).surfaces, small_.light}));
    }
    if (!measured.front().is_there) return absl::NotFoundError("no single map");
    return measured;
  }

 private:
  MeasuredPlan MeasureRow(const PlanRow& row, const SchemeInput& input) const {
    MeasuredPlan best;
    for (const Scheme& scheme : row.schemes) {
      const MeasuredPlan measured = MeasureScheme(row, scheme, input);
      if (measured.is_there && (!best.is_there || measured.ideal < best.ideal)) best = measured;
    }
    return best;
  }

  MeasuredPlan MeasureScheme(const PlanRow& row,
                             const Scheme& scheme,
                             const SchemeInput& input) const {
    MeasuredPlan measured;
    const auto begin = std::chrono::steady_clock::now();
    const absl::StatusOr<SchemeMaps> maps = scheme.set_up(input);
    measured.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (!maps.ok()) return measured;
    JudgeOptions judge;
    judge.phases = arguments_.scenes.phases;
    const absl::StatusOr<ShadowImage> image =
        JudgeMaps(*stage_.caster, stage_.screen, truth_, small_.light, *maps, judge);
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
  bool AddPlan(const PlanRow& row, const Plan& plan, MeasuredPlan* measured) const {
    const absl::StatusOr<PlanCosts> costs =
        MeasurePlanCosts(*stage_.caster, stage_.screen, truth_, small_.light, plan);
    if (!costs.ok()) return false;
    measured->is_plan = true;
    measured->overlap = costs->overlap;
    measured->draws = costs->draws_per_caster;
    constexpr double kPixels = static_cast<double>(kScreenSize) * kScreenSize;
    measured->foretold =
        kPixels * ForetellPlan(LitOf(row).readback, small_.light, plan, {}).value_or(0.0);
    return true;
  }

  // The read-back that a row is fitted from.
  const LitStage& LitOf(const PlanRow& row) const { return row.from_large ? large_ : small_; }

  const CompareStage& stage_;
  const Arguments& arguments_;
  std::vector<Lighting> truth_;
  LitStage small_, large_;
};

absl::Status MeasureScene(size_t index,
                          const Arguments& arguments,
                          const std::vector<PlanRow>& rows,
                          Progress& progress,
                          std::vector<PlannedLightRow>* lights) {
  const SceneCase& scene = SceneCases()[index];
  const absl::StatusOr<RayCaster> caster = LoadSceneCase(scene, arguments.scenes.folder);
  if (!caster.ok()) return caster.status();
  const absl::StatusOr<std::vector<CompareStage>> stages =
      MakeStages(scene, *caster, arguments.readback);
  if (!stages.ok()) return stages.status();
  const absl::StatusOr<std::vector<CompareStage>> large =
      MakeStages(scene, *caster, arguments.large_readback);
  if (!large.ok()) return large.status();
  const std::vector<Light> drawn =
      DrawLights(scene, *caster, arguments.scenes.num_lights, arguments.scenes.seed);
  for (size_t i = 0; i < drawn.size(); ++i) {
    progress.Begin(absl::StrCat(scene.name, ": ", drawn[i].name));
    const size_t view = ViewOf(i, *stages);
    const LightBench bench((*stages)[view], (*large)[view], drawn[i], arguments);
    absl::StatusOr<std::vector<MeasuredPlan>> measured = bench.Measure(rows);
    if (measured.ok()) {
      lights->push_back({scene.name, absl::StrCat(drawn[i].name, "/", view + 1), *measured});
    }
    progress.Advance();
  }
  return absl::OkStatus();
}

absl::Status Run(const Arguments& arguments) {
  const std::vector<PlanRow> rows =
      MakePlanRows(arguments.num_maps, arguments.readback, arguments.large_readback);
  std::vector<PlannedLightRow> lights;
  {
    Progress progress(arguments.scenes.num_lights * static_cast<int>(SceneCases().size()));
    absl::Status status = ForEachScene(arguments.scenes, [&](size_t scene) {
      return MeasureScene(scene, arguments, rows, progress, &lights);
    });
    if (!status.ok()) return status;
  }
  PrintPlanTables(rows, lights);
  const std::string& path = arguments.scenes.csv_path;
  return path.empty() ? absl::OkStatus() : WritePlanCsv(path, rows, lights);
}

}  // namespace
}  // namespace lightfit

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): options are ours
  lightfit::Arguments arguments;
  CLI::App app("Several maps for one light, judged by wrong pixels at equal texels.");
  lightfit::DeclareLights(&app, "--lights", &arguments.scenes);
  app.add_option("--readback", arguments.readback, "Side of the smaller read-back, pixels")
      ->capture_default_str();
  app.add_option("--large", arguments.large_readback, "Side of the larger read-back, pixels")
      ->capture_default_str();
  app.add_option("--maps", arguments.num_maps, "How many maps plans may have")
      ->delimiter(',')
      ->capture_default_str();
  lightfit::DeclarePhases(&app, &arguments.scenes.phases);
  lightfit::DeclareHalf(&app, &arguments.scenes);
  lightfit::DeclareScenes(&app, &arguments.scenes);
  lightfit::DeclareCsv(&app, &arguments.scenes);
  CLI11_PARSE(app, argc, argv);
  return lightfit::ExitCodeOf("plans", lightfit::Run(arguments));
}
