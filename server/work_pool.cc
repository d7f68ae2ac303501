#include "server/work_pool.h"

#include <utility>

namespace lightfit {

WorkPool::WorkPool(int num_threads, int max_queue) : max_queue_(max_queue) {
  threads_.reserve(num_threads);
  for (int i = 0; i < num_threads; ++i) threads_.emplace_back([this] { Run(); });
}

WorkPool::~WorkPool() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  wakes_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

bool WorkPool::TrySubmit(std::function<void()> work) {
  {
    const std::lock_guard lock(mutex_);
    // Work that a free thread will take at once does not wait.
    const int num_free = num_threads() - num_running_;
    if (static_cast<int>(queue_.size()) >= max_queue_ + num_free) return false;
    queue_.push_back(std::move(work));
  }
  wakes_.notify_one();
  return true;
}

void WorkPool::Submit(std::function<void()> work) {
  {
    const std::lock_guard lock(mutex_);
    queue_.push_back(std::move(work));
  }
  wakes_.notify_one();
}

int WorkPool::num_waiting() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(queue_.size());
}

int WorkPool::num_running() const {
  const std::lock_guard lock(mutex_);
  return num_running_;
}

void WorkPool::Run() {
  std::unique_lock lock(mutex_);
  while (true) {
    wakes_.wait(lock, [this] { return is_ending_ || !queue_.empty(); });
    if (queue_.empty()) return;
    std::function<void()> work = std::move(queue_.front());
    queue_.pop_front();
    ++num_running_;
    lock.unlock();
    work();
    work = nullptr;  // what it held goes before anybody is told that it is done
    lock.lock();
    --num_running_;
  }
}

}  // namespace lightfit
