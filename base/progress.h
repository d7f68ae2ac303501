// base/progress.h
//
// How far work that takes a while has come, on stderr: a bar on a terminal, else lines for a log.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace lightfit {

// "8 s", "2 min 5 s", "1 h 20 min": rounded up, as people say how long something takes.
std::string DurationText(double seconds);

// "progress: 12 of 24 (50 %), 1 min 30 s elapsed, 1 min 30 s left: fitting sun". Nothing is said of
// the time left before the first step is done, as nothing is known of it.
std::string ProgressLine(int num_done, int num_steps, double elapsed_s, const std::string& what);

// Where a Progress goes: stderr by default; tests have their own.
struct ProgressOutput {
  bool is_terminal = false;
  std::chrono::milliseconds line_every{30'000};
  std::function<void(const std::string&)> write;

  static ProgressOutput Stderr();
};

// On a terminal a bar, the steps done and the time left, once more than a second has passed; it is
// wiped when the object goes, so that it never mixes with other output. Elsewhere, as in the log of
// a farm, a line every half minute, also while a single step takes longer than that. Begin() and
// Advance() are for one thread at a time.
class Progress {
 public:
  explicit Progress(int num_steps,
                    bool quiet = false,
                    ProgressOutput output = ProgressOutput::Stderr());
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Says what is being done now. Wipes nothing until the next call.
  void Begin(const std::string& what);

  // One of the steps is done.
  void Advance();

 private:
  double ElapsedSeconds() const;
  void ShowBar();
  void WriteLines();  // until the object goes

  // How long took what was begun last, where that is wanted (base/verbose.h).
  void SayStep() const;

  using Clock = std::chrono::steady_clock;
  const int num_steps_;
  const ProgressOutput output_;
  const bool has_bar_;
  const Clock::time_point start_ = Clock::now();
  Clock::time_point begin_ = start_;

  std::mutex mutex_;  // of what follows
  int num_done_ = 0;
  bool shown_ = false;
  std::string what_;
  bool is_over_ = false;
  std::condition_variable over_;

  std::thread lines_;  // elsewhere than on a terminal
};

}  // namespace lightfit
