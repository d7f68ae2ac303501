// server/memory_budget.h
//
// A limit on the bytes that all calls together may hold.
// In:   how much a call is about to take, before it takes it.
// Out:  a Reservation that gives the bytes back when it goes, or nothing when they do not fit.
//
// Bytes are counted, not allocated: whoever reserves sizes its buffers by it. All functions may be
// called from any thread, and none blocks: what does not fit now is refused, so that memory stays
// bounded and the client hears RESOURCE_EXHAUSTED at once instead of waiting for others.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <utility>

namespace lightfit {

class MemoryBudget {
 public:
  // Bytes of a MemoryBudget, given back by the destructor. Empty after a move.
  class Reservation {
   public:
    Reservation(Reservation&& other) noexcept
        : budget_(std::exchange(other.budget_, nullptr)), bytes_(std::exchange(other.bytes_, 0)) {}
    Reservation& operator=(Reservation&& other) noexcept;
    ~Reservation() { Release(); }

    int64_t bytes() const { return bytes_; }

    // Gives the bytes back before the end of the object's life.
    void Release();

   private:
    friend class MemoryBudget;
    Reservation(MemoryBudget* budget, int64_t bytes) : budget_(budget), bytes_(bytes) {}

    MemoryBudget* budget_;
    int64_t bytes_;
  };

  // A limit of zero or less refuses everything but zero bytes.
  explicit MemoryBudget(int64_t limit_bytes) : limit_bytes_(limit_bytes) {}

  // Reservations point here.
  MemoryBudget(const MemoryBudget&) = delete;
  MemoryBudget& operator=(const MemoryBudget&) = delete;

  // Nothing when `bytes` is negative or does not fit beside what is reserved. The budget must
  // outlive the reservation.
  std::optional<Reservation> TryReserve(int64_t bytes);

  int64_t used_bytes() const { return used_bytes_.load(std::memory_order_relaxed); }
  int64_t limit_bytes() const { return limit_bytes_; }

 private:
  const int64_t limit_bytes_;
  std::atomic<int64_t> used_bytes_ = 0;
};

}  // namespace lightfit
