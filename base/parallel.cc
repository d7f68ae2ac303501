#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <system_error>
#include <thread>
#include <vector>

namespace lightfit {

int NumProcessors() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

void ParallelFor(int count, int chunk, int num_threads, const std::function<void(int, int)>& run) {
  std::atomic<int> next = 0;
  const auto work = [&] {
    for (int begin = next.fetch_add(chunk); begin < count; begin = next.fetch_add(chunk)) {
      run(begin, std::min(begin + chunk, count));
    }
  };
  std::vector<std::thread> others;
  const int num_chunks = (count + chunk - 1) / chunk;
  for (int i = 1; i < std::min(num_threads, num_chunks); ++i) {
    try {
      others.emplace_back(work);
    } catch (const std::system_error&) {
      break;  // no more threads to be had: those there are do it
    }
  }
  work();
  for (std::thread& other : others) other.join();
}

}  // namespace lightfit
