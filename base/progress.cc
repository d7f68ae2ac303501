#include "base/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/verbose.h"

namespace lightfit {
namespace {

constexpr double kPatience_s = 1.0;
constexpr int kBarWidth = 30;  // characters

// The steps are about equally long, so the time left is in proportion to the steps left.
double SecondsLeft(int num_done, int num_steps, double elapsed_s) {
  return elapsed_s * (num_steps - num_done) / num_done;
}

}  // namespace

std::string DurationText(double seconds) {
  // Also what is not a number or far too long has to be printed somehow.
  constexpr double kLongest_s = 1000.0 * 3600.0;
  const auto whole =
      static_cast<int64_t>(std::ceil(seconds > 0 ? std::min(seconds, kLongest_s) : 0));
  if (whole < 60) return absl::StrFormat("%d s", whole);
  if (whole < 3600) return absl::StrFormat("%d min %d s", whole / 60, whole % 60);
  return absl::StrFormat("%d h %d min", whole / 3600, whole % 3600 / 60);
}

std::string ProgressLine(int num_done, int num_steps, double elapsed_s, const std::string& what) {
  std::string line = absl::StrFormat("progress: %d of %d (%d %%), %s elapsed",
                                     num_done,
                                     num_steps,
                                     int64_t{100} * num_done / std::max(num_steps, 1),
                                     DurationText(elapsed_s));
  if (num_done > 0) {
    absl::StrAppend(
        &line, ", ", DurationText(SecondsLeft(num_done, num_steps, elapsed_s)), " left");
  }
  if (!what.empty()) absl::StrAppend(&line, ": ", what);
  return line;
}

ProgressOutput ProgressOutput::Stderr() {
  return {.is_terminal = isatty(STDERR_FILENO) == 1, .write = [](const std::string& text) {
            std::fputs(text.c_str(), stderr);
            std::fflush(stderr);
          }};
}

Progress::Progress(int num_steps, bool quiet, ProgressOutput output)
    : num_steps_(std::max(num_steps, 1)),
      output_(std::move(output)),
      has_bar_(!quiet && output_.is_terminal && !IsVerbose()) {
  if (!quiet && !output_.is_terminal) lines_ = std::thread([this] { WriteLines(); });
}

Progress::~Progress() {
  SayStep();
  if (lines_.joinable()) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      is_over_ = true;
    }
    over_.notify_one();
    lines_.join();
  }
  if (shown_) output_.write("\r\033[K");
}

void Progress::Begin(const std::string& what) {
  SayStep();
  begin_ = Clock::now();
  const std::lock_guard<std::mutex> lock(mutex_);
  what_ = what;
  ShowBar();
}

void Progress::SayStep() const {
  if (what_.empty() || !IsVerbose()) return;
  const std::chrono::duration<double> taken = Clock::now() - begin_;
  Say(absl::StrFormat("%s: %.3f s", what_, taken.count()));
}

void Progress::Advance() {
  const std::lock_guard<std::mutex> lock(mutex_);
  num_done_ = std::min(num_done_ + 1, num_steps_);
  ShowBar();
}

double Progress::ElapsedSeconds() const {
  return std::chrono::duration<double>(Clock::now() - start_).count();
}

void Progress::ShowBar() {
  if (!has_bar_) return;
  const double elapsed_s = ElapsedSeconds();
  if (elapsed_s < kPatience_s) return;
  shown_ = true;
  const int filled = kBarWidth * num_done_ / num_steps_;
  std::string text = absl::StrFormat("\r[%s%s] %d/%d",
                                     std::string(filled, '='),
                                     std::string(kBarWidth - filled, ' '),
                                     num_done_,
                                     num_steps_);
  if (num_done_ > 0) {
    absl::StrAppend(
        &text, ", ", DurationText(SecondsLeft(num_done_, num_steps_, elapsed_s)), " left");
  }
  absl::StrAppend(&text, "  ", what_, "\033[K");
  output_.write(text);
}

void Progress::WriteLines() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!over_.wait_for(lock, output_.line_every, [this] { return is_over_; })) {
    output_.write(ProgressLine(num_done_, num_steps_, ElapsedSeconds(), what_) + "\n");
  }
}

}  // namespace lightfit
