// bench/quality.cc : how good the matrices are, against brute force and the published methods.
//
// In:   random lights over random boxes, and the read-backs of a renderer where there are any.
// Out:  a table of the distribution of energy ratios on stdout; with --csv one row per light and
//       method, columns
//         input            "boxes/<seed>" or "<set>/<frame>"
//         light            its name
//         map              "<width>x<height>", texels
//         samples          boundary samples used
//         method           default, line_search_refined, line_search, as_published, focused, start
//                          (where the default search began), brute_force
//         energy           of the returned matrix, summed sample by sample, (pixels per texel)^2
//         energy_reported  what the fit said its energy is
//         ratio            energy over that of brute_force
//         outside_texels   how far the receiver furthest outside lies from the map; 0 is none
//         evaluations      matrices evaluated by the search
//
// All methods minimise the same: squared footprints over the published method's samples, with all
// receivers in the map. "default" is the default search on that, not the default metric and cover.
//
// With --check the exit status is 1 when the default is more than 0.5 % above brute force, above
// any other method, leaves a receiver outside the map, or reports a wrong energy, on any light.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_format.h"
#include "bench/inputs.h"
#include "bench/quality_case.h"

namespace lightfit {
namespace {

constexpr double kAllowedAboveBruteForce = 1.005;
constexpr double kRounding = 1e-6;        // relative, between two ways to sum the same energy
constexpr double kAllowedOutside = 1e-3;  // texels
constexpr MapSize kMaps[] = {{1024, 1024}, {2048, 1024}, {1024, 1024}, {512, 1536}};
constexpr int kBoxReadbackSize = 180;  // pixels, square
constexpr int kAttemptsPerCase = 100;

struct Arguments {
  int num_lights = 500;
  uint64_t seed = 1;
  int num_threads = 2;
  int frame_step = 4;
  std::string readback_folder = DefaultReadbackFolder();
  std::string csv_path;
  bool check = false;
};

using CaseFunction = std::function<absl::StatusOr<QualityCase>()>;

// A light over boxes; some have no shadow in view, then the next seed is tried.
absl::StatusOr<QualityCase> MeasureBoxes(uint64_t seed, int index) {
  absl::StatusOr<QualityCase> result = absl::FailedPreconditionError("no attempt");
  for (int attempt = 0; attempt < kAttemptsPerCase && absl::IsFailedPrecondition(result.status());
       ++attempt) {
    const uint64_t input_seed = (seed * 1000000 + index) * kAttemptsPerCase + attempt;
    // Three lights, one of each kind, of which this case takes one.
    const Input input = BoxInput(input_seed, kBoxReadbackSize, kBoxReadbackSize, 3);
    result = MeasureQuality(
        input.name, input.View(), input.lights[index % 3], kMaps[index % 4], BruteForceOptions());
  }
  return result;
}

// Runs all cases on several threads. Those that no single map can serve are left out and counted;
// any other failure is returned.
absl::StatusOr<std::vector<QualityCase>> RunCases(const std::vector<CaseFunction>& cases,
                                                  int num_threads,
                                                  int* num_infeasible) {
  std::vector<absl::StatusOr<QualityCase>> results(cases.size());
  std::atomic<size_t> next = 0, num_done = 0;
  const bool show_progress = isatty(STDERR_FILENO) != 0;
  const auto work = [&] {
    for (size_t i = next++; i < cases.size(); i = next++) {
      results[i] = cases[i]();
      const size_t done = ++num_done;
      if (show_progress) absl::FPrintF(stderr, "\r%d/%d lights ", done, cases.size());
    }
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < num_threads; ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  if (show_progress) absl::FPrintF(stderr, "\r%20s\r", "");

  std::vector<QualityCase> measured;
  *num_infeasible = 0;
  for (absl::StatusOr<QualityCase>& result : results) {
    if (result.ok()) {
      measured.push_back(*std::move(result));
    } else if (absl::IsFailedPrecondition(result.status())) {
      ++*num_infeasible;
    } else {
      return result.status();
    }
  }
  return measured;
}

void PrintDistribution(const std::string& title, std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto at = [&values](double share) {
    return values[static_cast<size_t>(std::lround(share * (values.size() - 1)))];
  };
  absl::PrintF("  %-36s %10.5f %10.5f %10.5f %10.5f %10.5f\n",
               title,
               at(0.0),
               at(0.5),
               at(0.9),
               at(0.99),
               at(1.0));
}

void PrintTable(const std::string& title, const std::vector<QualityCase>& cases) {
  absl::PrintF("%s: %d lights\n", title, cases.size());
  if (cases.empty()) return;
  absl::PrintF("  %-36s %10s %10s %10s %10s %10s\n",
               "ratio of energies",
               "min",
               "median",
               "90 %",
               "99 %",
               "max");
  const char* const ratios[][2] = {{"default", "brute_force"},
                                   {"default", "as_published"},
                                   {"default", "focused"},
                                   {"default", "start"},
                                   {"line_search", "brute_force"},
                                   {"line_search_refined", "brute_force"},
                                   {"as_published", "brute_force"},
                                   {"focused", "brute_force"}};
  for (const auto& [numerator, denominator] : ratios) {
    std::vector<double> values;
    values.reserve(cases.size());
    for (const QualityCase& c : cases) {
      values.push_back(c.EnergyOf(numerator) / c.EnergyOf(denominator));
    }
    PrintDistribution(absl::StrFormat("%s / %s", numerator, denominator), values);
  }
  std::vector<double> outside, reported;
  for (const QualityCase& c : cases) {
    for (const MethodResult& r : c.results) {
      outside.push_back(r.outside_texels);
      reported.push_back(r.energy_reported / r.energy);
    }
  }
  PrintDistribution("energy reported / sample by sample", reported);
  PrintDistribution("receivers outside, texels", outside);
}

bool WriteCsv(const std::string& path, const std::vector<QualityCase>& cases) {
  std::ofstream csv(path);
  csv << "input,light,map,samples,method,energy,energy_reported,ratio,outside_texels,evaluations\n";
  for (const QualityCase& c : cases) {
    for (const MethodResult& r : c.results) {
      csv << absl::StrFormat("%s,%s,%dx%d,%d,%s,%.9g,%.9g,%.6f,%.3g,%d\n",
                             c.input,
                             c.light,
                             c.map.width,
                             c.map.height,
                             c.num_samples,
                             r.method,
                             r.energy,
                             r.energy_reported,
                             r.energy / c.EnergyOf("brute_force"),
                             r.outside_texels,
                             r.evaluations);
    }
  }
  return csv.flush().good();
}

// Prints what --check objects to; returns how many objections there are.
int PrintObjections(const std::vector<QualityCase>& cases) {
  int num_objections = 0;
  for (const QualityCase& c : cases) {
    const auto object = [&](const std::string& what) {
      ++num_objections;
      absl::PrintF("objection: %s, light \"%s\", map %dx%d, %d samples: %s\n",
                   c.input,
                   c.light,
                   c.map.width,
                   c.map.height,
                   c.num_samples,
                   what);
    };
    const double energy = c.EnergyOf("default");
    const double ratio = energy / c.EnergyOf("brute_force");
    // Written so that NaN objects.
    if (!(ratio <= kAllowedAboveBruteForce)) {
      object(absl::StrFormat("default / brute force = %.5f", ratio));
    }
    for (const char* method : {"as_published", "focused", "start"}) {
      if (!(energy <= c.EnergyOf(method) * (1.0 + kRounding))) {
        object(absl::StrFormat("default / %s = %.7f", method, energy / c.EnergyOf(method)));
      }
    }
    for (const MethodResult& r : c.results) {
      if (!(r.outside_texels <= kAllowedOutside)) {
        object(absl::StrFormat(
            "%s leaves receivers up to %g texels outside the map", r.method, r.outside_texels));
      }
      if (!(std::abs(r.energy_reported - r.energy) <= kRounding * r.energy)) {
        object(absl::StrFormat("%s reports energy %.9g, sample by sample it is %.9g",
                               r.method,
                               r.energy_reported,
                               r.energy));
      }
    }
  }
  return num_objections;
}

absl::Status Run(const Arguments& arguments, bool* passed) {
  std::vector<CaseFunction> box_cases;
  box_cases.reserve(arguments.num_lights);
  for (int i = 0; i < arguments.num_lights; ++i) {
    box_cases.push_back([&arguments, i] { return MeasureBoxes(arguments.seed, i); });
  }
  int num_infeasible = 0;
  absl::StatusOr<std::vector<QualityCase>> boxes =
      RunCases(box_cases, arguments.num_threads, &num_infeasible);
  if (!boxes.ok()) return boxes.status();
  std::vector<QualityCase> all = *std::move(boxes);
  PrintTable(absl::StrFormat("boxes, seed %d", arguments.seed), all);
  if (num_infeasible > 0) absl::PrintF("  %d cases without a usable light\n", num_infeasible);

  if (!HasReadbacks(arguments.readback_folder)) {
    absl::PrintF("no read-backs in %s: skipped\n", arguments.readback_folder);
  } else {
    absl::StatusOr<std::vector<Input>> inputs =
        ReadInputs(arguments.readback_folder, arguments.frame_step);
    if (!inputs.ok()) return inputs.status();
    std::vector<CaseFunction> cases;
    for (const Input& input : *inputs) {
      for (const Light& light : input.lights) {
        cases.push_back([&input, &light] {
          return MeasureQuality(input.name, input.View(), light, kMaps[0], BruteForceOptions());
        });
      }
    }
    const absl::StatusOr<std::vector<QualityCase>> measured =
        RunCases(cases, arguments.num_threads, &num_infeasible);
    if (!measured.ok()) return measured.status();
    PrintTable(arguments.readback_folder, *measured);
    absl::PrintF("  %d lights cannot be fitted with a single map\n", num_infeasible);
    all.insert(all.end(), measured->begin(), measured->end());
  }
  if (!arguments.csv_path.empty() && !WriteCsv(arguments.csv_path, all)) {
    return absl::UnavailableError("cannot write " + arguments.csv_path);
  }
  *passed = !arguments.check || (!all.empty() && PrintObjections(all) == 0);
  return absl::OkStatus();
}

}  // namespace
}  // namespace lightfit

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): options are ours
  lightfit::Arguments arguments;
  CLI::App app("Energy of the fitted matrices against brute force and the published methods");
  app.add_option("--lights", arguments.num_lights, "Random lights over boxes")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--seed", arguments.seed, "Seed of the boxes, lights and cameras")
      ->capture_default_str();
  app.add_option("--threads", arguments.num_threads, "Lights measured at a time")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--readbacks", arguments.readback_folder, "Folder of sets of read-backs")
      ->capture_default_str();
  app.add_option("--frame-step", arguments.frame_step, "Take every so many frames of a set")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--csv", arguments.csv_path, "Write one row per light and method to this file");
  app.add_flag("--check", arguments.check, "Fail unless the default is within 0.5 % of the best");
  CLI11_PARSE(app, argc, argv);

  bool passed = false;
  const absl::Status status = lightfit::Run(arguments, &passed);
  if (!status.ok()) {
    std::fprintf(stderr, "bench_quality: %s\n", std::string(status.message()).c_str());
    return 2;
  }
  return passed ? 0 : 1;
}
