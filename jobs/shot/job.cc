#include "jobs/shot/job.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "jobs/fit_comparison.h"

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
