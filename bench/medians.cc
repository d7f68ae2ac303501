#include "bench/medians.h"

#include <unistd.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace lightfit {

namespace {

std::string ProcessorName() {
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);) {
    const size_t colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos) {
      return line.substr(colon + 2);
    }
  }
  return "unknown";
}

}  // namespace

MedianReporter::MedianReporter()
    : ConsoleReporter(isatty(STDOUT_FILENO) != 0 ? OO_Defaults : OO_None) {}

void MedianReporter::ReportRuns(const std::vector<Run>& runs) {
  std::vector<Run> shown;
  for (const Run& run : runs) {
    const bool is_mean = run.aggregate_name == "mean" || run.aggregate_name == "stddev";
    if (run.run_type != Run::RT_Aggregate || !is_mean) shown.push_back(run);
    const bool single = run.run_type == Run::RT_Iteration && run.repetitions <= 1;
    const bool median = run.run_type == Run::RT_Aggregate && run.aggregate_name == "median";
    if (run.error_occurred || !(single || median)) continue;
    median_ms_[run.run_name.function_name] =
        run.GetAdjustedRealTime() / benchmark::GetTimeUnitMultiplier(run.time_unit) * 1e3;
  }
  ConsoleReporter::ReportRuns(shown);
}

double MedianReporter::Milliseconds(const std::string& name) const {
  const auto found = median_ms_.find(name);
  return found == median_ms_.end() ? std::numeric_limits<double>::quiet_NaN() : found->second;
}

std::string MedianReporter::Ratio(const std::string& numerator,
                                  const std::string& denominator) const {
  const double ratio = Milliseconds(numerator) / Milliseconds(denominator);
  if (!std::isfinite(ratio)) return "-";
  return ratio < 100.0 ? absl::StrFormat("%.2f x", ratio) : absl::StrFormat("%.0f x", ratio);
}

void AddRunContext() {
  benchmark::AddCustomContext("processor", ProcessorName());
  benchmark::AddCustomContext("compiler", absl::StrCat("gcc-compatible ", __VERSION__));
  benchmark::AddCustomContext("build_type", LIGHTFIT_BUILD_TYPE);
  benchmark::AddCustomContext("git_commit", LIGHTFIT_GIT_COMMIT);
}

std::vector<char*> WithDefaultFlags(int argc, char** argv, std::vector<std::string>* defaults) {
  std::vector<char*> flags = {argv[0]};
  for (std::string& flag : *defaults) flags.push_back(flag.data());
  flags.insert(flags.end(), argv + 1, argv + argc);
  return flags;
}

}  // namespace lightfit
