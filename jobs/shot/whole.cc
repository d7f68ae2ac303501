#include "jobs/shot/whole.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/parallel.h"
#include "jobs/shot/judge.h"
#include "jobs/shot/whole_plans.h"
#include "optimizer/energy/reweighting.h"
#include "optimizer/energy/summary_total.h"
#include "optimizer/fit.h"

namespace lightfit {
namespace {

// Frames that a thread takes in one go: it reads one more, the frame before them.
constexpr int kFramesAtOnce = 8;

// Further rounds are not worth their reading below this share of the energy.
constexpr double kLeastGain = 1e-4;

// A light's matrix for the whole shot; its energy is the sum over all frames.
using ShotMatrices = LightMatrices;

// The minimum of the summed summaries.
absl::StatusOr<LightMatrix> FitTotal(const SummaryTotal& total,
                                     const Light& light,
                                     const ShotJob& job) {
  const absl::StatusOr<Summary> summary = SummaryOfTotal(total);
  if (!summary.ok()) return summary.status();
  return Fit(*summary, light, job.map, job.fit());
}

ShotMatrices FitSum(const SummarySet& sum, const ShotJob& job) {
  ShotMatrices matrices;
  for (size_t i = 0; i < job.lights.size(); ++i) {
    const Light& light = job.lights[i];
    if (const absl::Status still = job.StandsStill(i); !still.ok()) {
      matrices.emplace_back(still);
      continue;
    }
    matrices.emplace_back(absl::FailedPreconditionError(
        absl::StrFormat("light \"%s\": no frame of the shot could be read", light.name)));
    for (const LightSummary& summary : sum.lights) {
      if (summary.name() != light.name) continue;
      matrices.back() = summary.total.num_frames > 0 ? FitTotal(summary.total, light, job)
                                                     : absl::StatusOr<LightMatrix>(summary.failure);
    }
  }
  return matrices;
}

// Every light's samples of all frames, weighed in its matrix. Null where there is none.
std::vector<std::optional<SummaryTotal>> WeighAllFrames(const ShotMatrices& matrices,
                                                        int round,
                                                        ShotContext* context) {
  const ShotJob& job = context->job;
  std::vector<std::optional<SummaryTotal>> totals(job.lights.size());
  std::mutex mutex;
  const auto weigh = [&](size_t frame) {
    const absl::StatusOr<ReadbackFile> file = ReadFrame(job, frame);
    context->frame_status[frame] = file.status();
    const FrameViews views(job, frame, file);
    for (size_t i = 0; i < job.lights.size(); ++i) {
      if (!matrices[i].ok() || !views[i].ok()) continue;
      const absl::StatusOr<Summary> summary =
          SummarizeInMap(*views[i], matrices[i]->map_from_world, job.fit());
      if (!summary.ok()) continue;  // as when it was summarised first: the light is not seen here
      const SummaryTotal own = TotalOf(*summary, job.lights[i]);
      const std::lock_guard<std::mutex> lock(mutex);
      if (totals[i].has_value()) {
        context->Fail(AddToTotal(own, &*totals[i]));
      } else {
        totals[i] = own;
      }
    }
    context->Step(absl::StrCat("per-shot, round ", round));
  };
  ParallelFor(static_cast<int>(job.frames.size()), 1, job.num_threads, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) weigh(i);
  });
  return totals;
}

// `matrices` are the minima of what was summed so far, in each frame's own weights.
ShotMatrices Reweighted(ShotMatrices matrices, ShotContext* context) {
  const ShotJob& job = context->job;
  std::vector<BestOfRounds<LightMatrix>> best(matrices.size(),
                                              BestOfRounds<LightMatrix>(kLeastGain));
  ShotMatrices result = matrices;
  for (int round = 0; round <= job.rounds; ++round) {
    const auto totals = WeighAllFrames(matrices, round, context);
    bool gains = false;
    for (size_t i = 0; i < matrices.size(); ++i) {
      if (!matrices[i].ok() || !totals[i].has_value()) continue;
      matrices[i]->figures.energy = totals[i]->footprint_sum.Value();
      gains |= best[i].Offer(matrices[i]->figures.energy, *matrices[i]);
      result[i] = best[i].Best();
      matrices[i] = FitTotal(*totals[i], job.lights[i], job);
    }
    if (!gains) {
      context->Skip((job.rounds - round) * static_cast<int>(job.frames.size()));
      break;
    }
  }
  return result;
}

