// bench/async.cc : what the asynchronous optimizer costs the render thread.
//
// In:   a walk past boxes on a floor, 180x180 pixels, 1, 8 and 32 lights. When a frame is
//       submitted the optimizer is between frames (idle), at work on an earlier one (busy), or has
//       had none for so long that it must be woken (asleep; a tenth of the frames).
// Out:  microseconds of the render thread, median and 99 %:
//         copy           memcpy of depth and bits: what handing them over by value would cost
//         lend, submit   both calls; the filling between them is the engine's and not counted
//         poll           a call that returns matrices (idle, asleep), or most often none (busy)
//       the ratio of medians, lend and submit to copy; the share of frames skipped; and
//       milliseconds of the optimizer per frame that it did.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/table.h"
#include "optimizer/tracking/async_optimizer.h"
#include "tests/testing/frame_loop.h"

namespace lightfit {
namespace {

using Clock = std::chrono::steady_clock;

struct Arguments {
  int num_frames = 500;
  uint64_t seed = 7;
  int size_px = 180;
  double stability = 0.5;
};

// Microseconds of many calls.
class Timings {
 public:
  template <typename Call>
  void Time(const Call& call) {
    const Clock::time_point start = Clock::now();
    call();
    us_.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count());
  }

  double Quantile(double share) const {
    std::vector<double> sorted = us_;
    std::sort(sorted.begin(), sorted.end());
    return sorted[static_cast<size_t>(share * static_cast<double>(sorted.size() - 1))];
  }
  double median() const { return Quantile(0.5); }
  std::string Text() const { return absl::StrFormat("%.2f %7.2f", median(), Quantile(0.99)); }

 private:
  std::vector<double> us_;
};

struct Measured {
  Timings copy, lend_and_submit, poll;
  AsyncOptimizer::Counts counts;
  double optimizer_ms_per_frame = 0.0;
};

enum class State { kIdle, kBusy, kAsleep };

constexpr const char* kStateNames[] = {"idle", "busy", "asleep"};

Measured Measure(const Arguments& arguments, const testing::BoxWalk& walk, State state) {
  constexpr auto kFallAsleep = std::chrono::milliseconds(200);  // longer than it looks for frames
  constexpr auto kSettle = std::chrono::microseconds(300);      // from done to idle
  constexpr auto kBetweenBusyFrames = std::chrono::microseconds(100);
  const bool busy = state == State::kBusy;
  const int num_frames =
      state == State::kAsleep ? std::max(arguments.num_frames / 10, 1) : arguments.num_frames;
  AsyncOptimizer optimizer =
      testing::StartOptimizer(TrackerOptions::ForStability(arguments.stability));
  Measured measured;
  SyntheticReadback copy = walk.views.front();
  Clock::duration optimizer_time = {};
  const Clock::time_point loop_start = Clock::now();
  for (int frame = 0; frame < num_frames; ++frame) {
    const SyntheticReadback& view = walk.views[frame % walk.views.size()];
    measured.copy.Time([&] {
      std::memcpy(copy.depth.data(), view.depth.data(), view.depth.size() * sizeof(float));
      std::memcpy(copy.shadow_bits.data(),
                  view.shadow_bits.data(),
                  view.shadow_bits.size() * sizeof(uint32_t));
    });
    FrameReadback* lent = &optimizer.Lend();
    testing::Fill(view, walk.lights, frame, lent);
    const Clock::time_point submitted = Clock::now();
    measured.lend_and_submit.Time([&] {
      lent = &optimizer.Lend();
      optimizer.Submit();
    });
    if (busy) {
      std::this_thread::sleep_for(kBetweenBusyFrames);
    } else {
      testing::WaitUntilIdle(optimizer);
      optimizer_time += Clock::now() - submitted;
      std::this_thread::sleep_for(kSettle);
    }
    measured.poll.Time([&] { optimizer.Poll(); });
    if (state == State::kAsleep) std::this_thread::sleep_for(kFallAsleep);
  }
  if (busy) optimizer_time = Clock::now() - loop_start;
  measured.counts = optimizer.counts();
  measured.optimizer_ms_per_frame =
      std::chrono::duration<double, std::milli>(optimizer_time).count() /
      static_cast<double>(std::max<int64_t>(measured.counts.done, 1));
  return measured;
}

void Run(const Arguments& arguments) {
  Table table;
  table.AddColumn("", "optimizer");
  table.AddColumn("copy, us", "median    99 %");
  table.AddColumn("lend, submit, us", "median    99 %");
  table.AddColumn("poll, us", "median    99 %");
  table.AddColumn("", "submit / copy");
  table.AddColumn("", "skipped");
  table.AddColumn("", "optimizer, ms/frame");
  for (const int num_lights : {1, 8, kMaxLights}) {
    const testing::BoxWalk walk(
        arguments.seed, num_lights, /*num_views=*/8, arguments.size_px, arguments.size_px);
    for (const State state : {State::kIdle, State::kBusy, State::kAsleep}) {
      const Measured measured = Measure(arguments, walk, state);
      const double skipped_percent = 100.0 * static_cast<double>(measured.counts.skipped) /
                                     static_cast<double>(measured.counts.submitted);
      table.AddRow(
          {absl::StrCat(kStateNames[static_cast<int>(state)], ", ", num_lights, " lights"),
           measured.copy.Text(),
           measured.lend_and_submit.Text(),
           measured.poll.Text(),
           absl::StrFormat("%.2f x", measured.lend_and_submit.median() / measured.copy.median()),
           absl::StrFormat("%.0f %%", skipped_percent),
           absl::StrFormat("%.2f", measured.optimizer_ms_per_frame)});
    }
  }
  std::printf("%dx%d pixels, %d frames a row, stability %g\n\n%s",
              arguments.size_px,
              arguments.size_px,
              arguments.num_frames,
              arguments.stability,
              table.Text().c_str());
}

}  // namespace
}  // namespace lightfit

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): options are ours
  lightfit::Arguments arguments;
  CLI::App app("What the asynchronous optimizer costs the render thread.");
  app.add_option("--frames", arguments.num_frames, "Per row of the table")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seed", arguments.seed, "Of boxes, camera and lights")->capture_default_str();
  app.add_option("--size", arguments.size_px, "Of the read-back, pixels each way")
      ->check(CLI::Range(8, 8192))
      ->capture_default_str();
  app.add_option("--stability", arguments.stability, "0 ... 1")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  lightfit::Run(arguments);
  return 0;
}
