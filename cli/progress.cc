#include "cli/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace lightfit {
namespace {

constexpr double kPatience_s = 1.0;
constexpr int kBarWidth = 30;  // characters

}  // namespace

Progress::Progress(int num_steps, bool quiet)
    : num_steps_(std::max(num_steps, 1)), enabled_(!quiet && isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (shown_) std::fputs("\r\033[K", stderr);
}

void Progress::Begin(const std::string& what) {
  what_ = what;
  Show();
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
  if (num_done_ > 0) std::fprintf(stderr, ", %.0f s left", std::ceil(left_s));
  std::fprintf(stderr, "  %s\033[K", what_.c_str());
  std::fflush(stderr);
}

}  // namespace lightfit
