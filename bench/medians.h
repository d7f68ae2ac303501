// bench/medians.h
//
// Medians of a benchmark run by name, for the tables of ratios that follow it, and what the run was
// made with.
#pragma once

#include <benchmark/benchmark.h>

#include <map>
#include <string>
#include <vector>

namespace lightfit {

// Prints the median and the spread (cv, standard deviation over mean) of every benchmark's
// repetitions, and remembers the medians of real time.
class MedianReporter : public benchmark::ConsoleReporter {
 public:
  MedianReporter();
  void ReportRuns(const std::vector<Run>& runs) override;

  // Milliseconds; NaN if the benchmark did not run.
  double Milliseconds(const std::string& name) const;

  // Milliseconds(numerator) / Milliseconds(denominator) as "12.3 x", or "-".
  std::string Ratio(const std::string& numerator, const std::string& denominator) const;

 private:
  std::map<std::string, double> median_ms_;
};

// Adds processor, compiler, build type and git commit to the context that reporters print.
void AddRunContext();

// argv with `defaults` before the user's own flags, which therefore win.
std::vector<char*> WithDefaultFlags(int argc, char** argv, std::vector<std::string>* defaults);

}  // namespace lightfit
