#include "io/exr/threads.h"

#include <OpenEXR/ImfThreading.h>

#include <algorithm>
#include <mutex>
#include <thread>

namespace lightfit::internal {

namespace {

// Each keeps two blocks of lines of every open file in memory, and they wait for one disk.
constexpr unsigned kMaxThreads = 8;

}  // namespace

void StartExrThreads() {
  static std::once_flag once;
  std::call_once(once, [] {
    const unsigned count = std::min(std::thread::hardware_concurrency(), kMaxThreads);
    Imf::setGlobalThreadCount(static_cast<int>(count));
  });
}

}  // namespace lightfit::internal