v1::FitResult ShotToProto(const ShotContext& context, FitReport report) {
  const ShotJob& job = context.job;
  report.source = job.name;
  report.options = job.fit();
  report.options.compute_statistics = false;  // a sum has the RMS alone
  if (job.plans.has_value()) report.plan_options = job.plans->plan;
  report.map = job.map;
  report.clip = job.clip;
  v1::FitResult result = FitResultToProto(report);
  result.mutable_readback()->clear_camera();
  result.mutable_shot()->set_mode(v1::SHOT_MODE_PER_SHOT);
  result.mutable_shot()->set_frame(job.name);
  result.mutable_shot()->set_key(context.keys.shot);
  return result;
}

FitReport ReportOf(const ShotJob& job, const ShotMatrices& matrices) {
  FitReport report;
  for (size_t i = 0; i < matrices.size(); ++i) {
    LightFit fit;
    fit.light = job.lights[i];
    fit.matrix = matrices[i];
    report.lights.push_back(std::move(fit));
  }
  return report;
}

// Energies are the sums of those of the frames that have been judged.
FitReport ReportOf(const ShotContext& context, const ShotAnswers& plans) {
  const ShotJob& job = context.job;
  FitReport report;
  for (size_t i = 0; i < plans.size(); ++i) {
    LightFit fit;
    fit.light = job.lights[i];
    if (plans[i].ok()) {
      Figures figures;
      for (const auto& rows : context.rows[static_cast<size_t>(ShotMode::kPerShot)]) {
        if (i < rows.size() && rows[i].error.empty()) figures.energy += rows[i].energy;
      }
      SetPlan(std::get<TrackedPlan>(*plans[i]).plan, figures, job.plans->plan.guard_texels, &fit);
      if (fit.plan->plan.maps.size() == 1) fit.matrix->figures.energy = figures.energy;
    } else {
      fit.matrix = plans[i].status();
    }
    report.lights.push_back(std::move(fit));
  }
  return report;
}

// As the frames of the shot see them: nothing was searched there.
ShotAnswers AnswersOf(const ShotJob& job, const v1::FitResult& shot) {
  const ShotLookUps look_ups = LookUpsOf(job, shot);
  ShotAnswers answers;
  for (size_t i = 0; i < look_ups.size(); ++i) {
    if (!look_ups[i].has_value()) {
      const v1::Status& status = shot.lights(static_cast<int>(i)).status();
      answers.emplace_back(
          absl::Status(static_cast<absl::StatusCode>(status.code()), status.message()));
      continue;
    }
    ScratchVector<LightMatrix> maps;
    for (const PlanMap& map : look_ups[i]->maps) {
      LightMatrix& matrix = maps.emplace_back();
      matrix.light_name = job.lights[i].name;
      matrix.map = map.size;
      matrix.map_from_world = map.map_from_world;
      matrix.border = look_ups[i]->border;
      matrix.search.stop_reason = StopReason::kNoSearch;
    }
    if (job.plans.has_value()) {
      TrackedPlan tracked;
      tracked.plan.light_name = job.lights[i].name;
      tracked.plan.border = look_ups[i]->border;
      tracked.plan.maps = std::move(maps);
      answers.emplace_back(std::move(tracked));
    } else {
      TrackedMatrix tracked;
      tracked.matrix = std::move(maps[0]);
      answers.emplace_back(std::move(tracked));
    }
  }
  return answers;
}

absl::StatusOr<v1::FitResult> ReadOrFit(const SummarySet& sum, ShotContext* context) {
  const std::string path = context->paths.Shot();
  if (context->HasShot()) return ReadFitResultJson(path);
  ShotMatrices matrices = FitSum(sum, context->job);
  if (IsL1(context->job.fit().metric)) matrices = Reweighted(std::move(matrices), context);
  v1::FitResult result = ShotToProto(*context, ReportOf(context->job, matrices));
  context->Fail(WriteFitResultJson(path, result));
  return result;
}

