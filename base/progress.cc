#include "base/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include "absl/strings/str_format.h"
#include "base/verbose.h"

namespace lightfit {
namespace {

constexpr double kPatience_s = 1.0;
constexpr int kBarWidth = 30;  // characters

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

Progress::Progress(int num_steps, bool quiet)
    : num_steps_(std::max(num_steps, 1)),
      enabled_(!quiet && isatty(STDERR_FILENO) == 1 && !IsVerbose()) {}

Progress::~Progress() {
  SayStep();
  if (shown_) std::fputs("\r\033[K", stderr);
}

void Progress::Begin(const std::string& what) {
  SayStep();
  begin_ = Clock::now();
  what_ = what;
  Show();
}

void Progress::SayStep() const {
  if (what_.empty() || !IsVerbose()) return;
  const std::chrono::duration<double> taken = Clock::now() - begin_;
  Say(absl::StrFormat("%s: %.3f s", what_, taken.count()));
}

void Progress::Advance() {
  num_done_ = std::min(num_done_ + 1, num_steps_);
  Show();
}

void Progress::Show() {
  if (!enabled_) return;
  const double elapsed_s = std::chrono::duration<double>(Clock::now() - start_).count();
  if (elapsed_s < kPatience_s) return;
  shown_ = true;
  const int filled = kBarWidth * num_done_ / num_steps_;
  const std::string bar = std::string(filled, '=') + std::string(kBarWidth - filled, ' ');
  // The steps are about equally long, so the time left is in proportion to the steps left.
  const double left_s = num_done_ > 0 ? elapsed_s * (num_steps_ - num_done_) / num_done_ : 0;
  std::fprintf(stderr, "\r[%s] %d/%d", bar.c_str(), num_done_, num_steps_);
  if (num_done_ > 0) std::fprintf(stderr, ", %s left", DurationText(left_s).c_str());
  std::fprintf(stderr, "  %s\033[K", what_.c_str());
  std::fflush(stderr);
}

}  // namespace lightfit
