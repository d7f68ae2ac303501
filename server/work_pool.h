// server/work_pool.h
//
// The threads that compute. Handlers of calls hand their work over and return at once, since a
// handler that blocks holds up every other call of the server.
// In:   work, from any thread.
// Out:  it runs, first come, first served.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace lightfit {

class WorkPool {
 public:
  // num_threads >= 1; at most max_queue pieces of work wait.
  WorkPool(int num_threads, int max_queue);

  // Runs all that waits, then ends the threads.
  ~WorkPool();

  WorkPool(const WorkPool&) = delete;
  WorkPool& operator=(const WorkPool&) = delete;

  // False, and the work is dropped, when the queue is full.
  bool TrySubmit(std::function<void()> work);

  // For work whose number is bounded otherwise: takes its turn though the queue be full.
  void Submit(std::function<void()> work);

  int num_threads() const { return static_cast<int>(threads_.size()); }
  int num_waiting() const;
  int num_running() const;

 private:
  void Run();

  const int max_queue_;
  mutable std::mutex mutex_;
  std::condition_variable wakes_;
  std::deque<std::function<void()>> queue_;
  int num_running_ = 0;
  bool is_ending_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace lightfit
