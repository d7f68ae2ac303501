// base/triple_buffer.h
//
// The newest of what one thread makes, for another thread, and neither ever waits.
// In:   the writer fills back() and publishes it.
// Out:  the reader takes the newest that was published, if it has not had it yet: front().
//
// Of three buffers the writer has one, the reader one, and one lies between them. Both exchange
// theirs for that in one atomic step: nothing is copied, and what is filled again keeps its memory.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace lightfit {

template <typename T>
class TripleBuffer {
 public:
  // The writer's own until Publish(): what some earlier turn left in it.
  T& back() { return buffers_[back_]; }

  // Hands back() over. Returns whether that takes the place of one that the reader never had.
  bool Publish() {
    // The order of memory: whoever gets a buffer by its exchange (acquire) sees all that was done
    // to it before the exchange that gave it away (release). Both threads do both: the writer gives
    // what it wrote, and gets what the reader has finished reading. As all is in one word, and
    // every change to it reads the one before, no buffer is ever held twice.
    const uint32_t before = between_.exchange(back_ | kFresh, std::memory_order_acq_rel);
    back_ = before & ~kFresh;
    return (before & kFresh) != 0;
  }

  // Makes the newest front(). Returns false, and leaves front() as it is, when the reader has had
  // it already.
  bool Take() {
    // Only the reader takes kFresh away: seen once, it is still there in the next line.
    if ((between_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    front_ = between_.exchange(front_, std::memory_order_acq_rel) & ~kFresh;
    return true;
  }

  // The reader's own until Take() returns true.
  const T& front() const { return buffers_[front_]; }

 private:
  static constexpr uint32_t kFresh = 4;  // next to an index 0 ... 2: published and not taken yet
  static constexpr size_t kCacheLine = 64;

  // Each on a cache line of its own, as different threads write them.
  alignas(kCacheLine) std::array<T, 3> buffers_ = {};
  alignas(kCacheLine) uint32_t back_ = 0;  // the writer's
  alignas(kCacheLine) std::atomic<uint32_t> between_ = 1;
  alignas(kCacheLine) uint32_t front_ = 2;  // the reader's
};

}  // namespace lightfit
