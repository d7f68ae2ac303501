// base/progress.h
//
// A progress bar on stderr for work that takes a while.
#pragma once

#include <chrono>
#include <string>

namespace lightfit {

// "8 s", "2 min 5 s", "1 h 20 min": rounded up, as people say how long something takes.
std::string DurationText(double seconds);

// A bar, the steps done and the time left. Silent unless stderr is a terminal and more than a
// second has passed. The bar is wiped when the object goes, so that it never mixes with other
// output.
class Progress {
 public:
  explicit Progress(int num_steps, bool quiet = false);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Says what is being done now. Wipes nothing until the next call.
  void Begin(const std::string& what);

  // One of the steps is done.
  void Advance();

 private:
  void Show();

  // How long took what was begun last, where that is wanted (base/verbose.h).
  void SayStep() const;

  using Clock = std::chrono::steady_clock;
  const int num_steps_;
  const bool enabled_;
  const Clock::time_point start_ = Clock::now();
  Clock::time_point begin_ = start_;
  int num_done_ = 0;
  bool shown_ = false;
  std::string what_;
};

}  // namespace lightfit
