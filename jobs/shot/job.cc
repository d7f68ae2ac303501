#include "jobs/shot/job.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "jobs/fit_comparison.h"
#include "optimizer/tracking/keep_matrix.h"

namespace lightfit {

const char* ShotModeName(ShotMode mode) {
  switch (mode) {
    case ShotMode::kPerFrame:
      return "per-frame";
    case ShotMode::kTracked:
      return "tracked";
    case ShotMode::kPerShot:
      return "per-shot";
  }
  return "?";
}

void ShotJob::FindMotion() {
  motion.assign(lights.size(), absl::OkStatus());
  for (size_t light = 0; light < lights.size(); ++light) {
    size_t first = frames.size();  // in which it is
    for (size_t i = 0; i < frames.size(); ++i) {
      const std::vector<std::string>& absent = frames[i].absent_lights;
      if (std::find(absent.begin(), absent.end(), lights[light].name) != absent.end()) continue;
      if (first == frames.size()) first = i;
      if (IsSameLight(LightsIn(i)[light], LightsIn(first)[light])) continue;
      motion[light] = absl::FailedPreconditionError(
          absl::StrFormat("light \"%s\": it moves (between frames %s and %s), and one map for the "
                          "whole shot cannot "
                          "serve it; take its maps of each frame, per-frame or tracked",
                          lights[light].name,
                          frames[first].number.Text(),
                          frames[i].number.Text()));
      break;
    }
  }
}

std::string MapsText(const ShotJob& job) {
  if (!job.plans.has_value()) {
    return absl::StrFormat("map %d x %d texels", job.map.width, job.map.height);
  }
  return PlanSizeText(job.plans->plan);
}

std::string ShotPaths::Result(ShotMode mode, const ShotFrame& frame) const {
  return absl::StrCat(folder, "/", ShotModeName(mode), "/", frame.name, ".json");
}

std::string ShotPaths::Summary(const ShotFrame& frame) const {
  return absl::StrCat(folder, "/summaries/", frame.name, ".summary");
}

std::string ShotPaths::SummaryKey(const ShotFrame& frame) const {
  return absl::StrCat(folder, "/summaries/", frame.name, ".key");
}

std::string ShotPaths::Shot() const { return folder + "/per-shot.json"; }
std::string ShotPaths::Csv() const { return folder + "/shot.csv"; }
std::string ShotPaths::Plot() const { return folder + "/shot.png"; }

}  // namespace lightfit
