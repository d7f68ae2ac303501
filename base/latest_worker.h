// base/latest_worker.h
//
// Work on a thread of its own, for a loop that must not wait for it.
// In:   from one thread, jobs: Lend(), fill, Submit().
// Out:  Poll(), for one thread: the newest answer.
//
// Latest wins: while the worker is busy a newer job takes the place of the one that waits, so that
// slow work skips jobs and never runs behind. Jobs and answers change owners and are not copied,
// and keep their memory. Lend, Submit and Poll lock nothing.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <system_error>
#include <thread>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "base/scratch.h"
#include "base/stop.h"
#include "base/triple_buffer.h"

namespace lightfit {

template <typename Job, typename Answer>
class LatestWorker {
 public:
  // Called on the worker's thread, inside a ScratchScope, and a StopScope that the destructor
  // stops. What an earlier job left in the answer is there still.
  using Work = std::function<void(const Job&, Answer*)>;

  // Starts the thread, which sleeps until the first job. What `work` refers to outlives the worker.
  // ResourceExhausted when no thread is to be had; `way_out` ends the message.
  static absl::StatusOr<std::unique_ptr<LatestWorker>> Start(Work work, absl::string_view way_out) {
    std::unique_ptr<LatestWorker> worker(new LatestWorker(std::move(work)));
    try {
      worker->thread_ =
          std::jthread([at = worker.get()](const std::stop_token& stop) { at->Run(stop); });
    } catch (const std::system_error& error) {
      return absl::ResourceExhaustedError(
          absl::StrCat("cannot start a thread: ", error.what(), "; ", way_out));
    }
    return worker;
  }

  // Stops the job in work, if any, and ends the thread. That job and what waits are dropped.
  ~LatestWorker() {
    if (!thread_.joinable()) return;
    thread_.request_stop();
    WakeUp();
    thread_.join();
  }

  LatestWorker(const LatestWorker&) = delete;
  LatestWorker& operator=(const LatestWorker&) = delete;

  // Submitting thread. The job to fill for the next Submit(), with what some earlier one left in
  // it; the same one until Submit().
  Job& Lend() { return jobs_.back(); }

  // Submitting thread.
  void Submit() {
    num_submitted_.fetch_add(1);
    if (jobs_.Publish()) num_skipped_.fetch_add(1);
    WakeUp();
  }

  // Polling thread. Null when the last call had the newest; it stays until a call returns another.
  const Answer* Poll() { return answers_.Take() ? &answers_.front() : nullptr; }

  // Any thread. The rest of those submitted, at most two, are in work or waiting.
  struct Counts {
    int64_t submitted = 0;
    int64_t done = 0;     // polled or not
    int64_t skipped = 0;  // a newer one came before the worker was free
  };
  Counts counts() const {
    // Submitted last: it is never less than the others together.
    Counts counts;
    counts.done = num_done_.load();
    counts.skipped = num_skipped_.load();
    counts.submitted = num_submitted_.load();
    return counts;
  }

 private:
  // Waking a sleeper takes the submitting thread 10 us and more. While jobs keep coming the worker
  // therefore naps between looks for the next one: later by half a nap on average, and each nap is
  // about 20 us of work. Once none has come for so many naps it sleeps until it is woken.
  static constexpr auto kNap = std::chrono::milliseconds(1);
  static constexpr int kNumNaps = 100;

  explicit LatestWorker(Work work) : work_(std::move(work)) {}

  // A system call, but only when the worker sleeps; naps end by themselves.
  void WakeUp() {
    wake_.fetch_add(1);
    wake_.notify_one();
  }

  // The worker's thread.
  void Run(const std::stop_token& stop) {
    const StopScope stop_scope(stop);
    ScratchPool pool;  // no job but the first few takes anything from the heap
    int num_naps = 0;
    while (true) {
      const uint32_t wake_before = wake_.load();
      if (stop.stop_requested()) return;
      if (!jobs_.Take()) {
        if (num_naps < kNumNaps) {
          ++num_naps;
          std::this_thread::sleep_for(kNap);
        } else {
          wake_.wait(wake_before);
        }
        continue;
      }
      num_naps = 0;
      {
        const ScratchScope scope(&pool);
        work_(jobs_.front(), &answers_.back());
      }
      if (stop.stop_requested()) return;
      num_done_.fetch_add(1);  // first, so that nobody polls an answer that is not counted
      answers_.Publish();
    }
  }

  Work work_;
  TripleBuffer<Job> jobs_;        // from the submitting thread to the worker
  TripleBuffer<Answer> answers_;  // from the worker to the polling thread

  // Counts everything the worker should wake up for. It reads this first and looks for work second,
  // so that what comes in between changes the number and does not let it fall asleep. All accesses
  // are sequentially consistent: whoever counts up sees a sleeper, or the sleeper sees it.
  std::atomic<uint32_t> wake_ = 0;

  std::atomic<int64_t> num_submitted_ = 0, num_done_ = 0, num_skipped_ = 0;
  std::jthread thread_;  // its stop ends the job in work, and then the thread
};

}  // namespace lightfit
