#include "cli/summary_inputs.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/text_file.h"
#include "cli/command_line/standard_streams.h"
#include "cli/flags/choices.h"
#include "cli/flags/fit_inputs.h"
#include "jobs/fit_summary.h"

namespace lightfit::cli {

absl::StatusOr<SummarySet> ReadSummary(const std::string& path,
                                       const std::vector<std::string>& only) {
  absl::StatusOr<SummarySet> set = ReadSummaryFile(path);
  if (!set.ok()) return set.status();
  std::vector<Light> lights;
  for (const LightSummary& light : set->lights) lights.push_back(light.total.light);
  if (absl::Status status = ChooseLights(lights, only).status(); !status.ok()) {
    return InFile(path, status);
  }
  const auto is_dropped = [&only](const LightSummary& light) {
    return !only.empty() && std::find(only.begin(), only.end(), light.name()) == only.end();
  };
  set->lights.erase(std::remove_if(set->lights.begin(), set->lights.end(), is_dropped),
                    set->lights.end());
  return set;
}

absl::StatusOr<SummarySet> ReadSummaries(const std::vector<std::string>& paths,
                                         const std::vector<std::string>& only) {
  absl::StatusOr<SummarySet> sum = ReadSummary(paths.front(), only);
  for (size_t i = 1; i < paths.size() && sum.ok(); ++i) {
    const absl::StatusOr<SummarySet> set = ReadSummary(paths[i], only);
    if (!set.ok()) return set.status();
    if (absl::Status status = AddToSet(*set, &*sum); !status.ok()) return InFile(paths[i], status);
  }
  return sum;
}

absl::Status CheckHeld(const FitFlags& flags, const FitOptions& held) {
  const auto refuse = [&held](const char* flag, const std::string& given) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s %s: the summaries hold sums for --metric %s, --cover %s and --border "
                        "%s; leave it out, or summarise the frames again with it",
                        flag,
                        given,
                        WordFor(MetricWords(), held.metric),
                        WordFor(CoverWords(), held.cover),
                        WordFor(BorderWords(), held.border)));
  };
  const FitOptions& options = flags.options;
  if (flags.has_metric && options.metric != held.metric) {
    return refuse("--metric", WordFor(MetricWords(), options.metric));
  }
  if (flags.has_cover && options.cover != held.cover) {
    return refuse("--cover", WordFor(CoverWords(), options.cover));
  }
  if (flags.has_border && options.border != held.border) {
    return refuse("--border", WordFor(BorderWords(), options.border));
  }
  return absl::OkStatus();
}

absl::StatusOr<FitOptions> OptionsFor(const FitFlags& flags, const FitOptions& held) {
  if (absl::Status status = CheckHeld(flags, held); !status.ok()) return status;
  return OptionsForSummaries(flags.options, held);
}

std::string SourceText(std::vector<std::string> paths) {
  std::sort(paths.begin(), paths.end());
  return WithStreamNames(absl::StrJoin(paths, ", "));
}

std::string TitleText(const std::vector<std::string>& paths) {
  return paths.size() == 1 ? WithStreamNames(paths.front())
                           : absl::StrCat(paths.size(), " summaries");
}

}  // namespace lightfit::cli
