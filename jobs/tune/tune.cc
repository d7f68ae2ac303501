#include "jobs/tune/tune.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "jobs/tune/minimize.h"
#include "jobs/tune/moved_map.h"
#include "optimizer/evaluate.h"
#include "optimizer/fit.h"

namespace lightfit {

namespace {

constexpr size_t kFinalists = 4;

// Wrong pixels of a finalist over the fit's, below which it takes its place: the rest of the noise.
constexpr double kWorthwhile = 0.99;

// The judge, for one light.
class Counter {
 public:
  Counter(const CompareStage& stage,
          absl::Span<const Lighting> truth,
          const Light& light,
          Border border,
          const TuneOptions& options)
      : stage_(stage), truth_(truth), light_(light), border_(border), options_(options) {}

  absl::StatusOr<int64_t> Count(const Eigen::Matrix4d& map_from_world, int phases) const {
    const absl::StatusOr<ShadowImage> shadows =
        JudgeMatrix(*stage_.caster,
                    stage_.screen,
                    truth_,
                    light_,
                    {map_from_world, options_.map, border_},
                    {.constant_share = options_.constant_share, .phases = phases});
    if (!shadows.ok()) return shadows.status();
    return CountOf(shadows->wrong, options_.bias);
  }

 private:
  const CompareStage& stage_;
  absl::Span<const Lighting> truth_;
  const Light& light_;
  Border border_;
  const TuneOptions& options_;
};

// What the search is to think of a map that is none: worse than any map, and finite.
double Refused(const CompareStage& stage) {
  return 2.0 * static_cast<double>(stage.screen.pixels.size());
}

// `options` are those of the view.
absl::Status Measure(const LightView& view,
                     const FitOptions& options,
                     const Counter& counter,
                     TunedMap* map) {
  const absl::StatusOr<int64_t> check = counter.Count(map->matrix.map_from_world, kCheckPhases);
  if (!check.ok()) return check.status();
  map->check = *check;
  const absl::StatusOr<Figures> figures =
      EvaluateMatrix(view, map->matrix.map_from_world, map->matrix.map, options);
  if (figures.ok()) {
    map->foretold = figures->wrong_share;
    map->matrix.figures.energy = figures->energy;
    map->matrix.figures.footprint = figures->footprint;
  }
  return absl::OkStatus();
}

// A map that the search has tried.
struct Tried {
  std::vector<double> moves;
  double wrong = 0.0;
};

// The search itself: those of the fewest wrong pixels, in this order; or what the journal has
// against going on.
absl::StatusOr<std::vector<Tried>> SearchMoves(const MovableMap& movable,
                                               const Counter& counter,
                                               const TuneOptions& options,
                                               double refused,
                                               int number,
                                               Journal* journal) {
  absl::Status status;
  std::vector<Tried> best;
  const Objective objective = [&](const std::vector<double>& moves) -> std::optional<double> {
    std::optional<double> value = journal->Next(number);
    if (!value.has_value()) {
      value = refused;
      const absl::StatusOr<Eigen::Matrix4d> map_from_world = movable.Moved(moves);
      if (map_from_world.ok()) {
        const absl::StatusOr<int64_t> wrong = counter.Count(*map_from_world, kTunePhases);
        if (wrong.ok()) value = static_cast<double>(*wrong);
      }
      status.Update(journal->Append(number, *value));
      if (!status.ok()) return std::nullopt;
    }
    if (*value < refused) {
      // The first of equal ones stays in front.
      const auto place =
          std::upper_bound(best.begin(), best.end(), *value, [](double wrong, const Tried& tried) {
            return wrong < tried.wrong;
          });
      best.insert(place, {moves, *value});
      if (best.size() > kFinalists) best.pop_back();
    }
    if (options.after_evaluation) options.after_evaluation(best.empty() ? *value : best[0].wrong);
    return value;
  };
  MinimizeOptions minimize;
  minimize.evaluations = options.evaluations;
  minimize.seed = options.seed;
  (void)Minimize(objective, std::vector<double>(kNumMoves, 0.0), minimize);
  if (!status.ok()) return status;
  return best;
}

// Of the finalists the one with the fewest wrong pixels at phases that did not choose them: the
// least of many values that jump about is part luck. Absent when that is not worthwhile.
std::optional<TunedMap> ChooseFinalist(const MovableMap& movable,
                                       const Counter& counter,
                                       const std::vector<Tried>& finalists,
                                       const TunedMap& fit) {
  const absl::StatusOr<int64_t> fit_wrong = counter.Count(fit.matrix.map_from_world, kFinalPhases);
  if (!fit_wrong.ok()) return std::nullopt;
  double least = kWorthwhile * static_cast<double>(*fit_wrong);
  std::optional<TunedMap> chosen;
  for (const Tried& finalist : finalists) {
    const absl::StatusOr<Eigen::Matrix4d> map_from_world = movable.Moved(finalist.moves);
    if (!map_from_world.ok()) continue;
    const absl::StatusOr<int64_t> wrong = counter.Count(*map_from_world, kFinalPhases);
    if (!wrong.ok() || static_cast<double>(*wrong) >= least) continue;
    least = static_cast<double>(*wrong);
    chosen = fit;
    chosen->matrix.map_from_world = *map_from_world;
    chosen->wrong = std::llround(finalist.wrong);
  }
  return chosen;
}

}  // namespace

absl::Status ValidateTuneOptions(const TuneOptions& options) {
  constexpr int kMaxEvaluations = 10'000'000;
  if (options.evaluations < 1 || options.evaluations > kMaxEvaluations) {
    return absl::InvalidArgumentError(
        absl::StrFormat("evaluations = %d, want 1 to %d maps for each light",
                        options.evaluations,
                        kMaxEvaluations));
  }
  if (absl::Status status = ValidateMapSize(options.map, options.fit.margin_texels); !status.ok()) {
    return status;
  }
  return ValidateFitOptions(options.fit);
}

absl::StatusOr<TunedLight> TuneLight(const CompareStage& stage,
                                     const Light& light,
                                     const TuneOptions& options,
                                     int number,
                                     Journal* journal) {
  TunedLight result;
  result.light = light;
  const auto failed = [&result](const absl::Status& status) {
    result.status = status;
    return result;
  };
  if (absl::Status status = ValidateLight(light); !status.ok()) return failed(status);
  const LitStage frame = Lit(stage, light);
  if (!frame.surfaces->ok()) return failed(frame.surfaces->status());
  LightMatrices fits =
      FitLights(**frame.surfaces, absl::MakeConstSpan(&frame.light, 1), options.map, options.fit);
  absl::StatusOr<LightMatrix> fit = std::move(fits.front());
  if (!fit.ok()) return failed(fit.status());
  const Border border = fit->border;
  // What the read-back shows of the light where its map has this border.
  FitOptions view_options = options.fit;
  view_options.border = border == Border::kDark ? BorderChoice::kDark : BorderChoice::kLit;
  const absl::StatusOr<LightView> view = ViewLight(**frame.surfaces, frame.light, view_options);
  if (!view.ok()) return failed(view.status());

  const std::vector<Lighting> truth = TrueLighting(*stage.caster, stage.screen, light);
  const Counter counter(stage, truth, frame.light, border, options);
  absl::StatusOr<MovableMap> movable =
      MovableMap::Make(frame.light,
                       fit->map_from_world,
                       options.map,
                       border,
                       view->normalized_from_ray().inverse().col(2));
  if (!movable.ok()) return failed(movable.status());
  movable->SetReceivers(stage.screen, truth);
  const absl::StatusOr<int64_t> fit_wrong = counter.Count(fit->map_from_world, kTunePhases);
  if (!fit_wrong.ok()) return failed(fit_wrong.status());
  result.fit.matrix = *std::move(fit);
  result.fit.wrong = *fit_wrong;
  if (absl::Status status = Measure(*view, view_options, counter, &result.fit); !status.ok()) {
    return failed(status);
  }

  const absl::StatusOr<std::vector<Tried>> finalists =
      SearchMoves(*movable, counter, options, Refused(stage), number, journal);
  if (!finalists.ok()) return finalists.status();
  result.evaluations = options.evaluations;
  result.tuned = result.fit;
  std::optional<TunedMap> tuned = ChooseFinalist(*movable, counter, *finalists, result.fit);
  if (!tuned.has_value()) return result;
  SearchReport& report = tuned->matrix.search;
  report = SearchReport();
  report.energy_start = result.fit.matrix.figures.energy;
  report.stop_reason = StopReason::kRoundLimit;
  report.evaluations = result.evaluations;
  if (absl::Status status = Measure(*view, view_options, counter, &*tuned); !status.ok()) {
    return failed(status);
  }
  result.tuned = *std::move(tuned);
  return result;
}

TuneTotals TotalsOf(absl::Span<const TunedLight> lights) {
  TuneTotals totals;
  double sum = 0.0, check_sum = 0.0;
  const auto log_ratio = [](int64_t a, int64_t b) {
    return std::log((static_cast<double>(a) + 1.0) / (static_cast<double>(b) + 1.0));
  };
  for (const TunedLight& light : lights) {
    if (!light.status.ok()) continue;
    ++totals.num_lights;
    totals.fit_wrong += light.fit.wrong;
    totals.tuned_wrong += light.tuned.wrong;
    totals.fit_check += light.fit.check;
    totals.tuned_check += light.tuned.check;
    sum += log_ratio(light.fit.wrong, light.tuned.wrong);
    check_sum += log_ratio(light.fit.check, light.tuned.check);
  }
  if (totals.num_lights > 0) {
    totals.mean_ratio = std::exp(sum / totals.num_lights);
    totals.mean_check_ratio = std::exp(check_sum / totals.num_lights);
  }
  return totals;
}

}  // namespace lightfit
