#include "fuzz/peak_memory.h"

#include <malloc.h>

#include <atomic>
#include <cerrno>
#include <cstddef>

namespace {

constinit std::atomic<int64_t> live_bytes{0}, peak_bytes{0}, bytes_at_start{0};

}  // namespace

namespace lightfit::fuzz {

void StartPeak() {
  bytes_at_start = live_bytes.load();
  peak_bytes = live_bytes.load();
}

int64_t PeakBytes() { return peak_bytes - bytes_at_start; }

}  // namespace lightfit::fuzz

// g++ says so by a macro, clang by a feature.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define LIGHTFIT_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define LIGHTFIT_SANITIZED 1
#endif
#endif

#ifndef LIGHTFIT_SANITIZED

// The program's malloc goes before that of glibc, whose own names for it begin with __libc.
// operator new and delete call these.
// NOLINTBEGIN(bugprone-reserved-identifier): the names are not ours.
extern "C" {

void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* memory, size_t size);
void* __libc_memalign(size_t alignment, size_t size);
void __libc_free(void* memory);

}  // extern "C"

namespace {

void* Taken(void* memory) {
  if (memory == nullptr) return nullptr;
  const auto size = static_cast<int64_t>(malloc_usable_size(memory));
  const int64_t live = live_bytes.fetch_add(size, std::memory_order_relaxed) + size;
  int64_t peak = peak_bytes.load(std::memory_order_relaxed);
  while (live > peak && !peak_bytes.compare_exchange_weak(peak, live, std::memory_order_relaxed)) {
  }
  return memory;
}

void Given(void* memory) {
  if (memory == nullptr) return;
  live_bytes.fetch_sub(static_cast<int64_t>(malloc_usable_size(memory)), std::memory_order_relaxed);
}

}  // namespace

extern "C" {

void* malloc(size_t size) { return Taken(__libc_malloc(size)); }
void* calloc(size_t count, size_t size) { return Taken(__libc_calloc(count, size)); }
void* memalign(size_t alignment, size_t size) { return Taken(__libc_memalign(alignment, size)); }
void* aligned_alloc(size_t alignment, size_t size) {
  return Taken(__libc_memalign(alignment, size));
}

void* realloc(void* memory, size_t size) {
  Given(memory);
  void* moved = __libc_realloc(memory, size);
  if (moved == nullptr && size > 0) {
    Taken(memory);  // it stays where it was
    return nullptr;
  }
  return Taken(moved);
}

int posix_memalign(void** memory, size_t alignment, size_t size) {
  *memory = Taken(__libc_memalign(alignment, size));
  return *memory == nullptr ? ENOMEM : 0;
}

void free(void* memory) {
  Given(memory);
  __libc_free(memory);
}

}  // extern "C"
// NOLINTEND(bugprone-reserved-identifier)

#endif