// What the file has no shadow of has that for its answer.
ShotAnswers ReadableOf(const ShotAnswers& answers, const absl::StatusOr<ReadbackFile>& file) {
  ShotAnswers readable;
  for (size_t light = 0; light < answers.size(); ++light) {
    const absl::Status status = file.ok() ? file->light_status[light] : file.status();
    readable.push_back(status.ok() ? answers[light] : status);
  }
  return readable;
}

// The shot's answers in some consecutive frames.
void JudgeFrames(const ShotAnswers& answers, int begin, int end, ShotContext* context) {
  const ShotJob& job = context->job;
  absl::StatusOr<ReadbackFile> before = absl::UnknownError("not read");
  int last_read = -1;
  for (int i = begin; i < end; ++i) {
    if (context->IsDone(ShotMode::kPerShot, i)) {
      const auto result = context->ReadDone(ShotMode::kPerShot, i);
      context->Fail(result.status());
      if (result.ok()) context->KeepRows(ShotMode::kPerShot, i, *result);
      continue;
    }
    if (i > 0 && last_read != i - 1) before = ReadFrame(job, i - 1);
    absl::StatusOr<ReadbackFile> file = ReadFrame(job, i);
    context->frame_status[i] = file.status();
    const FrameViews views(job, i, file);
    const ShotAnswers readable = ReadableOf(answers, file);
    const FrameBefore frame_before = BeforeFrame(job, i, before, LookUpsOf(answers));
    std::vector<absl::StatusOr<ShotFit>> fits = JudgeFits(job, views, readable, frame_before);
    for (absl::StatusOr<ShotFit>& fit : fits) {
      if (!fit.ok()) continue;
      auto* tracked = std::get_if<TrackedMatrix>(&fit->answer);
      if (tracked != nullptr) tracked->matrix.search.energy_start = fit->figures.energy;
    }
    context->WriteResult(ShotMode::kPerShot,
                         i,
                         ShotResultToProto(job,
                                           ShotMode::kPerShot,
                                           i,
                                           context->keys.Of(ShotMode::kPerShot, i),
                                           file.ok() ? &*file : nullptr,
                                           fits,
                                           {}));
    before = std::move(file);
    last_read = i;
    context->Step(absl::StrCat("per-shot, frame ", job.frames[i].name));
  }
}

}  // namespace

absl::Status FitWholeShot(const SummarySet& sum, ShotContext* context) {
  const ShotJob& job = context->job;
  const bool fits_plans = context->SumsRays();
  ShotAnswers plans;
  if (fits_plans) plans = FitShotPlans(context);
  const absl::StatusOr<v1::FitResult> shot =
      fits_plans ? ShotToProto(*context, ReportOf(*context, plans)) : ReadOrFit(sum, context);
  if (!shot.ok()) return shot.status();
  const ShotAnswers answers = AnswersOf(job, *shot);
  ParallelFor(
      static_cast<int>(job.frames.size()), kFramesAtOnce, job.num_threads, [&](int begin, int end) {
        JudgeFrames(answers, begin, end, context);
      });
  if (fits_plans) {
    context->Fail(WriteFitResultJson(context->paths.Shot(),
                                     ShotToProto(*context, ReportOf(*context, plans))));
  }
  return context->status();
}

int NumWholeShotSteps(const ShotContext& context) {
  const ShotJob& job = context.job;
  int num_steps = 0;
  for (size_t i = 0; i < job.frames.size(); ++i) {
    num_steps += context.IsDone(ShotMode::kPerShot, i) ? 0 : 1;
  }
  if (!context.HasShot() && !job.plans.has_value() && IsL1(job.fit().metric)) {
    num_steps += (job.rounds + 1) * static_cast<int>(job.frames.size());
  }
  return num_steps;
}

}  // namespace lightfit
