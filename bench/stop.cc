// bench/stop.cc : how soon work ends that is asked to stop.
//
// In:   boxes on a floor at three sizes, --lights lights; from a second thread a StopScope
//       is asked to stop at a random moment of every call. Wants a processor for each of the two
//       threads.
// Out:  milliseconds from the request to the return of the call: median, 99 % and largest, and when
//       in the call the largest was asked for; how much of it the thread was computing, as it would
//       on an idle processor; beside the duration of the whole call. A call that answers with
//       anything but CancelledError after it was asked, unless it was done, ends the program.
#include "base/stop.h"

#include <pthread.h>
#include <time.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/table.h"
#include "bench/inputs.h"
#include "optimizer/evaluate.h"
#include "optimizer/fit.h"
#include "optimizer/sizing/allocation.h"
#include "optimizer/sizing/map_shapes.h"
#include "optimizer/sizing/tolerance.h"
#include "optimizer/tracking/tracker.h"
#include "tests/optimizer/tracking/hanging_lamp.h"

namespace lightfit {
namespace {

using Clock = std::chrono::steady_clock;
using Milliseconds = std::chrono::duration<double, std::milli>;

constexpr MapSize kMap = {1024, 1024};

struct Arguments {
  int num_stops = 200;
  double seconds = 20.0;
  uint64_t seed = 7;
  int num_lights = 8;
  std::string only;
};

// The call under test: returns the first status that is not OK.
using Call = std::function<absl::Status()>;

struct Stop {
  double asked_ms = 0.0;   // after the call began
  double return_ms = 0.0;  // after it was asked for
  double busy_ms = 0.0;    // of those, the calling thread's
};

double ThreadMilliseconds(clockid_t clock) {
  timespec time = {};
  clock_gettime(clock, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

// One call, asked to stop after `delay`. Nothing when it was done before.
std::vector<Stop> StopOnce(const Call& call, Clock::duration delay) {
  std::stop_source source;
  clockid_t caller = {};
  pthread_getcpuclockid(pthread_self(), &caller);
  double busy_when_asked_ms = 0.0;
  const Clock::time_point begin = Clock::now();
  Clock::time_point asked;
  std::thread stopper([&] {
    std::this_thread::sleep_until(begin + delay);
    busy_when_asked_ms = ThreadMilliseconds(caller);
    asked = Clock::now();
    source.request_stop();
  });
  const StopScope stop_scope(source.get_token());
  const absl::Status status = call();
  const Clock::time_point end = Clock::now();
  const double busy_ms = ThreadMilliseconds(caller);
  stopper.join();
  if (status.ok() || end < asked) return {};
  if (!absl::IsCancelled(status)) {
    absl::FPrintF(stderr, "want a cancelled call, not %s\n", status.ToString());
    std::quick_exit(1);
  }
  return {{Milliseconds(asked - begin).count(),
           Milliseconds(end - asked).count(),
           busy_ms - busy_when_asked_ms}};
}

class StopTable {
 public:
  explicit StopTable(const Arguments& arguments) : arguments_(arguments), random_(arguments.seed) {
    table_.AddColumn("", "call");
    table_.AddColumn("", "whole call, ms");
    table_.AddColumn("", "stops");
    table_.AddColumn("from request to return, ms", "median");
    table_.AddColumn("from request to return, ms", "99 %");
    table_.AddColumn("from request to return, ms", "largest");
    table_.AddColumn("", "which was asked at");
    table_.AddColumn("computing, ms", "99 %");
    table_.AddColumn("computing, ms", "largest");
  }

  void Measure(const std::string& name, const Call& call) {
    if (name.find(arguments_.only) == std::string::npos) return;
    const Clock::time_point first_begin = Clock::now();
    const absl::Status status = call();
    if (!status.ok()) {
      absl::FPrintF(stderr, "%s: %s\n", name, status.ToString());
      std::quick_exit(1);
    }
    const Clock::duration whole = Clock::now() - first_begin;
    std::vector<Stop> stops;
    std::uniform_real_distribution<double> share(0.0, 1.0);
    for (int i = 0; i < arguments_.num_stops; ++i) {
      if (Clock::now() - first_begin > std::chrono::duration<double>(arguments_.seconds)) break;
      const auto delay = std::chrono::duration_cast<Clock::duration>(share(random_) * whole);
      for (const Stop& stop : StopOnce(call, delay)) stops.push_back(stop);
    }
    std::sort(stops.begin(), stops.end(), [](const Stop& a, const Stop& b) {
      return a.return_ms < b.return_ms;
    });
    if (stops.empty()) return;
    const double whole_ms = Milliseconds(whole).count();
    std::vector<double> busy_ms;
    busy_ms.reserve(stops.size());
    for (const Stop& stop : stops) busy_ms.push_back(stop.busy_ms);
    std::sort(busy_ms.begin(), busy_ms.end());
    const auto rank = [&stops](double q) { return static_cast<size_t>(q * (stops.size() - 1)); };
    const auto quantile = [&](double q) {
      return absl::StrFormat("%.3f", stops[rank(q)].return_ms);
    };
    table_.AddRow({name,
                   absl::StrFormat("%.1f", whole_ms),
                   absl::StrCat(stops.size()),
                   quantile(0.5),
                   quantile(0.99),
                   quantile(1.0),
                   absl::StrFormat("%.0f %%", 100.0 * stops.back().asked_ms / whole_ms),
                   absl::StrFormat("%.3f", busy_ms[rank(0.99)]),
                   absl::StrFormat("%.3f", busy_ms.back())});
  }

  std::string Text() const { return table_.Text(); }

 private:
  const Arguments& arguments_;
  std::mt19937_64 random_;
  Table table_;
};

template <typename Results>
absl::Status FirstError(const Results& results) {
  for (const auto& result : results) {
    if (!result.ok()) return result.status();
  }
  return absl::OkStatus();
}

// Of one size of read-back.
void MeasureSize(const Arguments& arguments, MapSize size, StopTable* table) {
  Input input = BoxInput(arguments.seed, size.width, size.height, arguments.num_lights);
  const LightMatrices fits = FitLights(input.View(), input.lights, kMap);
  std::vector<Light> fitted;
  for (size_t i = 0; i < fits.size(); ++i) {
    if (fits[i].ok()) fitted.push_back(input.lights[i]);
  }
  if (fitted.empty()) return;
  input.lights = fitted;
  const Light& light = fitted.front();
  const Eigen::Matrix4d map_from_world = FitLight(input.View(), light, kMap)->map_from_world;
  const std::string suffix = absl::StrCat(", ", size.width, "x", size.height);
  const auto measure = [&](const std::string& name, const FitOptions& options, const auto& call) {
    table->Measure(name + suffix, [&]() { return call(options); });
  };
  const auto fit_light = [&](const FitOptions& options) {
    return FitLight(input.View(), light, kMap, options).status();
  };
  FitOptions with_ceres;
  with_ceres.refiner = Refiner::kCeres;
  measure("FitLight", {}, fit_light);
  measure("FitLight, Ceres", with_ceres, fit_light);
  measure("FitLight, as published", FitOptions::AsPublished(), fit_light);
  measure("FitLights", {}, [&](const FitOptions& options) {
    return FirstError(FitLights(input.View(), input.lights, kMap, options));
  });
  measure("Summarize", {}, [&](const FitOptions& options) {
    return Summarize(input.View(), light, options).status();
  });
  measure("SummarizeInMap", {}, [&](const FitOptions& options) {
    return SummarizeInMap(input.View(), light, map_from_world, options).status();
  });
  measure("SummarizeForAnyAspect", {}, [&](const FitOptions& options) {
    return SummarizeForAnyAspect(input.View(), light, options).status();
  });
  measure("EvaluateMatrix", {}, [&](const FitOptions& options) {
    return EvaluateMatrix(input.View(), light, map_from_world, kMap, options).status();
  });
  measure("MeetTolerance, 99 %", {}, [&](const FitOptions& options) {
    const Tolerance tolerance = {Tolerance::Kind::kP99, 1.0, 1.0};
    return MeetTolerance(input.View(), light, tolerance, MapSizeRules(), options).status();
  });
  Tracker tracker{TrackerOptions()};
  measure("Tracker::Update", {}, [&](const FitOptions& options) {
    TrackerOptions tracker_options = TrackerOptions::ForStability(0.0);
    tracker_options.fit = options;
    tracker.set_options(tracker_options);
    return FirstError(tracker.Update(input.View(), input.lights, kMap));
  });
}

// Boxes of pixels reach around the lamp, so that its cover takes every receiver one by one.
void MeasureHangingLamp(MapSize size, StopTable* table) {
  const testing::HangingLamp lamp(size.width, size.height);
  table->Measure(absl::StrCat("FitLight, focused, close lamp, ", size.width, "x", size.height),
                 [&]() {
                   FitOptions options;
                   options.search = Search::kFocused;
                   return FitLight(lamp.readback.View(), lamp.light, kMap, options).status();
                 });
}

// From summaries, whose work does not depend on the size of the read-back.
void MeasureSummaries(const Arguments& arguments, StopTable* table) {
  const Input input = BoxInput(arguments.seed, 180, 180, kMaxLights);
  std::vector<AllocationLight> lights;
  for (const Light& light : input.lights) {
    AllocationLight summed = {light, SummarizeForAnyAspect(input.View(), light, {}), 1.0};
    if (summed.summary.ok()) lights.push_back(std::move(summed));
  }
  const auto fits = [](const AllocationLight& light) {
    return Fit(*light.summary, light.light, kMap).ok();
  };
  lights.erase(
      std::remove_if(lights.begin(), lights.end(), [&](const auto& l) { return !fits(l); }),
      lights.end());
  if (lights.empty()) return;
  table->Measure("Fit, to the end", [&]() {
    FitOptions options;
    return Fit(*lights.front().summary, lights.front().light, kMap, options).status();
  });
  for (const int multiple : {64, 1}) {
    table->Measure(
        absl::StrFormat("AllocateBudget, %d lights, multiples of %d", lights.size(), multiple),
        [&]() {
          FitOptions options;
          MapSizeRules rules;
          rules.multiple = multiple;
          return AllocateBudget(lights, int64_t{8192} * 8192, rules, options).status();
        });
  }
}

void Run(const Arguments& arguments) {
  StopTable table(arguments);
  MeasureSummaries(arguments, &table);
  for (const MapSize size : {MapSize{180, 180}, MapSize{1920, 1080}, MapSize{3840, 2160}}) {
    MeasureSize(arguments, size, &table);
    MeasureHangingLamp(size, &table);
  }
  std::printf("%d lights, seed %d\n\n%s",
              arguments.num_lights,
              static_cast<int>(arguments.seed),
              table.Text().c_str());
}

}  // namespace
}  // namespace lightfit

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): options are ours
  lightfit::Arguments arguments;
  CLI::App app("How soon work ends that is asked to stop.");
  app.add_option("--stops", arguments.num_stops, "Per row of the table")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seconds", arguments.seconds, "At most, per row")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seed", arguments.seed, "Of boxes, camera, lights and moments")
      ->capture_default_str();
  app.add_option("--lights", arguments.num_lights, "Of FitLights and Tracker::Update")
      ->check(CLI::Range(1, 32))
      ->capture_default_str();
  app.add_option("--only", arguments.only, "Rows with this in their name");
  CLI11_PARSE(app, argc, argv);
  lightfit::Run(arguments);
  return 0;
}
