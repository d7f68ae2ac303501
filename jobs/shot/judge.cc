#include "jobs/shot/judge.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_format.h"
#include "base/text_file.h"
#include "optimizer/evaluate.h"
#include "optimizer/fit.h"
#include "optimizer/tracking/keep_matrix.h"
#include "partition/evaluate_plan.h"
#include "partition/tracking/plan_crawl.h"
#include "wire/plan_proto.h"

namespace lightfit {
namespace {

// The view says which border it is for.
FitOptions AnyBorder(FitOptions options) {
  options.border = BorderChoice::kAutomatic;
  return options;
}

absl::StatusOr<Crawl> CrawlBetween(const ShotJob& job,
                                   const LightView& view,
                                   const ReadbackFile& file_before,
                                   const Plan& before,
                                   const Plan& now) {
  if (job.plans.has_value()) {
    return MeasurePlanCrawl({file_before.View(), before},
                            {view.surfaces->readback, now, view.surfaces},
                            *view.light,
                            job.plans->plan.guard_texels,
                            job.fit().samples);
  }
  return MeasureCrawl(
      {file_before.View(), before.maps[0].map_from_world, job.map},
      {view.surfaces->readback, now.maps[0].map_from_world, now.maps[0].size, view.surfaces},
      *view.light,
      job.fit().samples);
}

// The maps of `plan` get their own figures, of this frame's samples.
absl::StatusOr<Figures> JudgePlanHere(const LightView& view,
                                      const Plan& look_up,
                                      const FitOptions& options,
                                      double guard_texels,
                                      LightPlan* plan) {
  ScratchVector<Figures> of_maps;
  absl::StatusOr<Figures> figures = MeasurePlan(view, look_up, options, guard_texels, &of_maps);
  if (!figures.ok()) return figures.status();
  const absl::StatusOr<double> wrong_share =
      ForetellPlan(view.surfaces->readback, *view.light, look_up, options.samples);
  if (!wrong_share.ok()) return wrong_share.status();
  figures->wrong_share = *wrong_share;
  for (size_t k = 0; k < of_maps.size(); ++k) plan->maps[k].figures = of_maps[k];
  plan->energy = figures->energy;
  return figures;
}

absl::StatusOr<ShotFit> JudgeFit(const ShotJob& job,
                                 const LightView& view,
                                 const ShotAnswer& answer,
                                 const ReadbackFile* file_before,
                                 const std::optional<Plan>& before) {
  ShotFit fit;
  fit.answer = answer;
  const Plan now = LookUpOf(answer);
  std::optional<LightView> other;  // where the border was chosen otherwise
  if (now.border != view.border) {
    absl::StatusOr<LightView> made = ViewLight(*view.surfaces, *view.light, now.border, job.fit());
    if (!made.ok()) return made.status();
    other = *std::move(made);
  }
  const LightView& judged = other.has_value() ? *other : view;
  const FitOptions options = AnyBorder(job.fit());
  if (auto* tracked = std::get_if<TrackedPlan>(&fit.answer)) {
    absl::StatusOr<Figures> figures =
        JudgePlanHere(judged, now, options, job.plans->plan.guard_texels, &tracked->plan);
    if (!figures.ok()) return figures.status();
    fit.figures = *std::move(figures);
  } else {
    absl::StatusOr<Figures> figures =
        EvaluateMatrix(judged, now.maps[0].map_from_world, now.maps[0].size, options, now.border);
    if (!figures.ok()) return figures.status();
    fit.figures = *std::move(figures);
  }
  if (file_before == nullptr || !before.has_value()) return fit;
  const absl::StatusOr<Crawl> crawl = CrawlBetween(job, view, *file_before, *before, now);
  if (!crawl.ok()) return crawl.status();
  fit.crawl = *crawl;
  return fit;
}

}  // namespace

absl::Status AbsentError(const std::string& light_name, FrameNumber number) {
  return absl::NotFoundError(absl::StrFormat(
      "light \"%s\": nothing says where it is in frame %s", light_name, number.Text()));
}

void SetAbsent(const std::vector<std::string>& absent,
               FrameNumber number,
               const std::vector<Light>& lights,
               ReadbackFile* file) {
  for (size_t i = 0; i < lights.size(); ++i) {
    if (std::find(absent.begin(), absent.end(), lights[i].name) == absent.end()) continue;
    file->light_status[i] = AbsentError(lights[i].name, number);
  }
}

absl::StatusOr<ReadbackFile> ReadFrame(const ShotJob& job, size_t index) {
  const ShotFrame& frame = job.frames[index];
  if (!frame.exr.ok()) return frame.exr.status();
  const std::vector<Light>& lights = job.LightsIn(index);
  absl::StatusOr<ReadbackFile> file = ReadReadbackExr(frame.path, lights, *frame.exr);
  if (!file.ok()) return file.status();
  const absl::Status status = InFile(frame.path, ValidateReadback(file->View()));
  if (!status.ok()) return status;
  SetAbsent(frame.absent_lights, frame.number, lights, &*file);
  return file;
}

FrameViews::FrameViews(const ShotJob& job, size_t frame, const absl::StatusOr<ReadbackFile>& file)
    : lights_(job.LightsIn(frame)),
      surfaces_(file.ok() ? FindSurfaces(file->View(), LightMask(lights_), job.fit().samples)
                          : absl::StatusOr<Surfaces>(file.status())) {
  for (size_t i = 0; i < lights_.size(); ++i) {
    const absl::Status status =
        file.ok() && !file->light_status[i].ok() ? file->light_status[i] : surfaces_.status();
    if (status.ok()) {
      views_.push_back(ViewLight(*surfaces_, lights_[i], job.fit()));
    } else {
      views_.emplace_back(status);
    }
  }
}

ShotLookUps LookUpsOf(const ShotJob& job, const v1::FitResult& result) {
  ShotLookUps look_ups(job.lights.size());
  for (size_t i = 0; i < look_ups.size() && static_cast<int>(i) < result.lights_size(); ++i) {
    const v1::LightResult& light = result.lights(static_cast<int>(i));
    if (light.has_plan()) {
      absl::StatusOr<Plan> plan = PlanFromProto(light.plan(), "plan");
      if (!plan.ok()) continue;
      plan->light_name = job.lights[i].name;
      look_ups[i] = *std::move(plan);
      continue;
    }
    if (!light.has_map_from_world()) continue;
    const absl::StatusOr<Eigen::Matrix4d> map =
        MatrixFromProto(light.map_from_world(), "mapFromWorld");
    const absl::StatusOr<Border> border = BorderFromProto(light.border(), "border");
    if (!map.ok() || !border.ok()) continue;
    look_ups[i] = PlanOfOneMap(job.lights[i].name, *map, job.map, *border);
  }
  return look_ups;
}

FrameBefore BeforeFrame(const ShotJob& job,
                        size_t frame,
                        const absl::StatusOr<ReadbackFile>& file_before,
                        ShotLookUps look_ups) {
  if (frame == 0 || job.frames[frame].is_after_gap || !file_before.ok()) return {};
  const std::vector<Light>&before = job.LightsIn(frame - 1), &now = job.LightsIn(frame);
  for (size_t i = 0; i < look_ups.size(); ++i) {
    if (!IsSameLight(before[i], now[i])) look_ups[i].reset();
  }
  return {&*file_before, std::move(look_ups)};
}

std::vector<absl::StatusOr<ShotFit>> JudgeFits(const ShotJob& job,
                                               const FrameViews& views,
                                               const ShotAnswers& answers,
                                               const FrameBefore& before) {
  std::vector<absl::StatusOr<ShotFit>> fits;
  for (size_t i = 0; i < answers.size(); ++i) {
    if (!answers[i].ok()) {
      fits.emplace_back(answers[i].status());
      continue;
    }
    if (!views[i].ok()) {
      fits.emplace_back(views[i].status());
      continue;
    }
    const bool has_before = before.file != nullptr && before.file->light_status[i].ok();
    fits.push_back(JudgeFit(job,
                            *views[i],
                            *answers[i],
                            has_before ? before.file : nullptr,
                            has_before ? before.look_ups[i] : std::nullopt));
  }
  return fits;
}

}  // namespace lightfit
