#include "server/memory_budget.h"

namespace lightfit {

MemoryBudget::Reservation& MemoryBudget::Reservation::operator=(Reservation&& other) noexcept {
  if (this != &other) {
    Release();
    budget_ = std::exchange(other.budget_, nullptr);
    bytes_ = std::exchange(other.bytes_, 0);
  }
  return *this;
}

void MemoryBudget::Reservation::Release() {
  if (budget_ != nullptr) budget_->used_bytes_.fetch_sub(bytes_, std::memory_order_relaxed);
  budget_ = nullptr;
  bytes_ = 0;
}

std::optional<MemoryBudget::Reservation> MemoryBudget::TryReserve(int64_t bytes) {
  if (bytes < 0) return std::nullopt;
  if (bytes == 0) return Reservation(this, 0);
  int64_t used = used_bytes_.load(std::memory_order_relaxed);
  do {
    // Not used + bytes > limit: the sum of a hostile size overflows.
    if (bytes > limit_bytes_ - used) return std::nullopt;
  } while (!used_bytes_.compare_exchange_weak(used, used + bytes, std::memory_order_relaxed));
  return Reservation(this, bytes);
}

}  // namespace lightfit
